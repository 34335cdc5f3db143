// SPDX-License-Identifier: Apache-2.0
#include "ipc/publish_thread.h"

#include <algorithm>
#include <future>
#include <utility>

#include "dts/wire/options.h"
#include "events/make.h"

namespace dts::ipc {
namespace {

constexpr std::size_t kLongestOutbox = 1000;
constexpr int kWaitMs = 200;
constexpr int kRetainedMs = 100;
/// Most frames of one rig per turn; then the other rigs, subscriptions and stop requests are handled.
constexpr int kFramesPerTurn = 64;

std::string event_topic(const std::string& rig, const dts::v1::Event& event) { return rig + "/" + wire::topic_of(event).name(); }

}  // namespace

PublishThread::PublishThread(std::unique_ptr<DataSocket> socket, core::Doorbell& bell, const std::vector<session::Rig*>& rigs,
                             core::Clock& clock, std::uint64_t instance_id)
    : socket_(std::move(socket)), bell_(bell), clock_(clock), instance_id_(instance_id) {
  for (session::Rig* rig : rigs) {
    const pipeline::RigConfig& config = rig->config();
    Source source{.rig = rig, .trigger_channel = {}, .streams = {}};
    if (config.trigger) source.trigger_channel = rig->device().channels.at(config.trigger->channel).name;
    for (std::size_t index = 0; index < rig->formats().size(); ++index) {
      const core::StreamFormat& format = rig->formats()[index];
      if (std::ranges::find(config.published, format.name) == config.published.end()) continue;
      source.streams.emplace_back(index, StreamEncoder(instance_id, config.name, format));
    }
    sources_.push_back(std::move(source));
  }
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
    is_retained_due_ = socket_->take_subscriptions() || is_retained_due_;  // first: new subscribers get what is published now
    turns_.fetch_add(1, std::memory_order_relaxed);
    for (Source& source : sources_) {
      publish(source);
      socket_->flush();
    }
    send_outbox();
    if (is_retained_due_) send_retained();
  }
  for (Source& source : sources_) publish(source);
  send_outbox();
}

void PublishThread::publish(Source& source) {
  core::SpscRing<core::Frame>& frames = source.rig->frames();
  for (int turn = 0; turn < kFramesPerTurn; ++turn) {
    core::Frame* frame = frames.front();
    if (frame == nullptr) return;
    if (frame->gap_before.reason != core::GapReason::None) send_event(source, events::make_gap(*frame));
    // Triggers are the first events of a frame. They are sent before its blocks, all other events after them. If the frame also counts the
    // events of dropped frames, only the triggers before the first other event are sent before its blocks.
    std::uint32_t left = frame->event_count;
    while (left > 0 && std::holds_alternative<core::TriggerEvent>(*source.rig->events().front())) send_next_event(source, left);
    send_streams(source, *frame);
    note_latency(source, *frame);
    while (left > 0) send_next_event(source, left);
    frames.release();
  }
  bell_.ring();  // more frames may be waiting: continue after the other rigs
}

void PublishThread::send_streams(Source& source, const core::Frame& frame) {
  for (auto& [index, encoder] : source.streams) {
    const core::Block& block = frame.streams[index];
    if (block.count() == 0) continue;
    socket_->send(encoder.topic(), encoder.encode(block, frame.lost_scans_total, source.rig->dropped_blocks()));
  }
}

/// Measures the latency of the first stream, the raw one: it has no filter delay.
void PublishThread::note_latency(Source& source, const core::Frame& frame) {
  const core::Block& raw = frame.streams.front();
  if (raw.count() == 0) return;
  const std::int64_t newest_ns = raw.host_time_ns + source.rig->formats().front().rate.time_ns({raw.count() - 1});
  source.latency.add(static_cast<double>(clock_.now_ns() - newest_ns) * 1e-6);
  source.rig->note_latency(source.latency);
}

void PublishThread::send_next_event(const Source& source, std::uint32_t& left) {
  core::EventLane& events = source.rig->events();
  send_event(source, events::make(*events.front(), source.trigger_channel));
  events.release();
  --left;
}

void PublishThread::send_event(const Source& source, dts::v1::Event event) {
  event.set_instance_id(instance_id_);
  socket_->send(event_topic(source.rig->config().name, event), event);
}

void PublishThread::send_outbox() {
  std::vector<Outgoing> messages;
  {
    const std::lock_guard lock(outbox_mutex_);
    messages = std::exchange(outbox_, {});
  }
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
  socket_->flush();
}

void PublishThread::send_retained() {
  const std::int64_t now_ns = clock_.now_ns();
  if (retained_sent_ns_ != 0 && now_ns - retained_sent_ns_ < kRetainedMs * core::kNanosecondsPerMillisecond) return;
  retained_sent_ns_ = now_ns;
  is_retained_due_ = false;
  for (const Outgoing& outgoing : retained_) socket_->send(outgoing.topic, *outgoing.message);
  socket_->flush();
}

}  // namespace dts::ipc
