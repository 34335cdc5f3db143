// SPDX-License-Identifier: Apache-2.0
#include "device/board/board_device.h"

#include <algorithm>
#include <utility>

#include "core/number_text.h"
#include "core/utf8.h"
#include "device/device_checks.h"

namespace dts::device::board {
namespace {

using core::ErrorCode;

constexpr std::uint64_t kLeastHeardBytes = 8;                           // fewer bytes are noise of a plug
constexpr std::int64_t kFirstLineNs = 5 * core::kNanosecondsPerSecond;  // opening may reset the board

DeviceCheck describe_end(std::optional<std::uint64_t> undelivered) {
  constexpr char kName[] = "scans between the last delivered one and the stop";
  if (!undelivered) return {kName, DeviceCheck::Outcome::Skipped, "the board did not say where it stopped"};
  return {kName, DeviceCheck::Outcome::Passed, std::to_string(*undelivered) + " scans were not delivered"};
}

}  // namespace

BoardDevice::BoardDevice(BoardOptions options, std::unique_ptr<bytes::ByteLink> link, core::Clock& clock)
    : options_(std::move(options)), link_(std::move(link)), clock_(clock) {}

BoardDevice::~BoardDevice() { BoardDevice::close(); }

core::Result<core::Rate> BoardDevice::exact_rate(core::Rate wanted) const { return check_rate(options_.description, wanted); }

DeviceReport BoardDevice::report() const {
  const std::lock_guard lock(report_mutex_);
  DeviceReport report = report_;
  const std::vector<DeviceCheck> findings = delivery_ ? delivery_->findings() : scan_checks_;
  const bool is_told = std::ranges::any_of(findings, [](const DeviceCheck& check) { return check.name == kBreakOffCheck; });
  if (!is_told && !why_broken_before_.empty()) {
    report.checks.push_back({kBreakOffCheck, DeviceCheck::Outcome::Warning, "an earlier scan did: " + why_broken_before_});
  }
  report.checks.insert(report.checks.end(), findings.begin(), findings.end());
  add_log(report.checks);
  return report;
}

core::Status BoardDevice::open() {
  if (state() == DeviceState::Gone) {
    return core::fail(ErrorCode::WrongState, "cannot open " + describe().uri + ": it is gone", "close it first");
  }
  if (state() != DeviceState::Closed) return {};
  DTS_TRY(link_->open());
  if (const core::Status met = options_.speaks_lines ? meet_lines() : meet(); !met) {
    link_->close();
    conversation_.reset();
    lines_.reset();
    return met;
  }
  note_unit();
  {
    const std::lock_guard lock(report_mutex_);
    scan_checks_.clear();
    why_broken_before_.clear();
  }
  move_to(DeviceState::Open);
  return {};
}

core::Status BoardDevice::meet() {
  conversation_ = std::make_unique<Conversation>(*link_, options_, clock_);
  return conversation_->meet();
}

/// Waits for the first good line.
core::Status BoardDevice::meet_lines() {
  const std::string what = "cannot open " + describe().uri;
  if (const std::string serial = link_->facts().serial; !options_.serial.empty() && serial != options_.serial) {
    return core::fail(ErrorCode::NotFound,
                      what + ": the serial number of its USB adapter is " + (serial.empty() ? "unknown" : serial) +
                          ", the address says serial=" + options_.serial,
                      "plug in the right board, or correct serial");
  }
  const LineShape& shape = options_.lines;
  lines_ = std::make_unique<LineInput>(*link_, clock_, LineDecoder(shape.channels, shape.first_column, shape.counter_bits));
  const auto period_ns = static_cast<std::int64_t>(1e9 / describe().minimum_rate_hz);
  const std::int64_t until_ns = clock_.now_ns() + kFirstLineNs + 3 * period_ns;
  while (clock_.now_ns() < until_ns) {
    const LineInput::Next next = lines_->next(until_ns);
    if (next.end == bytes::ReadEnd::Bytes && next.piece.is_good) return {};
    if (next.end != bytes::ReadEnd::Lost) continue;
    const std::string why = link_->why_lost();
    return core::fail(ErrorCode::DeviceGone, what + ": it is gone" + (why.empty() ? "" : ": " + why));
  }
  if (lines_->byte_count() == 0) {
    return core::fail(ErrorCode::Timeout, what + ": the board sends nothing", "check its program, cable and power; reset it");
  }
  const std::size_t columns = lines_->decoder().wrong_columns();
  if (columns == 0) {
    return core::fail(ErrorCode::DataDamaged, what + ": what arrives are no lines of numbers",
                      "check baud, counter and time_us; a board that sends frames needs format=frames");
  }
  const std::size_t wanted = shape.channels + (shape.first_column == FirstColumn::Value ? 0 : 1);
  return core::fail(ErrorCode::InvalidArgument,
                    what + ": the board's lines have " + std::to_string(columns) + " columns, the address says " + std::to_string(wanted),
                    "correct channels, counter or time_us");
}

/// Fills the report on the opened unit.
void BoardDevice::note_unit() {
  bytes::ByteLink::Facts facts = link_->facts();
  DeviceReport found{.model = {}, .serial = facts.serial, .nodes = std::move(facts.nodes), .firmware = {}, .checks = {}};
  if (conversation_) {
    const Descriptor& board = conversation_->facts().descriptor();
    found.model = board.model.view();
    if (!board.serial.view().empty()) found.serial = board.serial.view();
    found.firmware = board.firmware.view();
    std::string detail = std::string(board.model.view()) + ", " + std::to_string(board.converter_bits) + " bits";
    for (const Channel& channel : conversation_->facts().channels()) {
      detail += ", " + core::printable(channel.name.view());
      const std::string& unit = describe().channels[channel.index].unit;
      if (channel.is_digital && channel.unit.view() != unit) detail += " (digital, so its unit is not " + unit + ")";
    }
    found.checks.push_back({"the board describes itself as the address says", DeviceCheck::Outcome::Passed, std::move(detail)});
    if (const double hz = conversation_->measured_hz(); hz > 0.0) {
      found.checks.push_back({"the board's rate was measured", DeviceCheck::Outcome::Passed, core::number_text(hz) + " Hz"});
    }
  }
  if (found.serial.empty()) found.serial = describe().serial;
  const std::lock_guard lock(report_mutex_);
  report_ = std::move(found);
}

core::Result<core::Rate> BoardDevice::start(const StartOptions& options) {
  const std::string what = "cannot start " + describe().uri;
  if (state() == DeviceState::Gone) return core::fail(ErrorCode::DeviceGone, what + ": it is gone");
  if (state() != DeviceState::Open) {
    const bool is_closed = state() == DeviceState::Closed;
    return core::fail(ErrorCode::WrongState, what + (is_closed ? ": it is not open" : ": it is streaming already"));
  }
  DTS_TRY(check_start(describe(), options));
  is_interrupted_.store(false, std::memory_order_relaxed);
  if (const core::Status begun = begin(options); !begun) {
    if (begun.error().code == ErrorCode::DeviceGone) move_to(DeviceState::Gone);
    return tl::make_unexpected(begun.error());
  }
  move_to(DeviceState::Streaming);
  return options.rate;
}

core::Status BoardDevice::begin(const StartOptions& options) {
  const std::int64_t asked_ns = clock_.raw_ns();
  std::unique_ptr<ScanSource> source;
  std::optional<std::int64_t> not_before_ns;
  std::uint32_t ticks_per_second = 0;
  FrameSource* frames = nullptr;
  if (conversation_) {
    const auto started = conversation_->start(options.rate);
    if (conversation_->facts().is_agreed()) note_unit();  // it may be another board that agrees with the address too
    DTS_TRY_ASSIGN(const RunStart run, started);
    const Descriptor& board = conversation_->facts().descriptor();
    if (run.is_commanded) not_before_ns = asked_ns;
    if (board.carries_time) ticks_per_second = board.ticks_per_second;
    auto made = std::make_unique<FrameSource>(*link_, conversation_->input(), conversation_->facts(), timeline_, clock_, run,
                                              options.max_block_scans);
    frames = made.get();
    source = std::move(made);
  } else {
    if (!lines_->drain()) return core::fail(ErrorCode::DeviceGone, "cannot start " + describe().uri + ": it is gone");
    if (options_.lines.first_column == FirstColumn::TimeUs) ticks_per_second = 1'000'000;
    source = std::make_unique<LineSource>(*lines_, timeline_, clock_, options_.lines, options.max_block_scans);
  }
  const std::string& serial = report_.serial;
  const bool is_same_board = !serial.empty() && serial == timed_serial_;
  timeline_.start(options.rate, ticks_per_second, is_same_board, not_before_ns);
  timed_serial_ = serial;
  auto delivery = std::make_unique<ScanDelivery>(*source, clock_, is_interrupted_, options.max_block_scans);
  const std::lock_guard lock(report_mutex_);
  scan_checks_.clear();
  source_ = std::move(source);
  frames_ = frames;
  delivery_ = std::move(delivery);
  heard_at_scan_ = heard();
  return {};
}

ReadResult BoardDevice::read(core::Block& block, std::int64_t deadline_ns) noexcept {
  block.set_count(0);
  if (state() == DeviceState::Gone) return {ReadOutcome::Gone, {core::GapReason::Unplugged, 0, false}};
  if (state() != DeviceState::Streaming) return {};
  const ReadResult result = delivery_->read(block, deadline_ns);
  if (result.outcome == ReadOutcome::Scans) heard_at_scan_ = heard();
  if (result.outcome == ReadOutcome::Gone) move_to(DeviceState::Gone);
  return result;
}

std::string BoardDevice::why_gone() const {
  if (state() != DeviceState::Gone) return {};
  if (std::string why = link_->why_lost(); !why.empty()) return why;
  return what_came_instead();
}

BoardDevice::Heard BoardDevice::heard() const noexcept {
  if (conversation_) return {conversation_->input().byte_count(), source_->counts()};
  return {lines_->byte_count(), source_->counts()};
}

/// Returns what arrived since the newest scan of a board that sends no scans any more.
std::string BoardDevice::what_came_instead() const {
  if (!source_) return {};
  const Heard now = heard();
  const std::uint64_t bytes = now.bytes - heard_at_scan_.bytes;
  const bool is_good = now.pieces.good != heard_at_scan_.pieces.good;
  if (bytes < kLeastHeardBytes) return "the board is silent: it sends nothing; check its program, cable and power";
  if (conversation_) {
    if (is_good) return "the board sends frames, but no scans that fit its description; reset it, and check its program";
    return "what arrives are no frames (" + std::to_string(bytes) + " bytes); check baud and the cable";
  }
  if (is_good) return "the board sends lines, but their first column does not fit; check counter, time_us and the board's program";
  if (now.pieces.rejected != heard_at_scan_.pieces.rejected) {
    return "the board's lines have " + std::to_string(lines_->decoder().wrong_columns()) + " columns, not those of the address; " +
           "correct channels, counter or time_us";
  }
  return "what arrives are no lines of numbers (" + std::to_string(bytes) + " bytes); check baud and the cable";
}

void BoardDevice::interrupt() noexcept {
  is_interrupted_.store(true, std::memory_order_release);  // pairs with ScanDelivery::read
  link_->interrupt();
}

core::Status BoardDevice::set_sync_output(bool) { return refuse_sync_output(describe(), state()); }

/// Adds the newest message of a board that speaks frames, if there was one. Needs `report_mutex_`.
void BoardDevice::add_log(std::vector<DeviceCheck>& checks) const {
  if (frames_ == nullptr) return;
  const std::string log = core::printable(frames_->last_log().view());
  if (!log.empty()) checks.push_back({"the board's newest message", DeviceCheck::Outcome::Passed, log});
}

/// Destroys the source and keeps its findings. `undelivered`: number of scans between the last delivered one and the stop.
void BoardDevice::keep_findings(std::optional<std::uint64_t> undelivered) {
  const std::lock_guard lock(report_mutex_);
  if (!delivery_) return;
  if (const char* const why = source_->why_broken()) why_broken_before_ = why;
  scan_checks_ = delivery_->findings();
  add_log(scan_checks_);
  if (frames_ != nullptr) scan_checks_.push_back(describe_end(undelivered));
  delivery_.reset();
  source_.reset();
  frames_ = nullptr;
}

core::Status BoardDevice::end_scan() {
  if (!delivery_) return {};
  std::optional<std::uint64_t> undelivered;
  core::Status ended;
  if (frames_ != nullptr) {
    const std::size_t waiting = delivery_->waiting();
    const auto behind = conversation_->stop(*frames_);
    const std::uint64_t unreported = frames_->trouble().outcome == ReadOutcome::Gap ? frames_->trouble().gap.missing_scans : 0;
    if (behind && *behind) undelivered = waiting + unreported + **behind;
    if (!behind) ended = tl::make_unexpected(behind.error());
  }
  keep_findings(undelivered);
  return ended;
}

core::Status BoardDevice::stop() {
  if (state() != DeviceState::Streaming) return {};
  core::Status ended = end_scan();
  const bool is_gone = !ended && ended.error().code == ErrorCode::DeviceGone;
  move_to(is_gone ? DeviceState::Gone : DeviceState::Open);
  return is_gone ? core::Status{} : ended;  // an unplugged board does not scan
}

core::Status BoardDevice::close() {
  core::Status ended = stop();
  keep_findings(std::nullopt);  // the board is gone: nobody stopped the scan
  link_->close();
  conversation_.reset();
  lines_.reset();
  {
    const std::lock_guard lock(report_mutex_);
    report_.nodes.clear();  // another board may get them
  }
  move_to(DeviceState::Closed);
  return ended;
}

}  // namespace dts::device::board
