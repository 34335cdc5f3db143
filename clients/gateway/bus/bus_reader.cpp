// SPDX-License-Identifier: Apache-2.0
#include "gateway/bus/bus_reader.h"

#include <pthread.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <utility>

#include "cli/try.h"
#include "dts/subscriber.h"
#include "dts/wire/options.h"

namespace dts::gateway {
namespace {

using Clock = std::chrono::steady_clock;  // CLOCK_MONOTONIC, like host times

/// The daemon publishes a status every second. Together with the time to the browser this must stay below two seconds.
constexpr std::chrono::milliseconds kSilence{1500};
/// Longest delay before new topics are noticed while the daemon is silent.
constexpr std::chrono::milliseconds kTurn{50};
constexpr std::chrono::milliseconds kPauseBeforeReopening{500};

struct ToCarried {
  CarriedPointer operator()(const client::Block& block) const {
    return std::make_shared<Carried>(Carried{.topic = std::string(block.topic),
                                             .kind = Carried::Kind::Block,
                                             .bytes = block.body->SerializeAsString(),
                                             .scans = block.scan_count,
                                             .instance_id = block.body->instance_id()});
  }
  CarriedPointer operator()(const client::Event& event) const {
    return std::make_shared<Carried>(Carried{.topic = std::string(event.topic),
                                             .kind = Carried::Kind::Event,
                                             .bytes = event.body->SerializeAsString(),
                                             .is_retained = wire::topic_of(*event.body).is_retained(),
                                             .instance_id = event.body->instance_id()});
  }
  CarriedPointer operator()(const client::Status& status) const {
    return std::make_shared<Carried>(Carried{.topic = std::string(kStatusTopic),
                                             .kind = Carried::Kind::Status,
                                             .bytes = status.snapshot->SerializeAsString(),
                                             .is_retained = true,
                                             .instance_id = status.snapshot->instance_id()});
  }
  /// Returns nothing: the instance id in later messages shows the restart.
  CarriedPointer operator()(const client::Restart&) const { return nullptr; }
};

}  // namespace

class BusReader::Loop {
 public:
  Loop(std::string endpoint, std::function<void(BusItem)> on_item) : endpoint_(std::move(endpoint)), on_item_(std::move(on_item)) {}

  client::Result<void> open();
  void run(const std::stop_token& stop) noexcept;
  void want(std::vector<std::string> prefixes) {
    const std::lock_guard lock(mutex_);
    wishes_ = std::move(prefixes);
  }

 private:
  void turn();
  void pause(const std::stop_token& stop);
  void pass_on(const client::Message& message);
  [[nodiscard]] client::Result<void> grant_wishes();
  void give_up(const client::Error& problem);
  [[nodiscard]] std::vector<std::string> topics() const;
  void learn_rigs();
  void report(bool is_up, std::string problem);

  std::string endpoint_;
  std::function<void(BusItem)> on_item_;
  std::optional<client::Subscriber> subscriber_;
  std::vector<std::string> wanted_;
  std::vector<std::string> rigs_;
  Clock::time_point received_at_ = Clock::now();
  bool is_up_ = false;
  std::mutex mutex_;
  std::condition_variable_any stopped_;
  std::optional<std::vector<std::string>> wishes_;  ///< New topics, not subscribed yet; guarded by `mutex_`.
};

client::Result<void> BusReader::Loop::open() {
  DTS_TRY_ASSIGN(auto opened, client::Subscriber::open({.endpoint = endpoint_, .topics = topics()}));
  subscriber_.emplace(std::move(opened));
  return {};
}

/// Catches what libraries throw (for example if memory runs out): an exception leads to a pause and a new socket.
void BusReader::Loop::run(const std::stop_token& stop) noexcept {
  ::pthread_setname_np(::pthread_self(), "bus");
  while (!stop.stop_requested()) {
    try {
      if (!subscriber_) {
        pause(stop);
        if (stop.stop_requested() || !open()) continue;
      }
      turn();
    } catch (const std::exception&) {
      subscriber_.reset();
    }
  }
}

/// Ends at once when a stop is requested.
void BusReader::Loop::pause(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  stopped_.wait_for(lock, stop, kPauseBeforeReopening, [] { return false; });
}

void BusReader::Loop::turn() {
  if (const auto granted = grant_wishes(); !granted) return give_up(granted.error());
  const auto message = subscriber_->receive(kTurn);
  if (!message) return give_up(message.error());
  if (*message) return pass_on(**message);
  if (is_up_ && Clock::now() - received_at_ > kSilence) report(false, "the daemon does not answer");
}

void BusReader::Loop::pass_on(const client::Message& message) {
  received_at_ = Clock::now();
  if (!is_up_) report(true, {});
  if (std::holds_alternative<client::Status>(message)) learn_rigs();
  if (auto carried = std::visit(ToCarried(), message)) on_item_(std::move(carried));
}

void BusReader::Loop::give_up(const client::Error& problem) {
  subscriber_.reset();
  report(false, problem.what);
}

client::Result<void> BusReader::Loop::grant_wishes() {
  {
    const std::lock_guard lock(mutex_);
    if (!wishes_) return {};
    wanted_ = std::move(*wishes_);
    wishes_.reset();
  }
  return subscriber_->set_topics(topics());
}

/// Returns the status, the retained events of every rig, and the topics of the tabs.
std::vector<std::string> BusReader::Loop::topics() const {
  std::vector<std::string> all{std::string(kStatusTopic)};
  for (const std::string& rig : rigs_) {
    for (const v1::Topic& topic : wire::event_topics()) {
      if (topic.is_retained()) all.push_back(rig + "/" + topic.name());
    }
  }
  all.insert(all.end(), wanted_.begin(), wanted_.end());
  return all;
}

void BusReader::Loop::learn_rigs() {
  const v1::StatusSnapshot* status = subscriber_->status();
  if (status == nullptr) return;
  std::vector<std::string> rigs;
  for (const v1::RigStatus& rig : status->rigs()) rigs.push_back(rig.rig().name());
  if (rigs == rigs_) return;
  rigs_ = std::move(rigs);
  const std::lock_guard lock(mutex_);
  if (!wishes_) wishes_ = wanted_;  // subscribed again, with the new rigs
}

void BusReader::Loop::report(bool is_up, std::string problem) {
  is_up_ = is_up;
  v1::Link link;
  link.set_is_up(is_up);
  link.set_since_host_time_ns(std::chrono::nanoseconds(received_at_.time_since_epoch()).count());
  link.set_problem(std::move(problem));
  on_item_(std::move(link));
}

BusReader::BusReader(std::unique_ptr<Loop> loop)
    : loop_(std::move(loop)), thread_([loop = loop_.get()](const std::stop_token& stop) { loop->run(stop); }) {}

BusReader::~BusReader() = default;

client::Result<std::unique_ptr<BusReader>> BusReader::start(const std::string& endpoint, std::function<void(BusItem)> on_item) {
  auto loop = std::make_unique<Loop>(endpoint, std::move(on_item));
  DTS_TRY(loop->open());
  return std::unique_ptr<BusReader>(new BusReader(std::move(loop)));
}

void BusReader::want(std::vector<std::string> prefixes) { loop_->want(std::move(prefixes)); }

}  // namespace dts::gateway
