// SPDX-License-Identifier: Apache-2.0
#include "gateway/bus/tab_queue.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "dts/v1/gateway.pb.h"

namespace dts::gateway {
namespace {

constexpr double kUsualRateHz = 60.0;
constexpr double kHighestRateHz = 120.0;

bool is_event(const CarriedPointer& message) noexcept { return message->kind == Carried::Kind::Event; }
bool is_block(const CarriedPointer& message) noexcept { return message->kind == Carried::Kind::Block; }

}  // namespace

bool TabQueue::subscribe(std::vector<std::string> prefixes, double frames_per_second) {
  const double rate_hz = frames_per_second == 0.0 ? kUsualRateHz : frames_per_second;
  if (!(rate_hz >= 1.0 && rate_hz <= kHighestRateHz) || prefixes.size() > kMostPrefixes) return false;
  if (std::ranges::any_of(prefixes, [](const std::string& prefix) { return prefix.size() > kLongestPrefix; })) return false;
  prefixes_ = std::move(prefixes);
  spacing_ = std::chrono::nanoseconds(std::llround(1e9 / rate_hz));
  // Waiting messages of topics that are not subscribed any more are dropped without counting.
  std::erase_if(waiting_, [this](const CarriedPointer& message) { return !wants(message->topic); });
  bytes_ = 0;
  for (const CarriedPointer& message : waiting_) bytes_ += message->bytes.size();
  events_ = static_cast<std::size_t>(std::ranges::count_if(waiting_, is_event));
  return true;
}

bool TabQueue::wants(std::string_view topic) const noexcept {
  return topic == kStatusTopic || std::ranges::any_of(prefixes_, [topic](const std::string& prefix) { return topic.starts_with(prefix); });
}

void TabQueue::push(const CarriedPointer& message, Time now) {
  if (!wants(message->topic)) return;
  // The hub sends a retained message again after each subscription: it is needed only once.
  if (message->is_retained && std::ranges::find(waiting_, message) != waiting_.end()) return;
  if (message->kind == Carried::Kind::Status) {
    // Only the newest status matters.
    const auto old = std::ranges::find(waiting_, Carried::Kind::Status, [](const CarriedPointer& other) { return other->kind; });
    if (old != waiting_.end()) {
      bytes_ -= (*old)->bytes.size();
      waiting_.erase(old);
    }
  }
  if (waiting_.empty()) first_pushed_ = now;
  waiting_.push_back(message);
  bytes_ += message->bytes.size();
  if (is_event(message)) ++events_;
  shed();
}

void TabQueue::shed() {
  if (events_ > kMostEvents) drop(std::ranges::find_if(waiting_, is_event));
  while (bytes_ > kMostBytes && waiting_.size() > 1) {
    const auto oldest_block = std::ranges::find_if(waiting_, is_block);
    drop(oldest_block != waiting_.end() ? oldest_block : waiting_.begin());
  }
}

void TabQueue::drop(std::deque<CarriedPointer>::iterator victim) {
  const Carried& message = **victim;
  if (message.kind == Carried::Kind::Block) {
    ++dropped_.blocks;
    dropped_.scans += message.scans;
  }
  if (message.kind == Carried::Kind::Event) {
    ++dropped_.events;
    --events_;
  }
  bytes_ -= message.bytes.size();
  waiting_.erase(victim);
}

bool TabQueue::painted(std::uint64_t frame) noexcept {
  if (frame <= last_painted_ || frame > last_frame_) return false;
  last_painted_ = frame;
  return true;
}

std::optional<TabQueue::Time> TabQueue::due() const noexcept {
  if (waiting_.empty() || last_frame_ - last_painted_ >= kFramesUnderWay) return std::nullopt;
  return std::max(last_sent_ + spacing_, first_pushed_ + kGathering);
}

std::string TabQueue::take_frame(Time now) {
  v1::FromGateway envelope;
  v1::Frame& frame = *envelope.mutable_frame();
  frame.set_number(++last_frame_);
  frame.set_dropped_blocks_total(dropped_.blocks);
  frame.set_dropped_scans_total(dropped_.scans);
  frame.set_dropped_events_total(dropped_.events);
  for (const CarriedPointer& message : waiting_) {
    v1::Carried& carried = *frame.add_messages();
    carried.set_topic(message->topic);
    carried.set_message(message->bytes);
  }
  waiting_.clear();
  bytes_ = 0;
  events_ = 0;
  last_sent_ = now;
  return envelope.SerializeAsString();
}

}  // namespace dts::gateway
