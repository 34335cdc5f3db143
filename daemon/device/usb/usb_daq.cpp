// SPDX-License-Identifier: Apache-2.0
#include "device/usb/usb_daq.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <span>
#include <string>
#include <thread>
#include <utility>

#include "device/device_checks.h"

namespace dts::device::usb {
namespace {

using core::ErrorCode;

constexpr std::int64_t kLongestLatencyNs = 25 * core::kNanosecondsPerMillisecond;
constexpr int kCancelPatienceMs = 150;  // plus the request that ends the scan: below the 250 ms limit of `stop`
constexpr std::int64_t kFullSpeedFrameNs = 1'000'000;
constexpr std::int64_t kHighSpeedFrameNs = 125'000;
constexpr int kBusyPatienceMs = 100;

/// Returns "1.02" for 0x0102.
std::string release_text(std::uint16_t bcd) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%x.%02x", static_cast<unsigned>(bcd >> 8U), static_cast<unsigned>(bcd & 0xFFU));
  return text.data();
}

std::string serial_text(const UsbUnit& unit) { return unit.serial.empty() ? "(serial number not readable)" : unit.serial; }

/// Returns "plugged in: USB-1608FS-Plus 01AB: write mcc:1608fs-plus?serial=01AB".
std::string list_of(std::span<const UsbUnit> units, std::span<const UsbModel> models) {
  std::string text;
  for (const UsbUnit& unit : units) {
    const auto model = std::find_if(models.begin(), models.end(), [&unit](const UsbModel& candidate) {
      return candidate.vendor == unit.vendor && candidate.product == unit.product;
    });
    text += text.empty() ? "plugged in: " : "; ";
    text += model == models.end() ? "unit " : std::string(model->name) + " ";
    text += serial_text(unit);
    if (model != models.end() && !unit.serial.empty()) text += ": write " + std::string(model->uri) + "?serial=" + unit.serial;
  }
  return text;
}

const char* reason_text(core::GapReason reason) {
  switch (reason) {
    case core::GapReason::Overrun: return "overrun: the device sent data faster than dtsd read them";
    case core::GapReason::Silence: return "silence: the device stopped sending";
    case core::GapReason::Stall: return "stall: the device halted its data endpoint";
    case core::GapReason::Integrity: return "integrity: the data failed a check";
    default: return "unknown";
  }
}

/// Returns the error of a failed start, extended by the error of the stop after it.
core::Error with(core::Error error, const core::Status& ended) {
  if (ended) return error;
  error.what += "; and then: " + ended.error().what;
  if (!ended.error().hint.empty()) error.hint = ended.error().hint;
  return error;
}

tl::unexpected<core::Error> pass_on(const core::Error& error) { return tl::make_unexpected(error); }

}  // namespace

UsbDaq::UsbDaq(std::unique_ptr<DaqDriver> driver, DaqOptions options, UsbBus& bus, core::Clock& clock)
    : driver_(std::move(driver)), options_(std::move(options)), bus_(bus), clock_(clock), seen_arrivals_(bus.arrivals()) {}

UsbDaq::~UsbDaq() {
  UsbDaq::close();
  free_abandoned();
  for (Abandoned& left : abandoned_) {  // never freed: the host controller may still write into them
    (void)left.stream.release();
    (void)left.port.release();
  }
}

DeviceReport UsbDaq::report() const {
  const std::lock_guard lock(report_mutex_);
  DeviceReport report = report_;
  if (port_) report.nodes.push_back(port_->unit().node());
  if (!report.checks.empty()) report.checks.push_back(describe_transfer_errors());
  report.checks.insert(report.checks.end(), break_checks_.begin(), break_checks_.end());
  report.checks.insert(report.checks.end(), scan_checks_.begin(), scan_checks_.end());
  if (!reader_) return report;
  const std::vector<DeviceCheck> findings = reader_->findings();
  report.checks.insert(report.checks.end(), findings.begin(), findings.end());
  return report;
}

/// Reports failed transfers, but not NoDevice: an unplugged device counts as a reconnection.
DeviceCheck UsbDaq::describe_transfer_errors() const {
  std::string found;
  for (std::size_t status = 0; status < kUsbStatuses; ++status) {
    const std::uint64_t count = transfer_errors_[status].load(std::memory_order_relaxed);  // only for the report
    if (count == 0 || static_cast<UsbStatus>(status) == UsbStatus::NoDevice) continue;
    found += (found.empty() ? "" : "; ") + std::to_string(count) + " x " + to_string(static_cast<UsbStatus>(status));
  }
  const bool has_none = found.empty();
  return {.name = "USB transfers since dtsd started",
          .outcome = has_none ? DeviceCheck::Outcome::Passed : DeviceCheck::Outcome::Warning,
          .detail = has_none ? "no errors" : std::move(found)};
}

bool UsbDaq::has_arrived() noexcept {
  const std::uint64_t arrivals = bus_.arrivals();
  return std::exchange(seen_arrivals_, arrivals) != arrivals;
}

/// Returns the unit with the serial number. If no unit shows this number, returns the units without a number in their USB descriptors:
/// `open_unit` asks each of them.
core::Result<std::vector<UsbUnit>> UsbDaq::candidates() {
  const std::string what = "cannot open " + describe().uri;
  DTS_TRY_ASSIGN(auto found, bus_.units(driver_->models()));
  std::vector<UsbUnit> wanted = found;
  if (!options_.serial.empty()) {
    const auto has_it = [this](const UsbUnit& unit) { return unit.serial == options_.serial; };
    const bool is_there = std::any_of(wanted.begin(), wanted.end(), has_it);
    std::erase_if(wanted, [&](const UsbUnit& unit) { return is_there ? !has_it(unit) : !unit.serial.empty(); });
  }
  if (wanted.empty()) {
    const std::string which = options_.serial.empty() ? "no such device" : "no unit with serial number " + options_.serial;
    return core::fail(ErrorCode::NotFound, what + ": " + which + " is plugged in",
                      found.empty() ? what_is_there_instead() : list_of(found, driver_->models()));
  }
  if (wanted.size() == 1 || !options_.serial.empty()) return wanted;
  return core::fail(ErrorCode::InvalidArgument, what + ": " + std::to_string(wanted.size()) + " units match",
                    "choose one by its serial number; " + list_of(wanted, driver_->models()));
}

std::string UsbDaq::what_is_there_instead() {
  const std::vector<UsbModel> relatives = driver_->relatives();
  const auto others = bus_.units(relatives);
  if (!others || others->empty()) return "check its cable and power; dtsd opens it as soon as it is plugged in";
  return list_of(*others, relatives);
}

core::Status UsbDaq::open() {
  free_abandoned();
  if (state() == DeviceState::Gone) {
    return core::fail(ErrorCode::WrongState, "cannot open " + describe().uri + ": it is gone", "close it first");
  }
  if (state() != DeviceState::Closed) return {};
  const auto units = candidates();
  if (!units) return pass_on(units.error());
  core::Status result;
  for (const UsbUnit& unit : *units) {
    const core::Status opened = open_unit(unit);
    if (opened) return opened;
    // A unit that could not be opened may be the right unit: its error is more useful than NotFound.
    if (result || result.error().code == ErrorCode::NotFound) result = opened;
  }
  return result;
}

core::Status UsbDaq::open_unit(const UsbUnit& unit) {
  if (is_abandoned(unit)) {
    return core::fail(ErrorCode::WrongState, "cannot open " + describe().uri + ": transfers of the last scan have not ended yet",
                      "wait a moment; if that does not help, unplug it and plug it in again");
  }
  auto port = bus_.open(unit);
  if (!port) return pass_on(port.error());
  std::vector<DeviceCheck> checks;
  DTS_TRY(driver_->connect(**port, checks));  // the port closes itself
  UnitIdentity who = driver_->identity();
  if (!unit.serial.empty()) who.serial = unit.serial;
  if (who.firmware.empty()) who.firmware = release_text(unit.release_bcd);
  if (!options_.serial.empty() && who.serial != options_.serial) {
    return core::fail(ErrorCode::NotFound,
                      "cannot open " + describe().uri + ": no unit with serial number " + options_.serial + " is plugged in",
                      who.serial.empty() ? "" : "plugged in: a unit with serial number " + who.serial);
  }

  const std::scoped_lock lock(request_mutex_, report_mutex_);
  port_ = std::move(*port);
  const bool is_same_unit = !who.serial.empty() && who.serial == report_.serial;
  if (!is_same_unit) host_time_rate_.reset();  // another unit has another crystal
  report_ = {.serial = std::move(who.serial), .firmware = std::move(who.firmware), .checks = std::move(checks)};
  scan_checks_.clear();
  break_checks_.clear();
  must_use_large_packets_ = false;
  move_to(DeviceState::Open);
  return {};
}

core::Result<core::Rate> UsbDaq::start(const StartOptions& options) {
  const std::string what = "cannot start " + describe().uri;
  if (state() == DeviceState::Gone) return core::fail(ErrorCode::DeviceGone, what + ": it is gone");
  if (state() != DeviceState::Open) {
    const bool is_closed = state() == DeviceState::Closed;
    return core::fail(ErrorCode::WrongState, what + (is_closed ? ": it is not open" : ": it is streaming already"));
  }
  if (auto checked = check_start(describe(), options); !checked) return pass_on(checked.error());
  const auto rate = exact_rate(options.rate);
  if (!rate) return pass_on(rate.error());

  const std::lock_guard lock(request_mutex_);
  is_interrupted_.store(false, std::memory_order_relaxed);
  auto started = bring_up(options, *rate);
  if (started) {
    move_to(DeviceState::Streaming);
    return started;
  }
  core::Status ended;
  if (stream_) ended = end_scan();
  const bool is_gone = started.error().code == ErrorCode::DeviceGone;
  if (!port_ || is_gone) move_to(DeviceState::Gone);
  if (is_gone) return started;
  return tl::make_unexpected(with(started.error(), ended));
}

core::Result<core::Rate> UsbDaq::bring_up(const StartOptions& options, core::Rate rate) {
  {
    const std::lock_guard lock(report_mutex_);
    scan_checks_.clear();
  }
  const std::int64_t latency_ns = std::min(rate.time_ns({options.max_block_scans}), kLongestLatencyNs);
  auto plan = driver_->configure(*port_, {rate, latency_ns, must_use_large_packets_, has_ever_scanned_});
  if (!plan) return pass_on(plan.error());
  add_check({"scan is configured", DeviceCheck::Outcome::Passed, plan->sentence});
  auto single_v = read_single();
  if (!single_v) return pass_on(single_v.error());
  if (auto ready = driver_->make_ready(*port_); !ready) return pass_on(ready.error());
  auto stream = BulkStream::create(*port_, plan->shape, clock_);
  if (!stream) return pass_on(stream.error());
  stream_ = std::move(*stream);
  if (auto launched = launch(plan->shape, rate); !launched) return pass_on(launched.error());

  const ScanReader::Tools tools{*driver_, *port_, *stream_, clock_, host_time_, request_mutex_, is_interrupted_, transfer_errors_};
  auto reader = std::make_unique<ScanReader>(
      tools, ScanSetup{rate, options.max_block_scans, plan->shape, plan->packet_period_ns, options_.marker, std::move(*single_v)});
  const std::lock_guard lock(report_mutex_);
  reader_ = std::move(reader);
  return rate;
}

/// Returns single readings; empty if the device has no such command, or if they would be too old at the first scan.
core::Result<std::vector<double>> UsbDaq::read_single() {
  constexpr char kCheck[] = "single readings agree with the scan";
  if (driver_->may_start_late()) {
    add_check({kCheck, DeviceCheck::Outcome::Skipped, "the scan waits for a trigger"});
    return std::vector<double>{};
  }
  auto single_v = driver_->read_once(*port_);
  if (single_v && single_v->size() == describe().channels.size()) return single_v;
  if (single_v) return core::fail(ErrorCode::Internal, describe().uri + ": a single reading of the wrong length");
  if (single_v.error().code != ErrorCode::Unsupported) return single_v;
  add_check({kCheck, DeviceCheck::Outcome::Skipped, "this device has no single readings"});
  return std::vector<double>{};
}

/// Submits the transfers before it starts the scan, because the device's buffer is small.
core::Status UsbDaq::launch(const StreamShape& shape, core::Rate rate) {
  const std::string what = "cannot start " + describe().uri;
  if (const UsbStatus submitted = stream_->start(); submitted != UsbStatus::Completed) {
    return tl::make_unexpected(to_error(submitted, what + ": " + std::to_string(shape.transfer_count) + " transfers"));
  }
  prepare_host_time(rate);
  DTS_TRY(driver_->begin(*port_));
  if (driver_->waits_for_trigger()) return {};
  const auto health = driver_->health(*port_);
  if (!health) return pass_on(health.error());
  if (health->is_running || health->is_overrun) return {};  // the reader reports an overrun; the next start then uses large packets
  return core::fail(ErrorCode::Failed, what + ": the device accepted the command but does not scan", "unplug it and plug it in again");
}

/// Called right before the start request: no scan is older than now. With a trigger the start time is unknown.
void UsbDaq::prepare_host_time(core::Rate rate) {
  if (host_time_rate_ != rate) host_time_ = core::HostTime(rate, port_->is_high_speed() ? kHighSpeedFrameNs : kFullSpeedFrameNs);
  host_time_rate_ = rate;
  host_time_.restart(driver_->waits_for_trigger() ? std::nullopt : std::optional(clock_.raw_ns()));
}

ReadResult UsbDaq::read(core::Block& block, std::int64_t deadline_ns) noexcept {
  block.set_count(0);
  if (state() == DeviceState::Gone) return {ReadOutcome::Gone, {core::GapReason::Unplugged, 0, false}};
  if (state() != DeviceState::Streaming) return {};
  const ReadResult result = reader_->read(block, deadline_ns);
  if (result.outcome == ReadOutcome::Gone) move_to(DeviceState::Gone);
  return result;
}

void UsbDaq::interrupt() noexcept { is_interrupted_.store(true, std::memory_order_release); }  // pairs with ScanReader::read

core::Status UsbDaq::set_sync_output(bool is_high) {
  // A start may last seconds; this call must not. Tries in steps and not with `try_lock_for`: thread sanitizers do not support it.
  std::unique_lock lock(request_mutex_, std::defer_lock);
  for (int waited_ms = 0; !lock.try_lock(); ++waited_ms) {
    if (waited_ms >= kBusyPatienceMs) {
      return core::fail(ErrorCode::WrongState, "cannot set the sync output of " + describe().uri + ": the device is busy starting",
                        "try again");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  if (state() == DeviceState::Gone) return core::fail(ErrorCode::DeviceGone, describe().uri + " is gone");
  if (state() == DeviceState::Closed) return core::fail(ErrorCode::WrongState, describe().uri + " is not open");
  return driver_->set_sync_output(*port_, is_high);
}

core::Status UsbDaq::stop() {
  if (state() != DeviceState::Streaming) return {};
  const std::lock_guard lock(request_mutex_);
  const core::Status ended = end_scan();
  move_to(port_ ? DeviceState::Open : DeviceState::Gone);
  return ended;
}

core::Status UsbDaq::end_scan() noexcept {
  core::Status stopped = driver_->end(*port_);
  if (!stopped && stopped.error().code == ErrorCode::DeviceGone) stopped = {};  // an unplugged device does not scan
  core::Status ended = end_stream();
  return ended ? stopped : ended;
}

core::Status UsbDaq::confirm_stopped() {
  const std::lock_guard lock(request_mutex_);
  if (state() != DeviceState::Open) return core::fail(ErrorCode::WrongState, describe().uri + " is not open, or it is streaming");
  return driver_->end(*port_);
}

void UsbDaq::add_check(DeviceCheck check) {
  const std::lock_guard lock(report_mutex_);
  scan_checks_.push_back(std::move(check));
}

/// Destroys the reader and keeps its findings.
void UsbDaq::keep_findings() {
  must_use_large_packets_ = must_use_large_packets_ || reader_->has_overrun();
  has_ever_scanned_ = has_ever_scanned_ || reader_->has_scanned();
  const std::vector<DeviceCheck> findings = reader_->findings();
  const std::lock_guard lock(report_mutex_);
  scan_checks_.insert(scan_checks_.end(), findings.begin(), findings.end());
  if (const auto reason = reader_->break_reason()) {
    break_checks_ = scan_checks_;
    break_checks_.push_back({"the stream is whole", DeviceCheck::Outcome::Failed, reason_text(*reason)});
    for (DeviceCheck& check : break_checks_) check.name = "last break: " + check.name;
  }
  reader_.reset();
}

/// Ends the transfers and frees them. If some do not end in time, the host controller may still write into them and call the
/// stream. Then stream and port are moved to `abandoned_` until the transfers end; until then the unit cannot be opened.
core::Status UsbDaq::end_stream() noexcept {
  if (reader_) keep_findings();
  if (!stream_) return {};
  if (stream_->stop(kCancelPatienceMs)) {
    stream_.reset();
    return {};
  }
  const std::string detail = std::to_string(stream_->in_flight()) + " transfers did not end; dtsd keeps their memory";
  add_check({"transfers end when they are cancelled", DeviceCheck::Outcome::Failed, detail});
  {
    const std::lock_guard lock(report_mutex_);
    abandoned_.push_back({std::move(port_), std::move(stream_)});
  }
  return core::fail(ErrorCode::Failed, "cannot end the scan of " + describe().uri + ": " + detail, "unplug it and plug it in again");
}

bool UsbDaq::is_abandoned(const UsbUnit& unit) const {
  return std::any_of(abandoned_.begin(), abandoned_.end(), [&](const Abandoned& left) { return left.port->unit().node() == unit.node(); });
}

/// Frees abandoned streams whose transfers have ended since (the machine was only busy for a moment); the unit can be opened again.
void UsbDaq::free_abandoned() noexcept {
  std::erase_if(abandoned_, [](Abandoned& left) {
    if (!left.stream->stop(0)) return false;
    left.stream.reset();  // must be destroyed before its port
    return true;
  });
}

core::Status UsbDaq::close() {
  const std::lock_guard lock(request_mutex_);
  core::Status ended;
  if (state() == DeviceState::Streaming) {
    ended = end_scan();
  } else {
    ended = end_stream();  // the device is gone, or there is no stream
  }
  std::unique_ptr<UsbPort> port;
  {
    const std::lock_guard report_lock(report_mutex_);
    port = std::move(port_);
    break_checks_.clear();
  }
  port.reset();  // slow: outside `report_mutex_`
  move_to(DeviceState::Closed);
  return ended;
}

}  // namespace dts::device::usb
