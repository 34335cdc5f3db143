// SPDX-License-Identifier: Apache-2.0
#include "session/rig.h"

#include <algorithm>
#include <cmath>
#include <future>
#include <string_view>

#include "core/join.h"
#include "device/registry.h"

namespace dts::session {
namespace {

constexpr double kRingMs = 8000.0;        // the disk may stall this long
constexpr std::size_t kFewestFrames = 8;  // at low rates with large blocks
constexpr int kFramesPerCall = 64;        // of a burst, before the publisher is called

std::size_t blocks_in(const pipeline::RigConfig& config, double ms) {
  return std::max(kFewestFrames, static_cast<std::size_t>(config.rate.scans_in_ms(ms)) / config.block_scans);
}

/// Returns which streams are computed. These are published and recorded as float32; "raw" and "aux" are recorded as the device measured.
std::vector<bool> computed_streams(const pipeline::Pipeline& pipeline) {
  std::vector<bool> are_computed;
  for (const core::StreamFormat& format : pipeline.formats()) are_computed.push_back(format.name != "raw" && format.name != "aux");
  return are_computed;
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

constexpr std::size_t kCopChannels = 3;                 // ml_mm, ap_mm, load_n
constexpr std::int64_t kTravelShownNs = 2'000'000'000;  // a person who sways reaches the end of the travel now and then
constexpr std::string_view kBeyondTravel =
    "the load bends the plate further than its sensors measure, so load and centre of pressure are less exact: ask the person to stand in "
    "the middle of the plate; a person who is too heavy for this plate needs a stiffer one";

constexpr std::string_view kSensorAdvice = "check plug, supply and distance to the plate";
constexpr std::string_view kForcePlateAdvice =
    "check plug, supply and range of the force plate's amplifier, and reset it while the plate is empty";

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
                                               device::usb::UsbBus* usb, device::ProgramRights programs) {
  auto config = std::make_unique<pipeline::RigConfig>(std::move(given));
  DTS_TRY_ASSIGN(auto device, device::create_device(config->device_uri,
                                                    {.clock = clock, .rig = config->model, .usb = usb, .programs = std::move(programs)}));
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
      stances_(std::move(made.stances)),
      pipeline_(std::move(made.pipeline)),
      frame_(pipeline_->make_frame()),
      frames_(blocks_in(*config_, kRingMs), frame_, computed_streams(*pipeline_)),
      cop_stream_(cop_stream_of(*pipeline_)),
      tap_(frames_, *pipeline_),
      acquisition_(*device_, clock, *this, config_->rate, config_->block_scans),
      statistics_(device_->describe().channels.size(), config_->rate.scans_in_ms(1000.0)),
      sensor_stream_(sensor_stream_of(*pipeline_, config_->sensor_channels.size())),
      sensor_watch_(config_->sensor_channels.size(), sensor_stream_ ? pipeline_->formats()[*sensor_stream_].rate.scans_in_ms(1000.0) : 1) {}

Rig::~Rig() { stop(); }

void Rig::start(core::Log log) {
  std::promise<std::vector<std::string>> ready;
  thread_ = std::jthread([this, &ready] {
    ready.set_value(core::configure_this_thread("acq-" + config_->name, config_->policy));
    acquisition_.run();
  });
  for (std::string& refused : ready.get_future().get()) {
    log.warning("rig '" + config_->name + "': " + refused);
    notices_.push_back(std::move(refused));
  }
}

void Rig::stop() noexcept {
  acquisition_.request_stop();
  if (thread_.joinable()) thread_.join();
}

bool Rig::has_room() noexcept {
  const std::uint64_t followed = followed_.load(std::memory_order_relaxed);
  const bool is_followed = followed == kNobodyFollows || frames_.end().frame - followed < frames_.capacity();
  return is_followed && !tap_.is_full();
}

void Rig::process(const core::Acquired& acquired, bool has_more) noexcept {
  const std::int64_t started_ns = clock_.now_ns();
  tap_.begin_take();
  pipeline_->process(acquired, frame_);
  frames_.write(frame_, pipeline_->events());
  note_travel();
  note_progress(acquired.block, clock_.now_ns() - started_ns);
  publish(has_more);
  if (acquired.gap_before.reason != core::GapReason::None) statistics_.reset();
  statistics_.add(acquired.block);
  if (sensor_stream_) sensor_watch_.add(frame_.streams[*sensor_stream_]);
}

/// A burst is published in one go, because each call of the publisher costs a system call for each subscriber.
void Rig::publish(bool has_more) noexcept {
  if (++unpublished_ < kFramesPerCall && has_more) return;
  unpublished_ = 0;
  if (publisher_ == nullptr || !publisher_->publish()) publish_bell_.ring();
}

std::string Rig::sensor_problems() {
  const AcquisitionReport& acquired = acquisition();
  if (!acquired.delivers() || !sensor_stream_) return {};
  std::vector<std::string> names;
  for (const std::size_t channel : config_->sensor_channels) names.push_back(device_->describe().channels[channel].name);
  std::string problems =
      session::sensor_problems(sensor_watch_.latest(), names, config_->model.force_plate ? kForcePlateAdvice : kSensorAdvice);
  const auto& beyond_ns = pipeline_report().beyond_travel_ns;
  if (problems.empty() && beyond_ns && clock_.now_ns() - *beyond_ns < kTravelShownNs) return std::string(kBeyondTravel);
  return problems;
}

std::optional<core::Rate> Rig::cop_rate() const noexcept {
  if (!cop_stream_) return std::nullopt;
  return pipeline_->formats()[*cop_stream_].rate;
}

RingFill Rig::ring_fill() noexcept {
  const std::int64_t now_ns = clock_.now_ns();
  const auto percent = [](std::size_t frames, std::size_t of) { return 100.0 * static_cast<double>(frames) / static_cast<double>(of); };
  return {.frames_percent = percent(published().frames_waiting.at(now_ns), frames_.capacity()),
          .record_percent = percent(tap_.recently_waiting(now_ns), frames_.capacity())};
}

/// The stage `cop` marks a value from deflections beyond the travel: it is less exact, but a number.
void Rig::note_travel() noexcept {
  if (!cop_stream_) return;
  const core::Block& cop = frame_.streams[*cop_stream_];
  const auto load_n = cop.column(kCopChannels - 1);
  const auto bits = cop.quality(kCopChannels - 1);
  for (std::size_t i = 0; i < cop.count(); ++i) {
    if ((bits[i] & core::quality::kOutOfRange) == 0 || !std::isfinite(load_n[i])) continue;
    pipeline_state_.beyond_travel_ns = clock_.now_ns();
    return;
  }
}

/// Call after all data of the block are in the ring: a reader of this report then finds everything before its position.
void Rig::note_progress(const core::Block& block, std::int64_t spent_ns) noexcept {
  if (block.count() == 0) return;
  constexpr double kWeight = 0.02;  // about the last 50 blocks
  const double us_per_scan = static_cast<double>(spent_ns) * 1e-3 / static_cast<double>(block.count());
  pipeline_state_.us_per_scan += kWeight * (us_per_scan - pipeline_state_.us_per_scan);
  pipeline_state_.end = frames_.end();
  pipeline_state_.next_scan = block.first_scan + block.count();
  pipeline_report_.store(pipeline_state_);
}

}  // namespace dts::session
