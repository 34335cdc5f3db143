// SPDX-License-Identifier: Apache-2.0
#include "lab/compare/pulse_train.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "cli/table.h"
#include "lab/compare/clock_fit.h"
#include "lab/compare/paired.h"

namespace dts::lab::compare {
namespace {

constexpr std::size_t kFewestPulses = 10;
constexpr std::size_t kMostPulses = 200'000;
constexpr double kMostApart = 0.02;   ///< Of the period: difference between the periods of both recordings.
constexpr double kIrregular = 0.2;    ///< Of the period: a control thread sends the pulses, at times up to 50 ms late.
constexpr double kMostRegular = 0.8;  ///< Of the intervals.
constexpr double kSamePulse = 0.25;   ///< Of the period: largest distance of a pulse from where its neighbours say that it is.
constexpr double kFollow = 0.3;       ///< How fast the tracked offset follows the pulses.
constexpr double kGapS = 0.5;         ///< A recording without scans for so long has a gap; the pulses in it are not reported one by one.
constexpr double kAlike = 0.5;        ///< Of a scan: intervals that scatter less are all rounded alike.
constexpr double kLeastSignalSdS = 1e-4;  ///< Filters differ by more than the standard error of a long correlation shows.
constexpr double kSureCorrelation = 0.7;  ///< Of signals that may contradict the computer's clock.
constexpr double kHostSdS = 0.02;         ///< Of a device's first time stamp on the computer's clock.

/// Returns the mean of the intervals near the median: a lost pulse does not count, and rounding to scans averages out.
double period_of(std::span<const double> edges_s) {
  std::vector<double> intervals;
  for (std::size_t k = 1; k < edges_s.size(); ++k) intervals.push_back(edges_s[k] - edges_s[k - 1]);
  if (intervals.empty()) return 0.0;
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::ranges::nth_element(intervals, middle);
  const double median_s = *middle;
  double sum_s = 0.0;
  double count = 0.0;
  for (const double interval_s : intervals) {
    if (std::abs(interval_s - median_s) > kIrregular * median_s) continue;
    sum_s += interval_s;
    count += 1.0;
  }
  return sum_s / count;
}

/// Returns the distance from the nearest whole number of periods.
double off_grid_s(double interval_s, double period_s) { return std::abs(interval_s - std::round(interval_s / period_s) * period_s); }

bool is_regular(std::span<const double> edges_s, double period_s) {
  std::size_t regular = 0;
  for (std::size_t k = 1; k < edges_s.size(); ++k)
    regular += off_grid_s(edges_s[k] - edges_s[k - 1], period_s) < kIrregular * period_s ? 1 : 0;
  return static_cast<double>(regular) >= kMostRegular * static_cast<double>(edges_s.size() - 1);
}

/// Pulses of both recordings from a common one, in one direction of time.
struct Track {
  std::vector<std::pair<double, double>> pairs{};
  std::vector<double> only_a{};
  std::vector<double> only_b{};
};

/// Follows both trains from their first pulses, which belong together. Only the neighbours say where a pulse is expected, so that the drift
/// of hours does not matter.
Track follow(std::span<const double> a_s, std::span<const double> b_s, double tolerance_s) {
  Track track;
  double late_s = a_s[0] - b_s[0];
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a_s.size() && j < b_s.size()) {
    const double off_s = a_s[i] - b_s[j] - late_s;
    if (std::abs(off_s) > tolerance_s) {
      off_s < 0.0 ? track.only_a.push_back(a_s[i++]) : track.only_b.push_back(b_s[j++]);
    } else if (i + 1 < a_s.size() && std::abs(a_s[i + 1] - b_s[j] - late_s) < std::abs(off_s)) {
      track.only_a.push_back(a_s[i++]);
    } else if (j + 1 < b_s.size() && std::abs(a_s[i] - b_s[j + 1] - late_s) < std::abs(off_s)) {
      track.only_b.push_back(b_s[j++]);
    } else {
      late_s += kFollow * off_s;
      track.pairs.emplace_back(a_s[i++], b_s[j++]);
    }
  }
  track.only_a.insert(track.only_a.end(), a_s.begin() + static_cast<std::ptrdiff_t>(i), a_s.end());
  track.only_b.insert(track.only_b.end(), b_s.begin() + static_cast<std::ptrdiff_t>(j), b_s.end());
  return track;
}

/// Returns the times backwards, with the opposite sign.
std::vector<double> turned(std::span<const double> times_s) {
  std::vector<double> result(times_s.rbegin(), times_s.rend());
  for (double& time_s : result) time_s = -time_s;
  return result;
}

/// Follows both trains from the common pulses `i` of A and `j` of B into both directions. All times rise.
Track follow_both_ways(const Recording& a, const Recording& b, std::size_t i, std::size_t j, double tolerance_s) {
  const std::span<const double> all_a(a.edges_s);
  const std::span<const double> all_b(b.edges_s);
  Track ahead = follow(all_a.subspan(i), all_b.subspan(j), tolerance_s);
  const Track back = follow(turned(all_a.first(i + 1)), turned(all_b.first(j + 1)), tolerance_s);
  Track both;
  for (auto pair = back.pairs.rbegin(); pair != back.pairs.rend(); ++pair) both.pairs.emplace_back(-pair->first, -pair->second);
  if (!both.pairs.empty()) both.pairs.pop_back();  // the common pulse is in both
  both.only_a = turned(back.only_a);
  both.only_b = turned(back.only_b);
  both.pairs.insert(both.pairs.end(), ahead.pairs.begin(), ahead.pairs.end());
  both.only_a.insert(both.only_a.end(), ahead.only_a.begin(), ahead.only_a.end());
  both.only_b.insert(both.only_b.end(), ahead.only_b.begin(), ahead.only_b.end());
  return both;
}

/// The pulses that belong together in the middle of what is known, and which of them.
struct Start {
  std::size_t i = 0;
  std::size_t j = 0;
};

/// Returns the pulses nearest to where the clocks are known best; nothing if they do not fit or if the clocks are not known to a quarter of
/// the period there.
std::optional<Start> start_near(const Recording& a, const Recording& b, const Alignment& near, double period_s) {
  if (!(4.0 * near.offset_sd_s < kSamePulse * period_s)) return std::nullopt;
  std::optional<Start> best;
  double best_s = 0.0;
  for (std::size_t j = 0; j < b.edges_s.size(); ++j) {
    const double from_reference_s = std::abs(b.edges_s[j] - near.reference_s);
    if (best && from_reference_s >= best_s) continue;
    const double at_a_s = near.to_a_s(b.edges_s[j]);
    const auto next = std::ranges::lower_bound(a.edges_s, at_a_s - kSamePulse * period_s);
    if (next == a.edges_s.end() || std::abs(*next - at_a_s) > kSamePulse * period_s) continue;
    best = Start{.i = static_cast<std::size_t>(next - a.edges_s.begin()), .j = j};
    best_s = from_reference_s;
  }
  return best;
}

/// Returns the pulses that belong together by the computer's clock; nothing if it does not have both recordings' times. Its times are right
/// where a recording begins; later, the devices' clocks drift.
std::optional<Start> start_by_host(const Recording& a, const Recording& b, double period_s) {
  if (a.host_clock.empty() || a.host_clock != b.host_clock) return std::nullopt;
  const double between_s = b.began_s - a.began_s;
  return start_near(a, b, {.offset_s = between_s, .offset_sd_s = kHostSdS, .reference_s = std::max(0.0, -between_s)}, period_s);
}

/// Returns whether the signals agree clearly better in their own alignment than if these pulses belong together, and it is another one.
bool is_contradicted(const Recording& a, const Recording& b, const Start& start, const Alignment& by_signal, double period_s) {
  const double at_s = b.edges_s[start.j];
  if (std::abs(by_signal.to_a_s(at_s) - a.edges_s[start.i]) < period_s / 2.0) return false;
  const double by_pulse = correlation(pair_up(a, b, {.offset_s = a.edges_s[start.i] - at_s, .reference_s = at_s}));
  const double own = correlation(pair_up(a, b, by_signal));
  return own > kSureCorrelation && 1.0 - own < (1.0 - by_pulse) / 2.0;
}

/// Finds the pulses that belong together. A device may have a constant error of its times, so the signals are asked even if the computer's
/// clock knows; `warning` receives their contradiction.
core::Result<Start> find_start(const Recording& a, const Recording& b, double period_s, std::string& warning) {
  const auto by_host = start_by_host(a, b, period_s);
  const auto by_signal = align_by_correlation(a, b);
  const auto start = by_signal ? start_near(a, b, *by_signal, period_s) : std::nullopt;
  if (by_host && !(start && is_contradicted(a, b, *by_host, *by_signal, period_s))) return *by_host;
  if (by_host) warning = "the signals contradict the times of the recordings by more than half a period of the pulses: the signals decide";
  if (start) return *start;
  return core::fail(core::ErrorCode::Failed,
                    "the pulses repeat every " + cli::decimal(period_s, 3) +
                        " s, and nothing shows which of them belong together: the times are not of one computer, and " +
                        (by_signal ? "the signals do not determine the offset well enough" : by_signal.error().what),
                    "compare the parts of one session, or let the subject make a few quick movements in both recordings");
}

/// Returns whether the recording has no scans about this time.
bool is_in_gap(const Recording& recording, double at_s) {
  const auto next = std::ranges::lower_bound(recording.t_s, at_s);
  if (next == recording.t_s.begin() || next == recording.t_s.end()) return true;
  return *next - *(next - 1) > kGapS;
}

/// Returns whether a pulse that only one recording has is on the grid of that recording's train: then the other recording lost it.
bool is_on_grid(const std::vector<double>& paired_s, double at_s, double period_s) {
  const auto next = std::ranges::lower_bound(paired_s, at_s);
  const double neighbour_s = next == paired_s.end() ? paired_s.back() : *next;
  const double before_s = next == paired_s.begin() ? neighbour_s : *(next - 1);
  const double nearest_s = std::abs(neighbour_s - at_s) < std::abs(before_s - at_s) ? neighbour_s : before_s;
  return std::abs(nearest_s - at_s) > period_s / 2.0 && off_grid_s(nearest_s - at_s, period_s) < kSamePulse * period_s;
}

std::vector<PulseFault> faults_of(const Recording& a, const Recording& b, const Track& track, const Alignment& alignment, double period_s) {
  std::vector<double> paired_a_s;
  std::vector<double> paired_b_s;
  for (const auto& [a_s, b_s] : track.pairs) {
    paired_a_s.push_back(a_s);
    paired_b_s.push_back(b_s);
  }
  std::vector<PulseFault> faults;
  for (const double a_s : track.only_a) {
    const double b_s = a_s - (alignment.to_a_s(a_s - alignment.offset_s) - (a_s - alignment.offset_s));
    if (is_in_gap(b, b_s)) continue;
    const bool is_lost = is_on_grid(paired_a_s, a_s, period_s);
    faults.push_back({.kind = is_lost ? PulseFault::Kind::LostInB : PulseFault::Kind::ExtraInA, .time_s = a_s});
  }
  for (const double b_s : track.only_b) {
    const double a_s = alignment.to_a_s(b_s);
    if (is_in_gap(a, a_s)) continue;
    const bool is_lost = is_on_grid(paired_b_s, b_s, period_s);
    faults.push_back({.kind = is_lost ? PulseFault::Kind::LostInA : PulseFault::Kind::ExtraInB, .time_s = a_s});
  }
  std::ranges::sort(faults, {}, &PulseFault::time_s);
  return faults;
}

/// Returns the standard deviation of an error that all pulses of a recording have in common. If the pulses come with the recording's own
/// clock, all of them are rounded to scans alike, and many pulses are no better than one; else the rounding scatters and averages out.
double common_rounding_s(const Recording& recording, double period_s) {
  const double rounding_s = recording.edge_step_s / std::sqrt(12.0);
  double least_s = 0.0;
  double most_s = 0.0;
  for (std::size_t k = 1; k < recording.edges_s.size(); ++k) {
    const double interval_s = recording.edges_s[k] - recording.edges_s[k - 1];
    const double off_s = interval_s - std::round(interval_s / period_s) * period_s;
    least_s = std::min(least_s, off_s);
    most_s = std::max(most_s, off_s);
  }
  return most_s - least_s < kAlike * recording.edge_step_s ? rounding_s : 0.0;
}

/// The pulses give the drift. Where all of them are rounded alike, they leave the offset open within a scan: the signals narrow it down, as
/// far as that scan allows, because a filter of unknown delay may mislead them.
void remove_common_rounding(const Recording& a, const Recording& b, double period_s, Alignment& alignment) {
  const double of_a_s = common_rounding_s(a, period_s);
  const double of_b_s = common_rounding_s(b, period_s);
  const double rounding_s = std::hypot(of_a_s, of_b_s);
  if (rounding_s == 0.0) return;
  const double pulse_sd_s = std::hypot(alignment.offset_sd_s, rounding_s);
  alignment.offset_sd_s = pulse_sd_s;
  const auto by_signal = align_by_correlation(a, b);
  if (!by_signal || !by_signal->pieces.empty() || !(by_signal->offset_sd_s < pulse_sd_s)) return;
  const double signal_sd_s = std::max(by_signal->sd_at_s(alignment.reference_s), kLeastSignalSdS);
  const double weight = pulse_sd_s * pulse_sd_s / (pulse_sd_s * pulse_sd_s + signal_sd_s * signal_sd_s);
  const double most_s = std::sqrt(3.0) * (of_a_s + of_b_s);  // half a scan of each
  const double differs_s = by_signal->to_a_s(alignment.reference_s) - alignment.to_a_s(alignment.reference_s);
  alignment.offset_s += std::clamp(weight * differs_s, -most_s, most_s);
  alignment.offset_sd_s = std::abs(differs_s) > most_s + 4.0 * signal_sd_s ? pulse_sd_s : std::sqrt(weight) * signal_sd_s;
}

}  // namespace

bool have_pulse_trains(const Recording& a, const Recording& b) {
  if (a.edges_s.size() < kFewestPulses || b.edges_s.size() < kFewestPulses) return false;
  const double period_s = period_of(a.edges_s);
  if (!(period_s > 0.0) || std::abs(period_of(b.edges_s) - period_s) > kMostApart * period_s + a.edge_step_s + b.edge_step_s) return false;
  return is_regular(a.edges_s, period_s) && is_regular(b.edges_s, period_s);
}

core::Result<Alignment> align_by_pulse_train(const Recording& a, const Recording& b) {
  if (std::max(a.edges_s.size(), b.edges_s.size()) > kMostPulses) {
    return core::fail(core::ErrorCode::LimitExceeded, "more than " + std::to_string(kMostPulses) + " pulses in one recording",
                      "check that the trigger is a digital level");
  }
  const double period_s = period_of(a.edges_s);
  std::string warning;
  DTS_TRY_ASSIGN(const Start start, find_start(a, b, period_s, warning));
  const Track track = follow_both_ways(a, b, start.i, start.j, kSamePulse * period_s);
  const double sd_s = std::hypot(a.edge_step_s, b.edge_step_s) / std::sqrt(12.0);
  std::vector<ClockReading> readings;
  for (const auto& [a_s, b_s] : track.pairs) readings.push_back({.b_s = b_s, .late_s = a_s - b_s, .sd_s = sd_s});
  DTS_TRY_ASSIGN(auto alignment, fit_clocks(readings, Restarts(a, b)));
  remove_common_rounding(a, b, period_s, alignment);
  alignment.means = Alignment::Means::PulseTrain;
  alignment.period_s = period_s;
  alignment.warning = warning;
  alignment.faults = faults_of(a, b, track, alignment, period_s);
  return alignment;
}

}  // namespace dts::lab::compare
