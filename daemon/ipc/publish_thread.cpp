// SPDX-License-Identifier: Apache-2.0
#include "ipc/publish_thread.h"

#include <algorithm>
#include <future>
#include <limits>
#include <span>
#include <utility>

#include "dts/wire/options.h"
#include "events/make.h"

namespace dts::ipc {
namespace {

constexpr std::size_t kLongestOutbox = 1000;
constexpr std::size_t kBytesOfAValue = 5;  // a float and its quality
constexpr std::size_t kBytesBesideValues = 256;
constexpr std::size_t kAllPeers = std::numeric_limits<std::size_t>::max();
constexpr int kWaitMs = 200;
constexpr int kRetainedMs = 100;

std::string event_topic(const std::string& rig, const dts::v1::Event& event) { return rig + "/" + wire::topic_of(event).name(); }

}  // namespace

PublishThread::Source::Source(PublishThread& owner_of_this, session::Rig& rig_to_publish, std::uint64_t instance_id)
    : owner(owner_of_this), rig(rig_to_publish), frames(rig.frames(), rig.frames().capacity()) {
  const pipeline::RigConfig& config = rig.config();
  std::size_t bytes = 0;
  if (config.trigger) trigger_channel = rig.device().channels.at(config.trigger->channel).name;
  for (std::size_t index = 0; index < rig.formats().size(); ++index) {
    const core::StreamFormat& format = rig.formats()[index];
    if (std::ranges::find(config.published, format.name) == config.published.end()) continue;
    streams.emplace_back(index, StreamEncoder(instance_id, config.name, format));
    bytes += kBytesBesideValues + kBytesOfAValue * format.channels.size() * config.block_scans;
  }
  is_short = bytes <= kFrameBytesOfARig;
}

PublishThread::PublishThread(std::unique_ptr<DataSocket> socket, core::Doorbell& bell, const std::vector<session::Rig*>& rigs,
                             core::Clock& clock, std::uint64_t instance_id)
    : socket_(std::move(socket)), bell_(bell), clock_(clock), instance_id_(instance_id) {
  for (session::Rig* rig : rigs) {
    Source& source = sources_.emplace_back(*this, *rig, instance_id);
    for (const auto& [index, encoder] : source.streams) socket_->expect(encoder.topic());
    rig->publish_with(source);
  }
}

PublishThread::~PublishThread() {
  for (Source& source : sources_) source.rig.stop();
  stop();
}

std::vector<std::string> PublishThread::start(const core::ThreadPolicy& policy) {
  std::promise<std::vector<std::string>> ready;
  auto refused = ready.get_future();
  thread_ = std::jthread([this, &ready, policy](const std::stop_token& stop) {
    ready.set_value(core::configure_this_thread("publish", policy));
    run(stop);
  });
  return refused.get();
}

void PublishThread::stop() noexcept {
  thread_.request_stop();
  bell_.ring();
  if (thread_.joinable()) thread_.join();
}

void PublishThread::post(const std::string& rig, dts::v1::Event event) {
  event.set_instance_id(instance_id_);
  std::string topic = event_topic(rig, event);
  const bool is_retained = wire::topic_of(event).is_retained();
  post({std::move(topic), std::make_shared<dts::v1::Event>(std::move(event)), is_retained});
}

void PublishThread::post(dts::v1::StatusSnapshot status) {
  post({"dtsd/status", std::make_shared<dts::v1::StatusSnapshot>(std::move(status)), true});
}

void PublishThread::post(Outgoing outgoing) {
  {
    const std::lock_guard lock(outbox_mutex_);
    if (outbox_.size() == kLongestOutbox) {
      const auto expendable = std::ranges::find(outbox_, false, &Outgoing::is_retained);
      outbox_.erase(expendable != outbox_.end() ? expendable : outbox_.begin());
    }
    outbox_.push_back(std::move(outgoing));
  }
  bell_.ring();
}

void PublishThread::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    socket_->wait(bell_.fd(), is_retained_due_ ? kRetainedMs : kWaitMs);
    bell_.clear();
    turns_.fetch_add(1, std::memory_order_relaxed);
    {
      const std::lock_guard lock(socket_mutex_);
      is_retained_due_ = socket_->take_subscriptions() || is_retained_due_;  // first: new subscribers get what is published now
    }
    publish_all();
    send_outbox();
    if (is_retained_due_) send_retained();
  }
  publish_all();
  send_outbox();
}

void PublishThread::publish_all() {
  for (Source& source : sources_) {
    const std::lock_guard lock(socket_mutex_);
    if (!publish(source, Caller::Publish)) bell_.ring();  // continue after the other rigs
    static_cast<void>(flush(source, kAllPeers));
  }
}

bool PublishThread::publish_from_rig(Source& source) noexcept {
  const std::unique_lock lock(socket_mutex_, std::try_to_lock);
  if (!lock || !source.is_short || source.frames.waiting() > kFramesOfARig) return false;
  const bool is_all = publish(source, Caller::Rig);
  return flush(source, kPeersOfARig) && is_all;
}

/// Gives what was sent to the system, and then notes its latency.
bool PublishThread::flush(Source& source, std::size_t most_peers) {
  const bool is_all = socket_->flush(most_peers);
  const std::int64_t now_ns = clock_.now_ns();
  for (const std::int64_t newest_ns : std::span(source.newest_ns).first(source.unflushed)) {
    source.report.latency.add(static_cast<double>(now_ns - newest_ns) * 1e-6);
  }
  source.unflushed = 0;
  source.report.lost_frames = source.frames.lost_frames();
  source.report.lost_events = source.frames.lost_events();
  source.rig.note_published(source.report);
  return is_all;
}

/// Returns false if frames are left: too many for one turn, or, on a rig's thread, one with events.
bool PublishThread::publish(Source& source, Caller caller) {
  core::FrameReader& frames = source.frames;
  source.report.frames_waiting.note(frames.waiting(), clock_.now_ns());
  for (std::size_t turn = 0; turn < kFramesPerTurn; ++turn) {
    const core::Frame* const frame = frames.front();
    if (frame == nullptr) return true;
    const bool has_gap = frame->gap_before.reason != core::GapReason::None;
    const auto events = frames.events();
    if (caller == Caller::Rig && (has_gap || !events.empty())) return false;  // to make an event needs memory
    if (has_gap) send_event(source, events::make_gap(*frame));
    // Triggers are the first events of a frame. They are sent before its blocks, all other events after them.
    const auto is_trigger = [](const core::Event& event) { return std::holds_alternative<core::TriggerEvent>(event); };
    const auto others = std::ranges::find_if_not(events, is_trigger);
    std::for_each(events.begin(), others, [&](const core::Event& event) { send_event(source, event); });
    send_streams(source, *frame);
    note_newest(source, *frame);
    std::for_each(others, events.end(), [&](const core::Event& event) { send_event(source, event); });
    frames.release();
  }
  return frames.waiting() == 0;
}

void PublishThread::send_streams(Source& source, const core::Frame& frame) {
  for (auto& [index, encoder] : source.streams) {
    const core::Block& block = frame.streams[index];
    if (block.count() == 0 || !socket_->is_wanted(encoder.topic())) continue;
    socket_->send(encoder.topic(), encoder.encode(block, frame.lost_scans_total, source.frames.lost_frames()));
  }
}

/// Notes the newest scan of the first stream, the raw one: it has no filter delay.
void PublishThread::note_newest(Source& source, const core::Frame& frame) {
  const core::Block& raw = frame.streams.front();
  if (raw.count() == 0 || source.unflushed == source.newest_ns.size()) return;
  source.newest_ns[source.unflushed++] = raw.host_time_ns + source.rig.formats().front().rate.time_ns({raw.count() - 1});
}

void PublishThread::send_event(const Source& source, const core::Event& event) {
  send_event(source, events::make(event, source.trigger_channel));
}

void PublishThread::send_event(const Source& source, dts::v1::Event event) {
  event.set_instance_id(instance_id_);
  socket_->send(event_topic(source.rig.config().name, event), event);
}

void PublishThread::send_outbox() {
  std::vector<Outgoing> messages;
  {
    const std::lock_guard lock(outbox_mutex_);
    messages = std::exchange(outbox_, {});
  }
  if (messages.empty()) return;
  const std::lock_guard lock(socket_mutex_);
  for (Outgoing& outgoing : messages) {
    socket_->send(outgoing.topic, *outgoing.message);
    if (!outgoing.is_retained) continue;
    const auto same_topic = std::ranges::find(retained_, outgoing.topic, &Outgoing::topic);
    if (same_topic != retained_.end()) {
      *same_topic = std::move(outgoing);
    } else {
      retained_.push_back(std::move(outgoing));
    }
  }
  static_cast<void>(socket_->flush(kAllPeers));
}

void PublishThread::send_retained() {
  const std::int64_t now_ns = clock_.now_ns();
  if (retained_sent_ns_ != 0 && now_ns - retained_sent_ns_ < kRetainedMs * core::kNanosecondsPerMillisecond) return;
  retained_sent_ns_ = now_ns;
  is_retained_due_ = false;
  const std::lock_guard lock(socket_mutex_);
  for (const Outgoing& outgoing : retained_) socket_->send(outgoing.topic, *outgoing.message);
  static_cast<void>(socket_->flush(kAllPeers));
}

}  // namespace dts::ipc
