// SPDX-License-Identifier: Apache-2.0
#include "relay/authenticator.h"

#include <array>
#include <exception>
#include <optional>
#include <span>
#include <utility>

#include "core/thread.h"
#include "relay/frames.h"

namespace dts::relay {
namespace {

constexpr const char* kEndpoint = "inproc://zeromq.zap.01";
constexpr int kLookMs = 100;  // longest delay of a stop request
/// Limits for a client that connects again and again. libzmq computes the handshake before it asks, so the limits only save the work after
/// it.
constexpr double kHandshakesPerSecond = 5.0;
constexpr double kHandshakeBurst = 50.0;
constexpr std::size_t kKeyBytes = 32;

// Frames of a request: version, request id, domain, address, identity, mechanism, credentials.
constexpr std::size_t kVersion = 0;
constexpr std::size_t kRequestId = 1;
constexpr std::size_t kMechanism = 5;
constexpr std::size_t kCredentials = 6;
constexpr std::size_t kCurveFrames = 7;

struct Verdict {
  const char* code;
  const char* text;
};
// 300: libzmq's clients retry after their handshake timeout. 400: they never retry.
constexpr Verdict kTooOften{"300", "too many attempts, try again later"};
constexpr Verdict kStranger{"400", "no such key"};

}  // namespace

core::Result<std::unique_ptr<Authenticator>> Authenticator::start(zmq::context_t& context, FreshKeys& keys, core::Clock& clock) {
  try {
    zmq::socket_t socket(context, zmq::socket_type::rep);
    socket.set(zmq::sockopt::linger, 0);
    socket.bind(kEndpoint);
    return std::unique_ptr<Authenticator>(new Authenticator(std::move(socket), keys, clock));
  } catch (const zmq::error_t& error) {
    return core::fail_errno(error.num(), "cannot start the authentication of clients");
  }
}

Authenticator::Authenticator(zmq::socket_t socket, FreshKeys& keys, core::Clock& clock)
    : socket_(std::move(socket)), keys_(keys), clock_(clock), handshakes_(kHandshakesPerSecond, kHandshakeBurst) {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

void Authenticator::run(const std::stop_token& stop) {
  static_cast<void>(core::configure_this_thread("access", {}));
  while (!stop.stop_requested()) {
    try {
      zmq::pollitem_t item{.socket = socket_.handle(), .fd = 0, .events = ZMQ_POLLIN, .revents = 0};
      zmq_poll(&item, 1, kLookMs);
      while (const auto request = receive_frames(socket_, kCurveFrames + 1)) answer(*request);
    } catch (const std::exception&) {
      // No memory, for example: one client gets no answer and retries.
    }
  }
}

void Authenticator::answer(const std::vector<zmq::message_t>& request) {
  std::optional<access::ClientKey> client;
  const bool is_curve = request.size() == kCurveFrames && request[kVersion].to_string_view() == "1.0" &&
                        request[kMechanism].to_string_view() == "CURVE" && request[kCredentials].size() == kKeyBytes;
  if (is_curve) {
    keys_.look();  // a client that uses its key right after dtsctl key new must be welcome: libzmq never retries after a rejection
    client = keys_.store().find_by_key(std::span(request[kCredentials].data<std::uint8_t>(), kKeyBytes));
  }
  const bool is_welcome = client && handshakes_.take(client->name, clock_.now_ns());
  (is_welcome ? accepted_total_ : refused_total_).fetch_add(1, std::memory_order_relaxed);
  const std::string id = request.size() > kRequestId ? request[kRequestId].to_string() : "";
  const Verdict verdict = is_welcome ? Verdict{"200", "OK"} : client ? kTooOften : kStranger;
  const std::array<std::string, 6> reply{"1.0", id, verdict.code, verdict.text, is_welcome ? client->public_key : "", ""};
  for (std::size_t index = 0; index < reply.size(); ++index) {
    socket_.send(zmq::buffer(reply[index]), index + 1 < reply.size() ? zmq::send_flags::sndmore : zmq::send_flags::none);
  }
}

}  // namespace dts::relay
