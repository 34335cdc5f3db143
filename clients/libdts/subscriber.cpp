// SPDX-License-Identifier: Apache-2.0
#include "dts/subscriber.h"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <fstream>
#include <utility>
#include <zmq.hpp>

#include "data_source.h"
#include "inbox.h"
#include "try.h"
#include "wire_check.h"

namespace dts::client {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;  // CLOCK_MONOTONIC, like the daemon's host times

constexpr std::string_view kStatusTopic = "dtsd/status";
constexpr std::size_t kLongestPrefix = 200;  // the daemon disconnects clients with longer subscriptions,
constexpr std::size_t kMostTopics = 127;     // or more than 256: a change of topics has the old and the new ones for a moment
constexpr int kMaxQueue = 1'000'000;
constexpr milliseconds kLongestWait = std::chrono::hours(24);
constexpr milliseconds kShortestSilence{10};
constexpr int kLooksPerSilence = 8;
/// Limit at the socket against a peer that announces gigabytes; the inbox counts messages that are only slightly too large.
constexpr std::size_t kDataSocketBytes = 4 * static_cast<std::size_t>(kMaxMessageBytes);
/// Messages processed per call even after the deadline, so that polling with timeout 0 makes progress.
constexpr int kMessagesPerCall = 256;
/// Limits one drain in mode Latest if the publisher is faster than this reader.
constexpr int kMessagesPerDrain = 65536;

std::int64_t to_ns(Clock::time_point time) noexcept {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count();
}

std::string read_boot_id() {
  std::ifstream file("/proc/sys/kernel/random/boot_id");
  std::string boot_id;
  std::getline(file, boot_id);
  return boot_id;
}

bool asks_for_status(const std::vector<std::string>& prefixes) {
  return std::ranges::any_of(prefixes, [](const std::string& prefix) { return kStatusTopic.starts_with(prefix); });
}

Result<void> check_topics(const std::vector<std::string>& topics) {
  if (topics.empty()) return fail(ErrorCode::InvalidArgument, "no topic to subscribe to", "give a topic prefix; \"\" means every topic");
  if (std::ranges::any_of(topics, [](const std::string& prefix) { return prefix.size() > kLongestPrefix; })) {
    return fail(ErrorCode::InvalidArgument, "a topic prefix is longer than " + std::to_string(kLongestPrefix) + " bytes");
  }
  if (topics.size() > kMostTopics) {
    return fail(ErrorCode::InvalidArgument, "more than " + std::to_string(kMostTopics) + " topics", "use shorter prefixes");
  }
  return {};
}

Result<void> check_options(const SubscriberOptions& options) {
  if (options.endpoint.empty()) {
    return fail(ErrorCode::InvalidArgument, "the data address of the daemon is not known", "give it with --data URI or DTSD_DATA");
  }
  DTS_TRY(check_topics(options.topics));
  if (options.queue_messages < 1 || options.queue_messages > kMaxQueue) {
    return fail(ErrorCode::InvalidArgument, "queue_messages must be from 1 to " + std::to_string(kMaxQueue));
  }
  if (options.reconnect_after < kShortestSilence) {
    return fail(ErrorCode::InvalidArgument, "reconnect_after must be at least " + std::to_string(kShortestSilence.count()) + " ms");
  }
  return {};
}

}  // namespace

class [[gnu::visibility("hidden")]] Subscriber::Implementation {
 public:
  explicit Implementation(const SubscriberOptions& options)
      : options_(options), inbox_(options.mode, asks_for_status(options.topics), read_boot_id()) {}

  /// Connects, in the place of an earlier connection. Fails as `open_source` does, and keeps the earlier connection then.
  [[nodiscard]] Result<void> connect(milliseconds handshake_limit);
  std::optional<Message> receive(milliseconds timeout) {
    const auto deadline = Clock::now() + std::clamp<milliseconds>(timeout, milliseconds::zero(), kLongestWait);
    return options_.mode == Mode::All ? receive_all(deadline) : receive_latest(deadline);
  }
  void set_topics(const std::vector<std::string>& topics);
  [[nodiscard]] const Inbox& inbox() const noexcept { return inbox_; }

 private:
  std::optional<Message> receive_all(Clock::time_point deadline);
  std::optional<Message> receive_latest(Clock::time_point deadline);
  void note_life() noexcept {
    looked_ = Clock::now();
    silence_ = {};
  }
  void drain();
  void catch_up();
  [[nodiscard]] bool take_one();
  [[nodiscard]] bool wait(Clock::time_point deadline);

  SubscriberOptions options_;
  std::unique_ptr<DataSource> source_;
  std::uint64_t earlier_interruptions_ = 0;  ///< Of earlier sources.
  Clock::time_point looked_;                 ///< When the source was last read.
  Clock::duration silence_{};
  Inbox inbox_;
};

Result<void> Subscriber::Implementation::connect(milliseconds handshake_limit) {
  DTS_TRY_ASSIGN(auto source, open_source({.endpoint = options_.endpoint,
                                           .queue_messages = options_.queue_messages,
                                           .largest_message = kDataSocketBytes,
                                           .key = options_.key,
                                           .handshake_limit = handshake_limit}));
  source->subscribe(std::string(kStatusTopic));
  for (const std::string& prefix : options_.topics) source->subscribe(prefix);
  if (source_) earlier_interruptions_ += source_->interruptions();
  source_ = std::move(source);
  note_life();
  return {};
}

/// Subscribes the new topics before it unsubscribes the old ones, so that a topic in both lists stays subscribed.
void Subscriber::Implementation::set_topics(const std::vector<std::string>& topics) {
  for (const std::string& prefix : topics) source_->subscribe(prefix);
  for (const std::string& prefix : options_.topics) source_->unsubscribe(prefix);
  options_.topics = topics;
  inbox_.hand_out_status(asks_for_status(topics));
}

std::optional<Message> Subscriber::Implementation::receive_all(Clock::time_point deadline) {
  for (int taken = 0;;) {
    if (auto message = inbox_.next(to_ns(Clock::now()))) return message;
    if (take_one()) {
      if (++taken > kMessagesPerCall && Clock::now() >= deadline) return std::nullopt;
    } else if (!wait(deadline)) {
      return std::nullopt;
    }
  }
}

std::optional<Message> Subscriber::Implementation::receive_latest(Clock::time_point deadline) {
  for (;;) {
    drain();
    if (inbox_.is_behind()) catch_up();
    if (auto message = inbox_.next(to_ns(Clock::now()))) return message;
    if (!wait(deadline)) return std::nullopt;
  }
}

void Subscriber::Implementation::drain() {
  for (int taken = 0; taken < kMessagesPerDrain && take_one(); ++taken) {
  }
}

void Subscriber::Implementation::catch_up() {
  const auto deadline = Clock::now() + options_.catch_up;
  // `wait` returns true after the deadline, too, if a message is there.
  while (inbox_.is_behind() && Clock::now() < deadline && wait(deadline)) drain();
  inbox_.accept_delays();
}

/// Returns false if no message waits at the socket.
bool Subscriber::Implementation::take_one() {
  const auto message = source_->take();
  inbox_.note_interruptions(earlier_interruptions_ + source_->interruptions());
  if (!message) return false;
  note_life();
  if (message->is_well_formed) {
    inbox_.accept(message->topic, message->body, to_ns(looked_));
  } else {
    inbox_.count_malformed();
  }
  return true;
}

/// Returns true if the socket may have a message; false at the deadline or if a signal arrived.
bool Subscriber::Implementation::wait(Clock::time_point deadline) {
  const Clock::duration slice = options_.reconnect_after / kLooksPerSilence;
  const auto timeout = std::chrono::ceil<milliseconds>(std::min(deadline - Clock::now(), slice));
  const Waited waited = source_->wait(std::max(timeout, milliseconds::zero()));
  if (waited != Waited::TimedOut) return waited == Waited::Ready;
  // libzmq closes a connection for good after a protocol violation, for example after a message beyond its size limit. The daemon publishes
  // a status every second, so silence means that there is no connection. Only time during which this process could read counts as silence:
  // a process that was suspended must first read the queued messages.
  const auto now = Clock::now();
  silence_ += std::min(now - looked_, slice);
  looked_ = now;
  if (silence_ >= options_.reconnect_after) std::ignore = connect(kReconnectHandshake);
  return now < deadline;
}

Result<Subscriber> Subscriber::open(const SubscriberOptions& options) {
  DTS_TRY(check_options(options));
  auto implementation = std::make_unique<Implementation>(options);
  DTS_TRY(implementation->connect(kFirstHandshake));
  return Subscriber(std::move(implementation));
}

Subscriber::Subscriber(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
Subscriber::~Subscriber() = default;
Subscriber::Subscriber(Subscriber&&) noexcept = default;
Subscriber& Subscriber::operator=(Subscriber&&) noexcept = default;

Result<std::optional<Message>> Subscriber::receive(milliseconds timeout) {
  try {
    return implementation_->receive(timeout);
  } catch (const zmq::error_t& error) {
    if (error.num() == EINTR) return std::optional<Message>();
    return fail(ErrorCode::Internal, std::string("the data socket failed: ") + error.what());
  }
}

Result<void> Subscriber::set_topics(const std::vector<std::string>& topics) {
  DTS_TRY(check_topics(topics));
  try {
    implementation_->set_topics(topics);
    return {};
  } catch (const zmq::error_t& error) {
    return fail(ErrorCode::Internal, std::string("the data socket failed: ") + error.what());
  }
}

const v1::StatusSnapshot* Subscriber::status() const noexcept { return implementation_->inbox().status(); }
const SubscriberStatistics& Subscriber::statistics() const noexcept { return implementation_->inbox().statistics(); }

}  // namespace dts::client
