// SPDX-License-Identifier: Apache-2.0
#include "device/board/conversation.h"

#include <algorithm>
#include <cmath>

#include "core/number_text.h"

namespace dts::device::board {
namespace {

using core::ErrorCode;
using core::number_text;

constexpr std::int64_t kMillisecond = core::kNanosecondsPerMillisecond;
constexpr std::int64_t kLearnNs = 6000 * kMillisecond;  // a board that does not receive describes itself every 5 s
constexpr std::int64_t kAnswerNs = 500 * kMillisecond;
constexpr int kAttempts = 4;
constexpr int kStarts = 2;
constexpr std::int64_t kCatchUpNs = 1000 * kMillisecond;
constexpr std::int64_t kStopNs = 200 * kMillisecond;  // below the 250 ms of Device::stop
constexpr std::int64_t kMeasureNs = 2000 * kMillisecond;
constexpr std::int64_t kLongestMeasureNs = 10'000 * kMillisecond;
constexpr std::uint32_t kLeastMeasuredScans = 10;
constexpr std::uint64_t kLeastGarbage = 8;      // a board sends one 0x00 after its reset
constexpr double kRateToleranceHz = 5e-6;       // a wanted rate is a multiple of 1e-6 Hz, and 32 bits hold 20 kHz that exactly
constexpr double kLargestMeasuredError = 0.01;  // as the largest error of a rate while scans flow

/// Returns the rate with terms of 32 bits that is nearest to `rate`.
WireRate wire_rate(core::Rate rate) noexcept {
  constexpr std::int64_t kMost = 0xFFFFFFFF;
  if (rate.numerator() <= kMost && rate.denominator() <= kMost) {
    return {static_cast<std::uint32_t>(rate.numerator()), static_cast<std::uint32_t>(rate.denominator())};
  }
  const double denominator = std::floor(static_cast<double>(kMost) / std::max(1.0, rate.hz()));
  return {static_cast<std::uint32_t>(std::llround(rate.hz() * denominator)), static_cast<std::uint32_t>(denominator)};
}

}  // namespace

Conversation::Conversation(bytes::ByteLink& link, const BoardOptions& options, core::Clock& clock)
    : link_(link), options_(options), clock_(clock), input_(link, clock) {}

core::Result<bool> Conversation::listen(std::int64_t deadline_ns) {
  const FrameInput::Next next = input_.next(deadline_ns);
  if (next.end == bytes::ReadEnd::Lost) {
    const std::string why = link_.why_lost();
    return core::fail(ErrorCode::DeviceGone, options_.description.uri + " is gone" + (why.empty() ? "" : ": " + why));
  }
  if (next.end != bytes::ReadEnd::Bytes) return false;
  handle(next.piece.payload, next.raw_ns);
  return true;
}

void Conversation::handle(std::span<const std::uint8_t> payload, std::int64_t raw_ns) {
  switch (static_cast<FrameType>(payload[0])) {
    case FrameType::Descriptor: {
      const auto descriptor = parse_descriptor(payload);
      if (!descriptor) return refuse(descriptor.error());
      facts_.add(*descriptor);
      ++descriptors_;
      newest_fact_ns_ = clock_.now_ns();
      return;
    }
    case FrameType::Channel: {
      const auto channel = parse_channel(payload);
      const auto added = channel ? facts_.add(*channel) : tl::make_unexpected(channel.error());
      if (!added) refuse(added.error());
      newest_fact_ns_ = clock_.now_ns();
      return;
    }
    case FrameType::Scans: return note_scans(payload, raw_ns);
    case FrameType::Lost:
      if (const auto lost = parse_lost(payload)) {
        if (lost->reason == static_cast<std::uint8_t>(LostReason::Stopped)) stopped_ = *lost;
      }
      return;
    default: return;
  }
}

void Conversation::refuse(const Refusal& refusal) {
  refusal_ = refusal;
  if (!refusal.is_malformed) facts_.doubt();
}

void Conversation::note_scans(std::span<const std::uint8_t> payload, std::int64_t raw_ns) {
  if (!facts_.has_descriptor()) return;
  const auto scans = parse_scans(payload, facts_.descriptor().channels);
  if (!scans) return;
  const Arrived arrived{scans->run, scans->counter, scans->ticks, scans->counter + static_cast<std::uint32_t>(scans->count - 1), raw_ns};
  if (!span_ || span_->first.run != scans->run) span_ = Span{arrived, arrived};
  span_->newest = arrived;
}

core::Status Conversation::send(const EncodedFrame& frame) {
  const core::Status sent = link_.write(frame.view());
  if (!sent && sent.error().code == ErrorCode::DeviceGone) return sent;
  return {};  // a board that does not receive takes no bytes: its answer is what counts
}

/// Returns the error for a board without a usable answer: what came instead is the best hint.
core::Error Conversation::unanswered(const std::string& what) const {
  if (refusal_) return {ErrorCode::DataDamaged, what + ": " + to_string(*refusal_), "correct the board's program"};
  if (facts_.has_descriptor() && !facts_.is_complete()) {
    return {ErrorCode::Timeout, what + ": the board did not describe all of its channels", "check the board's program"};
  }
  const InputCounts& counts = input_.decoder().counts();
  if (counts.good == 0 && input_.byte_count() >= kLeastGarbage) {
    return {ErrorCode::DataDamaged, what + ": what arrives are no frames (" + std::to_string(input_.byte_count()) + " bytes)",
            "check baud, and format: a board that prints numbers needs format=lines"};
  }
  return {ErrorCode::Timeout, what + ": the board does not answer", "check its program, cable and power; reset it"};
}

/// Asks until everything is known. A board that is answering is not asked again: it would begin again.
core::Status Conversation::learn() {
  facts_.forget();
  refusal_.reset();
  const std::int64_t until_ns = clock_.now_ns() + kLearnNs;
  std::int64_t ask_at_ns = clock_.now_ns();
  newest_fact_ns_ = ask_at_ns - kAnswerNs;
  while (!facts_.is_complete()) {
    const std::int64_t now_ns = clock_.now_ns();
    if (now_ns >= until_ns) return tl::make_unexpected(unanswered("cannot open " + options_.description.uri));
    if (now_ns >= std::max(ask_at_ns, newest_fact_ns_ + kAnswerNs)) {
      DTS_TRY(send(describe_command()));
      ask_at_ns = now_ns + kAnswerNs;
    }
    DTS_TRY(listen(std::min(until_ns, std::max(ask_at_ns, newest_fact_ns_ + kAnswerNs))));
    if (refusal_ && !refusal_->is_malformed) return tl::make_unexpected(unanswered("cannot open " + options_.description.uri));
  }
  return {};
}

/// Sends a command until a DESCRIPTOR that came later is its answer.
core::Status Conversation::command(const EncodedFrame& frame, const char* name, const Condition& is_answer) {
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    DTS_TRY(send(frame));
    const std::int64_t until_ns = clock_.now_ns() + kAnswerNs;
    while (clock_.now_ns() < until_ns) {
      const std::uint64_t before = descriptors_;
      DTS_TRY(listen(until_ns));
      if (descriptors_ != before && is_answer(facts_.descriptor())) return {};
    }
  }
  return core::fail(ErrorCode::Timeout, options_.description.uri + ": the board does not answer " + name, "reset it, or plug it in again");
}

/// Stops a scan and the pattern. A button or another host may have started a scan since the last DESCRIPTOR, so STOP is always sent.
core::Status Conversation::halt() {
  if (facts_.descriptor().starts_on_command) {
    DTS_TRY(command(stop_command(), "STOP", [](const Descriptor& now) { return !now.is_streaming; }));
  }
  if (!facts_.descriptor().is_pattern) return {};
  return command(pattern_command(false), "PATTERN", [](const Descriptor& now) { return !now.is_pattern; });
}

/// Handles what has arrived: a board that was reset in the meantime has described itself. Then drops the rest.
core::Status Conversation::catch_up() {
  const std::int64_t until_ns = clock_.now_ns() + kCatchUpNs;
  while (clock_.now_ns() < until_ns) {
    DTS_TRY_ASSIGN(const bool has_come, listen(clock_.now_ns()));
    if (!has_come) break;
  }
  if (input_.drain()) return {};
  return core::fail(ErrorCode::DeviceGone, "cannot start " + options_.description.uri + ": it is gone");
}

core::Status Conversation::meet() {
  DTS_TRY(learn());
  DTS_TRY(check_serial());
  DTS_TRY(check_agreement(options_, facts_));
  facts_.agree();  // from here on every frame that contradicts them ends it
  measured_hz_ = 0.0;
  core::Status ready = halt();
  if (ready && !facts_.descriptor().rate.is_known()) ready = measure_rate();
  if (!ready) facts_.doubt();
  return ready;
}

/// The configured serial number is that of the board or that of its USB adapter.
core::Status Conversation::check_serial() const {
  const std::string& wanted = options_.serial;
  const std::string_view own = facts_.descriptor().serial.view();
  const std::string of_adapter = link_.facts().serial;
  if (wanted.empty() || own == wanted || of_adapter == wanted) return {};
  std::string found = own.empty() ? "the board has no serial number" : "the board's serial number is " + std::string(own);
  if (!of_adapter.empty()) found += ", that of its USB adapter " + of_adapter;
  return core::fail(ErrorCode::NotFound, "cannot open " + options_.description.uri + ": " + found + ", the address says serial=" + wanted,
                    "plug in the right board, or correct serial");
}

core::Status Conversation::measure_rate() {
  const bool takes_commands = facts_.descriptor().starts_on_command;
  if (takes_commands) {
    DTS_TRY(command(start_command({}), "START", [](const Descriptor& now) { return now.is_streaming; }));
  } else {
    input_.drain();
  }
  span_.reset();
  const std::int64_t begin_ns = clock_.now_ns();
  std::uint32_t scans = 0;
  while (clock_.now_ns() < begin_ns + kLongestMeasureNs) {
    DTS_TRY(listen(begin_ns + kLongestMeasureNs));
    if (!span_) continue;
    scans = span_->newest.last - span_->first.last;
    if (span_->newest.raw_ns - span_->first.raw_ns >= kMeasureNs && scans >= kLeastMeasuredScans) break;
  }
  if (takes_commands) DTS_TRY(halt());
  if (!span_ || scans < kLeastMeasuredScans || span_->newest.raw_ns - span_->first.raw_ns < kMeasureNs) {
    return core::fail(ErrorCode::Timeout, "cannot open " + options_.description.uri + ": the board sends too few scans to measure its rate",
                      "check the board's program");
  }
  const Descriptor& board = facts_.descriptor();
  const std::uint32_t ticks = span_->newest.ticks - span_->first.ticks;
  if (board.carries_time && ticks > 0) {  // ticks belong to the first scan of a frame
    measured_hz_ = static_cast<double>(span_->newest.counter - span_->first.counter) * board.ticks_per_second / ticks;
  } else {
    measured_hz_ = scans * 1e9 / static_cast<double>(span_->newest.raw_ns - span_->first.raw_ns);
  }
  return {};
}

/// Compares the wanted rate with the rate that the board runs, or that was measured.
core::Status Conversation::check_rate(core::Rate wanted, const std::string& what) {
  const WireRate runs = facts_.descriptor().rate;
  if (!runs.is_known()) {
    if (std::abs(measured_hz_ / wanted.hz() - 1.0) <= kLargestMeasuredError) return {};
    return core::fail(ErrorCode::InvalidArgument,
                      what + ": the board scans at about " + number_text(std::round(measured_hz_ * 10.0) / 10.0) + " Hz, not at " +
                          number_text(wanted.hz()) + " Hz",
                      "configure the board's rate in rate_hz");
  }
  if (std::abs(runs.hz() - wanted.hz()) <= kRateToleranceHz) return {};
  const double configurable = std::round(runs.hz() * 1e6) * 1e-6;
  return core::fail(
      ErrorCode::InvalidArgument,
      what + ": the board cannot run at " + number_text(wanted.hz()) + " Hz; the nearest is " + number_text(runs.hz()) + " Hz",
      "configure rate_hz = " + number_text(configurable));
}

/// Starts a run; afterwards the newest DESCRIPTOR is the board's answer.
core::Result<RunStart> Conversation::begin_run(core::Rate rate) {
  DTS_TRY(halt());
  RunStart started{.is_commanded = facts_.descriptor().starts_on_command};
  if (started.is_commanded) {
    started.wanted = facts_.descriptor().rate.is_known() ? wire_rate(rate) : WireRate{};
    DTS_TRY(command(start_command(started.wanted), "START", [](const Descriptor& now) { return now.is_streaming; }));
  }
  started.confirmed = facts_.descriptor().rate;
  return started;
}

core::Result<RunStart> Conversation::start(core::Rate rate) {
  const std::string what = "cannot start " + options_.description.uri;
  DTS_TRY(catch_up());
  RunStart started;
  bool is_right = false;
  for (int attempt = 0; attempt < kStarts && !is_right; ++attempt) {
    if (!facts_.is_agreed()) DTS_TRY(meet());
    DTS_TRY_ASSIGN(started, begin_run(rate));
    is_right = facts_.is_agreed() && !facts_.descriptor().is_pattern;
    if (!is_right) DTS_TRY(halt());  // it has changed since it described itself
  }
  if (!facts_.is_agreed()) {
    return core::fail(ErrorCode::Failed, what + ": the board describes itself differently each time", "correct the board's program");
  }
  if (!is_right) return core::fail(ErrorCode::Failed, what + ": the board sends its test pattern", "reset the board");
  if (const core::Status checked = check_rate(rate, what); !checked) {
    DTS_TRY(halt());
    return tl::make_unexpected(checked.error());
  }
  return started;
}

core::Result<std::optional<std::uint32_t>> Conversation::stop(const FrameSource& source) {
  if (!facts_.has_descriptor() || !facts_.descriptor().starts_on_command) return std::optional<std::uint32_t>();
  stopped_.reset();
  DTS_TRY(send(stop_command()));
  const std::int64_t until_ns = clock_.now_ns() + kStopNs;
  const std::uint64_t before = descriptors_;
  bool has_answered = false;
  while (clock_.now_ns() < until_ns && !(has_answered && stopped_)) {
    DTS_TRY(listen(until_ns));
    has_answered = has_answered || (descriptors_ != before && !facts_.descriptor().is_streaming);
  }
  if (!has_answered && !stopped_) {
    return core::fail(ErrorCode::Timeout, "cannot stop the scan of " + options_.description.uri + ": the board does not answer STOP",
                      "reset it, or plug it in again");
  }
  if (!stopped_) return std::optional<std::uint32_t>();
  return source.scans_until(stopped_->run, stopped_->counter);
}

}  // namespace dts::device::board
