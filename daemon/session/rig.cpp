// SPDX-License-Identifier: Apache-2.0
#include "session/rig.h"

#include <algorithm>
#include <future>

#include "core/join.h"
#include "device/registry.h"

namespace dts::session {
namespace {

constexpr double kScansRingMs = 2000.0;   // the pipeline may stall this long before scans are lost
constexpr double kFramesRingMs = 1000.0;  // the publisher may stall this long
constexpr std::size_t kReaches = 256;     // a person reaches once in several seconds, and the control thread reads 20 times a second
constexpr double kCopRingMs = 4000.0;     // the control thread may be busy this long before a standing trial is lost
constexpr double kRecordRingMs = 8000.0;  // the disk may stall this long
constexpr int kBellPatienceMs = 100;      // the maximum delay of a stop on a silent rig

std::size_t blocks_in(const pipeline::RigConfig& config, double ms) {
  return std::max<std::size_t>(8, static_cast<std::size_t>(config.rate.scans_in_ms(ms)) / config.block_scans);
}

core::Status check_streams(const pipeline::RigConfig& config, const pipeline::Pipeline& pipeline, const std::vector<std::string>& wanted,
                           const std::string& verb) {
  for (const std::string& stream : wanted) {
    if (std::ranges::find(pipeline.formats(), stream, &core::StreamFormat::name) != pipeline.formats().end()) continue;
    if (stream == "aux") continue;  // a device without further channels has an empty stream "aux"
    return core::fail(core::ErrorCode::InvalidArgument, "rig '" + config.name + "' has no stream '" + stream + "' to " + verb,
                      "it has: " + core::join(pipeline.formats(), ", ", &core::StreamFormat::name));
  }
  return {};
}

constexpr std::size_t kCopChannels = 3;  // ml_mm, ap_mm, load_n

std::optional<std::size_t> cop_stream_of(const pipeline::Pipeline& pipeline) {
  const auto found = std::ranges::find(pipeline.formats(), std::string_view("cop"), &core::StreamFormat::name);
  if (found == pipeline.formats().end() || found->channels.size() != kCopChannels) return std::nullopt;
  return static_cast<std::size_t>(found - pipeline.formats().begin());
}

/// Returns the last stream that still has one channel per sensor. It has all quality bits, because the stages pass them on.
std::optional<std::size_t> sensor_stream_of(const pipeline::Pipeline& pipeline, std::size_t sensor_count) {
  for (const std::string_view name : {"deflection", "filtered", "raw"}) {
    const auto found = std::ranges::find(pipeline.formats(), name, &core::StreamFormat::name);
    if (found == pipeline.formats().end() || found->channels.size() != sensor_count) continue;
    return static_cast<std::size_t>(found - pipeline.formats().begin());
  }
  return std::nullopt;
}

core::Status check_device(const pipeline::RigConfig& config, const device::DeviceDescription& device) {
  const auto where = "rig '" + config.name + "': ";
  if (device.channels.size() > core::kMaxChannels) {
    return core::fail(core::ErrorCode::LimitExceeded, where + device.uri + " has " + std::to_string(device.channels.size()) +
                                                          " channels; at most " + std::to_string(core::kMaxChannels) + " are supported");
  }
  return {};
}

/// Rejects a trigger that can never be detected and a pulse that can never be sent: otherwise the mistake shows only when a trial is lost.
core::Status check_sync(const pipeline::RigConfig& config, const device::DeviceDescription& device) {
  const auto refuse = [&](const std::string& what, const std::string& hint = {}) {
    return core::fail(core::ErrorCode::InvalidArgument, "rig '" + config.name + "': " + what, hint);
  };
  if (config.sync_pulse_ms > 0.0 && !device.has_sync_output) {
    return refuse("[session] sync_pulse_ms needs a device with a sync output",
                  "for an MCC device, add sync_output_bit=0 to the device address");
  }
  if (!config.trigger || config.trigger->channel >= device.channels.size()) return {};  // the pipeline rejects a missing channel
  const device::ChannelDescription& channel = device.channels[config.trigger->channel];
  if (channel.role == device::ChannelRole::Marker) return refuse("[trigger] channel " + channel.name + " is the marker: it never changes");
  const double half_band = config.trigger->hysteresis / 2.0;
  if (config.trigger->level - half_band > channel.minimum && config.trigger->level + half_band < channel.maximum) return {};
  return refuse("[trigger] level and hysteresis lie outside what channel " + channel.name + " can measure, " +
                std::to_string(channel.minimum) + " .. " + std::to_string(channel.maximum) + " " + channel.unit);
}

}  // namespace

core::Result<std::unique_ptr<Rig>> Rig::create(pipeline::RigConfig given, core::Clock& clock, core::Doorbell& publish_bell,
                                               device::usb::UsbBus* usb) {
  auto config = std::make_unique<pipeline::RigConfig>(std::move(given));
  DTS_TRY_ASSIGN(auto device, device::create_device(config->device_uri, {.clock = clock, .rig = config->model, .usb = usb}));
  return assemble(std::move(config), std::move(device), clock, publish_bell);
}

core::Result<std::unique_ptr<Rig>> Rig::create(pipeline::RigConfig config, std::unique_ptr<device::Device> device, core::Clock& clock,
                                               core::Doorbell& publish_bell) {
  return assemble(std::make_unique<pipeline::RigConfig>(std::move(config)), std::move(device), clock, publish_bell);
}

core::Result<std::unique_ptr<Rig>> Rig::assemble(std::unique_ptr<pipeline::RigConfig> config, std::unique_ptr<device::Device> device,
                                                 core::Clock& clock, core::Doorbell& publish_bell) {
  const device::DeviceDescription& described = device->describe();
  DTS_TRY(check_device(*config, described));
  DTS_TRY(check_sync(*config, described));
  const auto exact_rate = device->exact_rate(config->rate);
  if (!exact_rate) {
    core::Error error = exact_rate.error();
    error.what = "rig '" + config->name + "': " + error.what;
    return tl::make_unexpected(error);
  }
  config->rate = *exact_rate;  // all formats, windows and times depend on the exact rate
  DTS_TRY_ASSIGN(auto made, make_rig_pipeline(*config, described));
  DTS_TRY(restore_recorded(*made.pipeline, described));
  for (const auto& [streams, verb] : {std::pair{&config->published, "publish"}, std::pair{&config->recorded, "record"}}) {
    DTS_TRY(check_streams(*config, *made.pipeline, *streams, verb));
  }
  if (config->published.empty()) {
    for (const core::StreamFormat& format : made.pipeline->formats()) config->published.push_back(format.name);
  }
  return std::unique_ptr<Rig>(new Rig(std::move(config), clock, publish_bell, std::move(device), std::move(made)));
}

Rig::Rig(std::unique_ptr<const pipeline::RigConfig> config, core::Clock& clock, core::Doorbell& publish_bell,
         std::unique_ptr<device::Device> device, RigPipeline made)
    : config_(std::move(config)),
      clock_(clock),
      publish_bell_(publish_bell),
      device_(std::move(device)),
      tare_(std::move(made.tare)),
      windows_(std::move(made.windows)),
      pipeline_(std::move(made.pipeline)),
      scans_(blocks_in(*config_, kScansRingMs),
             core::Acquired{.block = core::Block(device_->describe().channels.size(), config_->block_scans)}),
      frames_(blocks_in(*config_, kFramesRingMs), pipeline_->make_frame()),
      reaches_(kReaches),
      cop_stream_(cop_stream_of(*pipeline_)),
      cops_(cop_stream_ ? blocks_in(*config_, kCopRingMs) : 1, core::Block(kCopChannels, cop_stream_ ? config_->block_scans : 0)),
      tap_(blocks_in(*config_, kRecordRingMs), *pipeline_),
      spare_frame_(pipeline_->make_frame()),
      acquisition_(*device_, clock, scans_, scans_bell_, config_->rate, config_->block_scans),
      statistics_(device_->describe().channels.size(), config_->rate.scans_in_ms(1000.0)),
      sensor_stream_(sensor_stream_of(*pipeline_, config_->sensor_channels.size())),
      sensor_watch_(config_->sensor_channels.size(), sensor_stream_ ? pipeline_->formats()[*sensor_stream_].rate.scans_in_ms(1000.0) : 1) {}

Rig::~Rig() { stop(); }

void Rig::start(core::Log log) {
  std::promise<std::vector<std::string>> acquire_ready;
  std::promise<std::vector<std::string>> pipeline_ready;
  pipeline_thread_ = std::jthread([this, &pipeline_ready](const std::stop_token& stop) {
    pipeline_ready.set_value(core::configure_this_thread("pipe-" + config_->name, config_->pipeline_policy));
    run_pipeline(stop);
  });
  acquire_thread_ = std::jthread([this, &acquire_ready] {
    acquire_ready.set_value(core::configure_this_thread("acq-" + config_->name, config_->acquire_policy));
    acquisition_.run();
  });
  for (auto* ready : {&acquire_ready, &pipeline_ready}) {
    for (std::string& refused : ready->get_future().get()) {
      log.warning("rig '" + config_->name + "': " + refused);
      notices_.push_back(std::move(refused));
    }
  }
}

void Rig::stop() noexcept {
  acquisition_.request_stop();
  pipeline_thread_.request_stop();
  scans_bell_.ring();
  if (acquire_thread_.joinable()) acquire_thread_.join();
  if (pipeline_thread_.joinable()) pipeline_thread_.join();
}

void Rig::run_pipeline(const std::stop_token& stop) noexcept {
  while (!stop.stop_requested()) {
    tap_.follow();
    while (core::Acquired* acquired = scans_.front()) {
      wait_for_recorder(stop);
      process(*acquired);
      scans_.release();
    }
    scans_bell_.wait(kBellPatienceMs);
  }
}

/// A device that waits for its reader can be faster than any disk: then the recorder sets the pace.
void Rig::wait_for_recorder(const std::stop_token& stop) noexcept {
  while (device_->describe().waits_for_reader && tap_.is_blocked() && !stop.stop_requested()) {
    clock_.sleep_until_ns(clock_.now_ns() + core::kNanosecondsPerMillisecond);
  }
}

void Rig::process(const core::Acquired& acquired) noexcept {
  const std::int64_t started_ns = clock_.now_ns();
  std::size_t frames_waiting = frames_.capacity();
  core::Frame* slot = frames_.claim();
  core::Frame& frame = slot != nullptr ? *slot : spare_frame_;
  tap_.follow();
  pipeline_->process(acquired, frame);
  tap_.offer(frame, pipeline_->events());
  offer_events(pipeline_->events());
  offer_cop(frame);
  frame.gap_before = core::merged(unpublished_gap_, frame.gap_before);
  if (slot != nullptr) {
    unpublished_gap_ = {};
    frame.event_count = events_.take_count();
    frames_.commit();
    frames_waiting = frames_.waiting();  // before the publisher is woken up
    publish_bell_.ring();
  } else {
    unpublished_gap_ = frame.gap_before;
    frames_.drop();
  }
  if (acquired.gap_before.reason != core::GapReason::None) statistics_.reset();
  statistics_.add(acquired.block);
  if (sensor_stream_) sensor_watch_.add(frame.streams[*sensor_stream_]);
  const std::int64_t ended_ns = clock_.now_ns();
  pipeline_state_.frames_waiting.note(frames_waiting, ended_ns);
  pipeline_state_.slots_waiting.note(tap_.waiting(), ended_ns);
  note_progress(acquired.block, ended_ns - started_ns);
}

std::string Rig::sensor_problems() {
  const AcquisitionReport& acquired = acquisition();
  const bool has_scans = acquired.device == device::DeviceState::Streaming && !acquired.is_silent && !acquired.is_armed;
  if (!has_scans || !sensor_stream_) return {};
  std::vector<std::string> names;
  for (const std::size_t channel : config_->sensor_channels) names.push_back(device_->describe().channels[channel].name);
  return session::sensor_problems(sensor_watch_.latest(), names);
}

void Rig::offer_events(const core::FrameEvents& events) noexcept {
  pipeline_state_.lost_events_total += events.lost() + events_.push(events);
  core::for_each(events, [this](const core::Event& event) {
    const bool is_of_a_reach = std::holds_alternative<core::ReachEvent>(event) || std::holds_alternative<core::ClassEvent>(event);
    if (is_of_a_reach && !reaches_.push(event)) ++pipeline_state_.lost_events_total;
  });
}

void Rig::offer_cop(const core::Frame& frame) noexcept {
  if (!cop_stream_ || frame.streams[*cop_stream_].count() == 0) return;
  core::Block* const slot = cops_.claim();
  if (slot == nullptr) return cops_.drop();
  slot->copy_from(frame.streams[*cop_stream_]);
  cops_.commit();
}

std::optional<core::Rate> Rig::cop_rate() const noexcept {
  if (!cop_stream_) return std::nullopt;
  return pipeline_->formats()[*cop_stream_].rate;
}

RingFill Rig::ring_fill() noexcept {
  const std::int64_t now_ns = clock_.now_ns();
  const auto percent = [now_ns](const RecentPeak& peak, std::size_t capacity) {
    return 100.0 * static_cast<double>(peak.at(now_ns)) / static_cast<double>(capacity);
  };
  const PipelineReport& pipeline = pipeline_report();
  return {.scans_percent = percent(acquisition().ring_blocks, scans_.capacity()),
          .frames_percent = percent(pipeline.frames_waiting, frames_.capacity()),
          .record_percent = percent(pipeline.slots_waiting, tap_.capacity())};
}

/// Call after all data of the block are in the rings: a reader of this report then finds everything before its position.
void Rig::note_progress(const core::Block& block, std::int64_t spent_ns) noexcept {
  if (block.count() == 0) return;
  constexpr double kWeight = 0.02;  // about the last 50 blocks
  const double us_per_scan = static_cast<double>(spent_ns) * 1e-3 / static_cast<double>(block.count());
  pipeline_state_.us_per_scan += kWeight * (us_per_scan - pipeline_state_.us_per_scan);
  pipeline_state_.dropped_blocks_total = frames_.dropped();
  pipeline_state_.segment = block.segment;
  pipeline_state_.next_scan = block.first_scan + block.count();
  pipeline_report_.store(pipeline_state_);
}

}  // namespace dts::session
