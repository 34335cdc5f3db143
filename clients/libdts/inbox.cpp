// SPDX-License-Identifier: Apache-2.0
#include "inbox.h"

#include <algorithm>
#include <utility>

#include "dts/wire/options.h"
#include "wire_check.h"

namespace dts::client {
namespace {

constexpr std::size_t kMaxTopics = 1024;
constexpr std::size_t kMaxReady = 4096;
constexpr std::size_t kMaxHeld = 16384;
constexpr std::size_t kMaxHeldBytes = 32U << 20U;
/// More than the scheduling jitter of a busy machine, less than a person notices.
constexpr std::int64_t kStaleNs = 50'000'000;

template <class Wire>
bool parse(Wire& message, std::span<const std::byte> body) {
  return message.ParseFromArray(body.data(), static_cast<int>(body.size()));
}

/// Returns the time from the newest scan of the block to `now_ns`. Uses modular arithmetic: times from the wire may have any value.
std::int64_t delay_of(const v1::StreamBlock& block, std::int64_t now_ns) noexcept {
  const double length_ns = 1e9 * static_cast<double>(block.scan_count() - 1) * static_cast<double>(block.rate().denominator()) /
                           static_cast<double>(block.rate().numerator());
  const auto length = static_cast<std::uint64_t>(std::min(length_ns, 1e15));
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(now_ns) - static_cast<std::uint64_t>(block.host_time_ns()) - length);
}

StreamFormat to_format(const v1::StreamFormat& wire) {
  StreamFormat format{
      .name = wire.name(), .rate = {wire.rate().numerator(), wire.rate().denominator()}, .channels = {}, .delay_ns = wire.delay_ns()};
  for (const v1::Channel& channel : wire.channels()) format.channels.push_back({.name = channel.name(), .unit = channel.unit()});
  return format;
}

}  // namespace

Inbox::Inbox(Mode mode, bool hands_out_status, std::string boot_id)
    : mode_(mode), hands_out_status_(hands_out_status), boot_id_(std::move(boot_id)) {}

void Inbox::accept(std::string_view topic, std::span<const std::byte> body, std::int64_t now_ns) {
  if (body.size() > kMaxMessageBytes) {
    ++statistics_.malformed;
    return;
  }
  if (Topic* known = find_topic(topic)) process(*known, body, now_ns);
}

Inbox::Topic* Inbox::find_topic(std::string_view topic) {
  if (const auto known = topics_.find(topic); known != topics_.end()) return &known->second;
  const auto name = parse_topic(topic);
  const bool is_unknown_stream = name && name->kind == TopicKind::Stream && knows_formats_ && !formats_.contains(topic);
  if (!name || is_unknown_stream || topics_.size() == kMaxTopics) {
    ++statistics_.unknown_topics;
    return nullptr;
  }
  Topic& added = topics_[std::string(topic)];
  added.text = topic;
  added.name = *parse_topic(added.text);
  return &added;
}

void Inbox::process(Topic& topic, std::span<const std::byte> body, std::int64_t arrived_ns) {
  switch (topic.name.kind) {
    case TopicKind::Stream: return accept_block(topic, body, arrived_ns);
    case TopicKind::Event: return accept_event(topic, body);
    case TopicKind::Status: return accept_status(body);
  }
}

void Inbox::accept_status(std::span<const std::byte> body) {
  v1::StatusSnapshot snapshot;
  if (!parse(snapshot, body) || !check(snapshot)) {
    ++statistics_.malformed;
    return;
  }
  ++statistics_.messages;
  note_instance(snapshot.instance_id());
  status_.Swap(&snapshot);
  has_status_ = true;
  learn_formats();
  const auto is_status = [](const Ready& item) { return std::holds_alternative<ReadyStatus>(item); };
  if (hands_out_status_ && std::ranges::none_of(ready_, is_status)) ready_.emplace_back(ReadyStatus{});
}

void Inbox::learn_formats() {
  is_same_host_ = !boot_id_.empty() && status_.boot_id() == boot_id_;
  for (const v1::RigStatus& rig : status_.rigs()) {
    for (const v1::StreamFormat& stream : rig.rig().streams()) {
      const std::string topic = rig.rig().name() + "/" + stream.name();
      if (!formats_.contains(topic)) formats_.emplace(topic, to_format(stream));
    }
  }
  knows_formats_ = true;
  enqueue_pending();
}

void Inbox::enqueue_pending() {
  for (auto& [text, topic] : topics_) {
    if (!topic.is_pending || topic.is_queued) continue;
    if (has_format(topic, topic.block)) {
      topic.is_queued = true;
      ready_.emplace_back(&topic);
    } else {
      topic.is_pending = false;
      --statistics_.messages;  // `has_format` has counted the block as unknown or malformed
    }
  }
}

/// Finds the topic's format. Returns false, and counts the reason, if there is no format or the block does not match it.
bool Inbox::has_format(Topic& topic, const v1::StreamBlock& block) {
  if (topic.format == nullptr) {
    const auto format = formats_.find(topic.text);
    if (format == formats_.end()) {
      ++statistics_.unknown_topics;
      return false;
    }
    topic.format = &format->second;
  }
  if (topic.format->channels.size() == block.channel_count()) return true;
  ++statistics_.malformed;
  return false;
}

void Inbox::accept_event(Topic& topic, std::span<const std::byte> body) {
  v1::Event event;
  if (!parse(event, body) || event.instance_id() == 0 || wire::topic_of(event).name() != topic.name.name) {
    ++statistics_.malformed;
    return;
  }
  note_instance(event.instance_id());
  if (!held_.empty() && !knows_formats_) return hold(topic, body, 0);  // keeps its order among the held blocks
  ++statistics_.messages;
  if (wire::topic_of(event).is_retained()) {
    const std::string_view bytes(reinterpret_cast<const char*>(body.data()), body.size());
    if (topic.last_retained == bytes) return;
    topic.last_retained = bytes;
  }
  enqueue_event(topic, std::move(event));
}

void Inbox::enqueue_event(Topic& topic, v1::Event&& event) {
  if (ready_.size() >= kMaxReady) {
    const auto oldest = std::ranges::find_if(ready_, [](const Ready& item) { return std::holds_alternative<ReadyEvent>(item); });
    if (oldest != ready_.end()) {
      ready_.erase(oldest);
      ++statistics_.dropped_events;
    }
  }
  ready_.emplace_back(ReadyEvent{&topic, std::move(event)});
}

void Inbox::accept_block(Topic& topic, std::span<const std::byte> body, std::int64_t arrived_ns) {
  if (knows_formats_ && !formats_.contains(topic.text)) {  // perhaps a topic of a later version of the protocol
    ++statistics_.unknown_topics;
    return;
  }
  if (!parse(scratch_, body) || !is_well_formed(scratch_)) {
    ++statistics_.malformed;
    return;
  }
  note_instance(scratch_.instance_id());
  if (!knows_formats_ && mode_ == Mode::All) return hold(topic, body, arrived_ns);
  if (knows_formats_ && !has_format(topic, scratch_)) return;
  ++statistics_.messages;
  take_block(topic, arrived_ns);
  if (!knows_formats_ || topic.is_queued) return;
  topic.is_queued = true;
  ready_.emplace_back(&topic);
}

/// Makes `scratch_` the topic's block. If a block still waits there, its scans count as lost.
void Inbox::take_block(Topic& topic, std::int64_t arrived_ns) {
  count_gap(topic, scratch_);
  if (topic.is_pending) topic.lost_scans += topic.block.scan_count();
  topic.block.Swap(&scratch_);
  topic.is_pending = true;
  topic.delay_ns = delay_of(topic.block, arrived_ns);
}

void Inbox::count_gap(Topic& topic, const v1::StreamBlock& block) {
  const ScanGap gap = topic.tracker.advance(
      {.segment = block.segment(), .first_scan = block.first_scan(), .scan_count = block.scan_count(), .sequence = block.sequence()});
  topic.lost_scans += gap.scans;
  topic.is_lost_exact = topic.is_lost_exact && gap.is_exact;
  if (!gap.is_consistent) ++statistics_.inconsistent;
}

void Inbox::hold(Topic& topic, std::span<const std::byte> body, std::int64_t arrived_ns) {
  while (!held_.empty() && (held_.size() == kMaxHeld || held_bytes_ + body.size() > kMaxHeldBytes)) drop_oldest_held();
  held_.push_back({&topic, std::string(reinterpret_cast<const char*>(body.data()), body.size()), arrived_ns});
  held_bytes_ += body.size();
}

void Inbox::drop_oldest_held() {
  const Held& oldest = held_.front();
  if (oldest.topic->name.kind == TopicKind::Event) {
    ++statistics_.dropped_events;
  } else if (parse(scratch_, std::as_bytes(std::span(oldest.body)))) {
    count_gap(*oldest.topic, scratch_);
    oldest.topic->lost_scans += scratch_.scan_count();
  }
  held_bytes_ -= oldest.body.size();
  held_.pop_front();
}

void Inbox::replay_held() {
  while (!held_.empty() && ready_.empty()) {
    const Held oldest = std::move(held_.front());
    held_bytes_ -= oldest.body.size();
    held_.pop_front();
    process(*oldest.topic, std::as_bytes(std::span(oldest.body)), oldest.arrived_ns);
  }
}

void Inbox::note_instance(std::uint64_t instance_id) {
  if (instance_id == instance_id_) return;
  const std::uint64_t old = std::exchange(instance_id_, instance_id);
  if (old == 0) return;
  ++statistics_.restarts;
  // Blocks of the old run are dropped because their formats become invalid; its events and status still wait for the caller.
  std::erase_if(ready_, [](const Ready& item) { return std::holds_alternative<Topic*>(item); });
  held_.clear();
  held_bytes_ = 0;
  formats_.clear();
  knows_formats_ = false;
  has_status_ = false;
  for (auto& [text, topic] : topics_) topic.forget();
  ready_.emplace_back(Restart{.old_instance_id = old, .new_instance_id = instance_id});
}

void Inbox::Topic::forget() {
  format = nullptr;
  is_pending = false;
  is_queued = false;
  tracker.reset();
  lost_scans = 0;
  is_lost_exact = true;
  usual_delay_ns.reset();
  last_retained.clear();
}

std::optional<Message> Inbox::next(std::int64_t now_ns) {
  if (ready_.empty() && knows_formats_) replay_held();
  if (ready_.empty()) return std::nullopt;
  current_ = std::move(ready_.front());
  ready_.pop_front();
  if (Topic** topic = std::get_if<Topic*>(&current_)) return block_view(**topic, now_ns);
  if (const ReadyEvent* event = std::get_if<ReadyEvent>(&current_)) {
    const Topic& topic = *event->topic;
    return Event{.topic = topic.text, .rig = topic.name.rig, .kind = topic.name.name, .body = &event->event};
  }
  if (std::holds_alternative<ReadyStatus>(current_)) return Status{&status_};
  return std::get<Restart>(current_);
}

Block Inbox::block_view(Topic& topic, std::int64_t now_ns) {
  const v1::StreamBlock& wire = topic.block;
  Block block;
  block.topic = topic.text;
  block.rig = topic.name.rig;
  block.stream = topic.name.name;
  block.format = topic.format;
  block.segment = wire.segment();
  block.first_scan = wire.first_scan();
  block.scan_count = wire.scan_count();
  block.rate = {wire.rate().numerator(), wire.rate().denominator()};
  block.host_time_ns = wire.host_time_ns();
  block.host_time_uncertainty_ns = wire.host_time_uncertainty_ns();
  block.sequence = wire.sequence();
  block.lost_scans = std::exchange(topic.lost_scans, 0);
  block.is_lost_exact = std::exchange(topic.is_lost_exact, true);
  if (is_same_host_) block.age_ns = delay_of(wire, now_ns);
  block.lost_before_pipeline_total = wire.lost_scans_total();
  block.dropped_blocks_total = wire.dropped_blocks_total();
  block.values = {wire.values().data(), static_cast<std::size_t>(wire.values_size())};
  block.quality = {reinterpret_cast<const std::uint8_t*>(wire.quality().data()), wire.quality().size()};
  block.body = &wire;
  topic.usual_delay_ns = std::min(topic.usual_delay_ns.value_or(topic.delay_ns), topic.delay_ns);
  topic.is_pending = false;
  topic.is_queued = false;
  return block;
}

// Compares halves: the difference of two times from the wire may exceed 64 bits.
bool Inbox::is_late(const Ready& item) noexcept {
  const auto* topic = std::get_if<Topic*>(&item);
  return topic != nullptr && (*topic)->usual_delay_ns && (*topic)->delay_ns / 2 - *(*topic)->usual_delay_ns / 2 > kStaleNs / 2;
}

bool Inbox::is_behind() const noexcept { return std::ranges::any_of(ready_, is_late); }

void Inbox::accept_delays() noexcept {
  for (const Ready& item : ready_) {
    if (const auto* topic = std::get_if<Topic*>(&item)) (*topic)->usual_delay_ns = (*topic)->delay_ns;
  }
}

}  // namespace dts::client
