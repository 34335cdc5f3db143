// SPDX-License-Identifier: Apache-2.0
#include "device/nidaqmx/ni_daqmx.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "core/join.h"
#include "device/device_checks.h"

namespace dts::device::nidaqmx {
namespace {

using core::ErrorCode;
using core::GapReason;

constexpr std::int64_t kMillisecond = core::kNanosecondsPerMillisecond;
constexpr std::int64_t kSliceNs = 50 * kMillisecond;  // read() sees interrupt() within 100 ms
constexpr std::int64_t kFrameNs = kMillisecond;       // a USB frame; NI's library checks for data about as often
constexpr double kMinimumRateHz = 1.0;
constexpr double kMaximumRateHz = 100'000.0;  // limit of this program; the device rejects a rate that is too high for it
constexpr double kBufferMs = 4000.0;
constexpr double kRateStepHz = 1e-6;         // step of configured rates
constexpr double kRateToleranceHz = 1.1e-6;  // one step and the rounding of doubles

DeviceDescription describe_device(const NiOptions& options) {
  DeviceDescription description;
  description.uri = options.uri;
  description.model = "NI-DAQmx device";
  description.minimum_rate_hz = kMinimumRateHz;
  description.maximum_rate_hz = kMaximumRateHz;
  for (const std::size_t channel : options.channels) {
    description.channels.push_back({"ai" + std::to_string(channel), "V", ChannelRole::Sensor, -options.range_v, options.range_v, 0.0});
  }
  return description;
}

/// Rounds down to a rate that can be configured. NI rounds the clock's divisor down, so a rate slightly above the true rate would get
/// the next smaller divisor, and the device would run even faster.
double configurable(double hz) { return std::floor(hz / kRateStepHz) * kRateStepHz; }

std::string rate_text(double hz) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.6f", hz);
  return text.data();
}

}  // namespace

NiDaqmx::NiDaqmx(NiOptions options, core::Clock& clock)
    : options_(std::move(options)), clock_(clock), description_(describe_device(options_)) {}

NiDaqmx::~NiDaqmx() { NiDaqmx::close(); }

core::Result<core::Rate> NiDaqmx::exact_rate(core::Rate wanted) const { return check_rate(description_, wanted); }

DeviceReport NiDaqmx::report() const {
  DeviceReport report;
  {
    const std::lock_guard lock(report_mutex_);
    report = report_;
  }
  if (const std::int32_t error = read_error_.load(std::memory_order_acquire); error != 0) {  // pairs with note_error
    report.checks.push_back({"readings arrive", DeviceCheck::Outcome::Failed, "NI-DAQmx error " + std::to_string(error)});
  }
  return report;
}

core::Status NiDaqmx::failed(std::int32_t status, const std::string& call) const {
  return tl::make_unexpected(library_->error(status, options_.uri + ", " + call));
}

core::Status NiDaqmx::open() {
  if (state() == DeviceState::Gone) {
    return core::fail(ErrorCode::WrongState, "cannot open " + options_.uri + ": it is gone", "close it first");
  }
  if (state() != DeviceState::Closed) return {};
  if (!library_) {
    auto loaded = DaqmxLibrary::load(options_.library);
    if (!loaded) {
      core::Error error = loaded.error();
      error.what = "cannot open " + options_.uri + ": " + error.what;
      return tl::make_unexpected(error);
    }
    library_ = std::move(*loaded);
  }
  // This task only checks the name and the channels: otherwise `start` would find a mistake.
  const core::Status created = create_task();
  (void)clear_task();
  if (!created) return created;
  read_error_.store(0, std::memory_order_release);  // pairs with report()
  const std::lock_guard lock(report_mutex_);
  report_ = {.model = library_->model_of(options_.name),
             .serial = library_->serial_of(options_.name),
             .checks = {{"NI-DAQmx knows the device and its channels", DeviceCheck::Outcome::Passed, options_.library}}};
  move_to(DeviceState::Open);
  return {};
}

core::Status NiDaqmx::create_task() {
  if (const std::int32_t status = library_->create_task("", &task_); status < 0) {
    task_ = nullptr;
    return failed(status, "DAQmxCreateTask");
  }
  const std::string inputs =
      core::join(options_.channels, ", ", [this](std::size_t channel) { return options_.name + "/ai" + std::to_string(channel); });
  const std::int32_t status = library_->create_ai_voltage_chan(task_, inputs.c_str(), "", options_.terminal, -options_.range_v,
                                                               options_.range_v, api::kVolts, nullptr);
  return status < 0 ? failed(status, "DAQmxCreateAIVoltageChan") : core::Status{};
}

core::Result<core::Rate> NiDaqmx::start(const StartOptions& options) {
  const std::string what = "cannot start " + options_.uri;
  if (state() == DeviceState::Gone) return core::fail(ErrorCode::DeviceGone, what + ": it is gone");
  if (state() != DeviceState::Open) {
    const bool is_closed = state() == DeviceState::Closed;
    return core::fail(ErrorCode::WrongState, what + (is_closed ? ": it is not open" : ": it is streaming already"));
  }
  DTS_TRY(check_start(description_, options));

  max_block_scans_ = options.max_block_scans;
  values_.assign(max_block_scans_ * options_.channels.size(), 0.0);
  next_ = 0;
  host_time_ = core::HostTime(options.rate, kFrameNs);
  trouble_ = {ReadOutcome::Scans, {}};
  is_interrupted_.store(false, std::memory_order_relaxed);
  read_error_.store(0, std::memory_order_release);  // pairs with report()
  if (auto ready = set_up(options); !ready) {
    (void)clear_task();
    core::Error error = ready.error();
    if (error.code == ErrorCode::NotFound) error.code = ErrorCode::DeviceGone;  // the device existed when it was opened
    if (error.code == ErrorCode::DeviceGone) move_to(DeviceState::Gone);
    return tl::make_unexpected(error);
  }
  move_to(DeviceState::Streaming);
  return options.rate;
}

core::Status NiDaqmx::set_up(const StartOptions& options) {
  DTS_TRY(create_task());
  const std::uint64_t buffer_scans = std::max<std::uint64_t>(options.rate.scans_in_ms(kBufferMs), 8 * options.max_block_scans);
  std::int32_t status = library_->cfg_samp_clk_timing(task_, "", options.rate.hz(), api::kRising, api::kContinuous, buffer_scans);
  if (status < 0) return failed(status, "DAQmxCfgSampClkTiming");
  if (waits_for_trigger()) {
    const std::string source = "/" + options_.name + "/" + options_.trigger;
    status = library_->cfg_dig_edge_start_trig(task_, source.c_str(), api::kRising);
    if (status < 0) return failed(status, "DAQmxCfgDigEdgeStartTrig");
  }
  status = library_->cfg_input_buffer(task_, static_cast<std::uint32_t>(buffer_scans));
  if (status < 0) return failed(status, "DAQmxCfgInputBuffer");
  DTS_TRY(check_rate_of_task(options.rate));
  // With a trigger, scan 0 may be at any later time.
  host_time_.restart(waits_for_trigger() ? std::nullopt : std::optional(clock_.raw_ns()));
  status = library_->start_task(task_);
  return status < 0 ? failed(status, "DAQmxStartTask") : core::Status{};
}

core::Status NiDaqmx::check_rate_of_task(core::Rate promised) {
  double rate_hz = 0.0;
  const std::int32_t status = library_->get_samp_clk_rate(task_, &rate_hz);
  if (status < 0) return failed(status, "DAQmxGetSampClkRate");
  if (std::abs(rate_hz - promised.hz()) <= kRateToleranceHz) return {};
  return core::fail(ErrorCode::InvalidArgument,
                    "cannot start " + options_.uri + ": its clock cannot run at " + rate_text(promised.hz()) + " Hz; the nearest is " +
                        rate_text(rate_hz) + " Hz",
                    "configure rate_hz = " + rate_text(configurable(rate_hz)));
}

ReadResult NiDaqmx::read(core::Block& block, std::int64_t deadline_ns) noexcept {
  block.set_count(0);
  const DeviceState now = state();
  if (now == DeviceState::Gone) return {ReadOutcome::Gone, {GapReason::Unplugged, 0, false}};
  if (now != DeviceState::Streaming) return {};
  // A block of the wrong size is a mistake of the caller; it must not cause writes beyond a column.
  if (block.capacity() == 0 || block.channel_count() != options_.channels.size()) return {ReadOutcome::Timeout, {}};
  if (trouble_.outcome != ReadOutcome::Scans) return report_trouble();
  const std::size_t count = fetch(std::min(block.capacity(), max_block_scans_), deadline_ns);
  if (count > 0) {
    fill(block, count);
    return {ReadOutcome::Scans, {}};
  }
  if (trouble_.outcome != ReadOutcome::Scans) return report_trouble();
  return {waits_for_trigger() ? ReadOutcome::Armed : ReadOutcome::Timeout, {}};
}

/// Reads scans into `values_` and returns their number. If an error follows them, the next `read` returns it.
std::size_t NiDaqmx::fetch(std::size_t wanted, std::int64_t deadline_ns) noexcept {
  const std::size_t channels = options_.channels.size();
  std::size_t count = 0;
  while (true) {
    const std::int64_t now_ns = clock_.now_ns();
    const std::int64_t slice_ns = std::clamp<std::int64_t>(deadline_ns - now_ns, 0, kSliceNs);
    const std::span<double> room = std::span(values_).subspan(count * channels, (wanted - count) * channels);
    std::int32_t scans = 0;
    const std::int32_t status = library_->read_analog_f64(task_, static_cast<std::int32_t>(wanted - count),
                                                          static_cast<double>(slice_ns) / core::kNanosecondsPerSecond, api::kGroupByScan,
                                                          room.data(), static_cast<std::uint32_t>(room.size()), &scans, nullptr);
    if (scans < 0 || static_cast<std::size_t>(scans) > wanted - count) {  // the content of values_ is not reliable
      trouble_ = {ReadOutcome::Broken, {GapReason::Integrity, 0, false}};
      return 0;
    }
    count += static_cast<std::size_t>(scans);
    has_ever_scanned_ = has_ever_scanned_ || scans > 0;
    if (scans > 0) host_time_.add({next_ + count - 1}, clock_.raw_ns());
    if (status < 0 && status != api::kSamplesNotYetAvailable) note_error(status);
    const bool is_over =
        clock_.now_ns() >= deadline_ns || is_interrupted_.exchange(false, std::memory_order_acquire);  // pairs with interrupt
    if (count == wanted || is_over || trouble_.outcome != ReadOutcome::Scans) return count;
    // The library returned early without scans and without an error: avoid a busy loop.
    if (scans == 0 && status >= 0) clock_.sleep_until_ns(std::min(deadline_ns, now_ns + kMillisecond));
  }
}

void NiDaqmx::note_error(std::int32_t status) noexcept {
  read_error_.store(status, std::memory_order_release);  // pairs with report()
  if (is_gone(status)) {
    trouble_ = {ReadOutcome::Gone, {GapReason::Unplugged, 0, false}};
  } else {
    trouble_ = {ReadOutcome::Broken, {is_overrun(status) ? GapReason::Overrun : GapReason::Integrity, 0, false}};
  }
}

ReadResult NiDaqmx::report_trouble() noexcept {
  if (trouble_.outcome == ReadOutcome::Gone) move_to(DeviceState::Gone);
  return trouble_;
}

void NiDaqmx::fill(core::Block& block, std::size_t count) noexcept {
  const std::size_t channels = options_.channels.size();
  block.set_count(count);
  block.first_scan = {next_};
  block.host_time_ns = core::monotonic_of_raw_ns(clock_, host_time_.at({next_}));
  block.host_time_uncertainty_ns = host_time_.uncertainty_ns();
  block.clock_drift_ppm = host_time_.drift_ppm();
  for (std::size_t channel = 0; channel < channels; ++channel) {
    const std::span<double> column = block.column(channel);
    const std::span<std::uint8_t> quality = block.quality(channel);
    for (std::size_t i = 0; i < count; ++i) {
      const double value_v = values_[i * channels + channel];
      const bool is_number = std::isfinite(value_v);
      column[i] = is_number ? value_v : std::numeric_limits<double>::quiet_NaN();
      quality[i] = !is_number ? core::quality::kOutOfRange : std::abs(value_v) >= options_.range_v ? core::quality::kRail : std::uint8_t{0};
    }
  }
  next_ += count;
}

void NiDaqmx::interrupt() noexcept { is_interrupted_.store(true, std::memory_order_release); }  // pairs with fetch

core::Status NiDaqmx::set_sync_output(bool) { return refuse_sync_output(description_, state()); }

core::Status NiDaqmx::clear_task() {
  if (task_ == nullptr) return {};
  library_->stop_task(task_);  // its status is ignored: it repeats the error that ended the scan
  const std::int32_t status = library_->clear_task(std::exchange(task_, nullptr));
  return status < 0 ? failed(status, "DAQmxClearTask") : core::Status{};
}

core::Status NiDaqmx::stop() {
  if (state() != DeviceState::Streaming) return {};
  const core::Status cleared = clear_task();
  move_to(DeviceState::Open);
  return cleared;
}

core::Status NiDaqmx::close() {
  const bool was_gone = state() == DeviceState::Gone;
  const core::Status cleared = clear_task();
  move_to(DeviceState::Closed);
  return was_gone ? core::Status{} : cleared;
}

}  // namespace dts::device::nidaqmx
