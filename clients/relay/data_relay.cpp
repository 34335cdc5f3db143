// SPDX-License-Identifier: Apache-2.0
#include "relay/data_relay.h"

#include <utility>

#include "core/thread.h"

namespace dts::relay {
namespace {

using std::chrono::milliseconds;

// 256 would be enough for our topics, but the limit also applies to CURVE handshakes, whose largest frame is longer.
constexpr std::int64_t kLongestSubscriptionBytes = 512;
/// Of each subscriber. libzmq stores a message once for all subscribers, so this limits the memory, too: blocks have a few kB.
constexpr int kQueueMessages = 2000;
constexpr std::size_t kLargestMessage = std::size_t{1} << 20U;  // as libdts: nothing that dtsd publishes is longer
constexpr int kMessagesPerTurn = 256;
constexpr int kSubscriptionsPerTurn = 1024;
constexpr milliseconds kTurn{50};  // longest delay of a stop request and of a new subscription
constexpr milliseconds kRenewal{100};
/// Subscribed to again for a new subscriber. The subscription to everything stays, so that nothing is missed meanwhile.
constexpr const char* kRenewed = "dtsd/";

zmq::socket_t publisher(zmq::context_t& context) {
  zmq::socket_t socket(context, zmq::socket_type::xpub);
  socket.set(zmq::sockopt::linger, 200);  // time to send the last events at shutdown
  socket.set(zmq::sockopt::sndhwm, kQueueMessages);
  socket.set(zmq::sockopt::maxmsgsize, kLongestSubscriptionBytes);
  socket.set(zmq::sockopt::xpub_verbose, true);  // reports every subscription, so that each subscriber gets the retained messages
  return socket;
}

}  // namespace

core::Result<std::unique_ptr<DataRelay>> DataRelay::start(zmq::context_t& context, const RemoteEndpoint& remote, const std::string& local) {
  auto source = client::open_source({.endpoint = local, .largest_message = kLargestMessage, .handshake_limit = milliseconds(20)});
  if (!source) return core::fail(core::ErrorCode::InvalidArgument, source.error().what, source.error().hint);
  (*source)->subscribe("");
  (*source)->subscribe(kRenewed);
  DTS_TRY_ASSIGN(auto listener, RemoteListener::bind(publisher(context), remote, "data"));
  return std::unique_ptr<DataRelay>(new DataRelay(std::move(listener), std::move(*source)));
}

DataRelay::DataRelay(RemoteListener listener, std::unique_ptr<client::DataSource> source)
    : listener_(std::move(listener)), source_(std::move(source)), thread_([this](const std::stop_token& stop) { run(stop); }) {}

void DataRelay::run(const std::stop_token& stop) {
  static_cast<void>(core::configure_this_thread("data", {}));
  bool has_more = false;
  while (!stop.stop_requested()) {
    static_cast<void>(source_->wait(has_more ? milliseconds(0) : kTurn));
    is_renewal_due_ = take_subscriptions() || is_renewal_due_;  // first: new subscribers get what arrives now
    has_more = pass_messages();
    renew_subscription();
    note_interruptions();
    if (is_drop_due_.exchange(false, std::memory_order_acq_rel)) is_down_.store(!listener_.drop_connections(), std::memory_order_relaxed);
  }
}

/// Returns true if more messages may be waiting.
bool DataRelay::pass_messages() {
  for (int turn = 0; turn < kMessagesPerTurn; ++turn) {
    const auto message = source_->take();
    if (!message) return false;
    if (message->is_well_formed) send(*message);
  }
  return true;
}

/// dtsd ends the connection of a relay that was too slow for an event. Ends the connections of the subscribers, too: they connect again,
/// and so get the present states and count an interruption.
void DataRelay::note_interruptions() {
  if (std::exchange(interruptions_, source_->interruptions()) != source_->interruptions()) drop_peers();
}

void DataRelay::send(const client::RawMessage& message) {
  try {
    listener_.socket().send(zmq::buffer(message.topic), zmq::send_flags::sndmore | zmq::send_flags::dontwait);
    listener_.socket().send(zmq::buffer(message.body.data(), message.body.size()), zmq::send_flags::dontwait);
  } catch (const zmq::error_t&) {
    // An XPUB send fails only while the context is being destroyed.
  }
}

/// Returns true if there was a new subscription.
bool DataRelay::take_subscriptions() {
  bool has_new = false;
  for (int turn = 0; turn < kSubscriptionsPerTurn; ++turn) {
    zmq_msg_t message;
    zmq_msg_init(&message);
    const int bytes = zmq_msg_recv(&message, listener_.socket().handle(), ZMQ_DONTWAIT);
    // XPUB receives "\1<topic>" for a subscription and "\0<topic>" for its end. Ignore all other messages.
    if (bytes >= 1 && *static_cast<const char*>(zmq_msg_data(&message)) == 1) has_new = true;
    zmq_msg_close(&message);
    if (bytes < 0) break;
  }
  return has_new;
}

void DataRelay::renew_subscription() {
  const auto now = Clock::now();
  if (!is_renewal_due_ || now - renewed_at_ < kRenewal) return;
  is_renewal_due_ = false;
  renewed_at_ = now;
  source_->unsubscribe(kRenewed);
  source_->subscribe(kRenewed);
}

}  // namespace dts::relay
