// SPDX-License-Identifier: Apache-2.0
#include "lab/compare/pulse_train.h"

#include <algorithm>
#include <cmath>
#include <iterator>
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
constexpr double kMostApart = 0.02;     ///< Of the period: difference between the periods of both recordings.
constexpr double kIrregular = 0.2;      ///< Of the period: a control thread sends the pulses, at times up to 50 ms late.
constexpr double kMostRegular = 0.8;    ///< Of the intervals.
constexpr double kSamePulse = 0.25;     ///< Of the period: largest distance of a pulse from where its neighbours say that it is.
constexpr double kFollow = 0.3;         ///< How fast the tracked offset follows the pulses.
constexpr double kGapS = 0.5;           ///< A recording without scans for so long has a gap; the pulses in it are not reported one by one.
constexpr double kAlike = 0.5;          ///< Of a scan: intervals that scatter less are all rounded alike.
constexpr std::size_t kMostOthers = 3;  ///< Intervals that differ by a scan, where clocks that drift apart slowly reach the next scan.
constexpr double kLeastSignalSdS = 1e-4;  ///< Filters differ by more than the standard error of a long correlation shows.
constexpr double kSureCorrelation = 0.7;  ///< Of signals that may contradict the computer's clock.
constexpr double kLeastPieceS = 10.0;     ///< The signals of a shorter stretch resemble others by chance.
constexpr double kMostJumpS = 30.0;       ///< Of a clock at a gap, for the search by the signals.
constexpr double kStepsOfGap = 3.5;
constexpr std::size_t kFewestAlone = 3;  ///< Pulses without a partner between two gaps, if a clock restarted.
constexpr std::size_t kMostGaps = 1000;
constexpr double kHostSdS = 0.02;  ///< Of a device's first time stamp on the computer's clock.

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

/// Pulses of both recordings that belong together.
using PulsePairs = std::vector<std::pair<double, double>>;

/// Follows both trains from their first pulses, which belong together. Only the neighbours say where a pulse is expected, so that the drift
/// of hours does not matter.
PulsePairs follow(std::span<const double> a_s, std::span<const double> b_s, double tolerance_s) {
  PulsePairs pairs;
  double late_s = a_s[0] - b_s[0];
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a_s.size() && j < b_s.size()) {
    const double off_s = a_s[i] - b_s[j] - late_s;
    if (std::abs(off_s) > tolerance_s) {
      off_s < 0.0 ? ++i : ++j;
    } else if (i + 1 < a_s.size() && std::abs(a_s[i + 1] - b_s[j] - late_s) < std::abs(off_s)) {
      ++i;
    } else if (j + 1 < b_s.size() && std::abs(a_s[i] - b_s[j + 1] - late_s) < std::abs(off_s)) {
      ++j;
    } else {
      late_s += kFollow * off_s;
      pairs.emplace_back(a_s[i++], b_s[j++]);
    }
  }
  return pairs;
}

/// Returns the times backwards, with the opposite sign.
std::vector<double> turned(std::span<const double> times_s) {
  std::vector<double> result(times_s.rbegin(), times_s.rend());
  for (double& time_s : result) time_s = -time_s;
  return result;
}

/// Follows both trains from the common pulses `i` of A and `j` of B into both directions. All times rise.
PulsePairs follow_both_ways(const Recording& a, const Recording& b, std::size_t i, std::size_t j, double tolerance_s) {
  const std::span<const double> all_a(a.edges_s);
  const std::span<const double> all_b(b.edges_s);
  const PulsePairs ahead = follow(all_a.subspan(i), all_b.subspan(j), tolerance_s);
  const PulsePairs back = follow(turned(all_a.first(i + 1)), turned(all_b.first(j + 1)), tolerance_s);
  PulsePairs both;
  for (auto pair = back.rbegin(); pair != back.rend(); ++pair) both.emplace_back(-pair->first, -pair->second);
  if (!both.empty()) both.pop_back();  // the common pulse is in both
  both.insert(both.end(), ahead.begin(), ahead.end());
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
/// where a recording or a segment begins; later, the devices' clocks drift.
std::optional<Start> start_by_host(const Recording& a, const Recording& b, double period_s) {
  if (a.host_clock.empty() || a.host_clock != b.host_clock) return std::nullopt;
  const double between_s = b.began_s - a.began_s;
  return start_near(
      a, b, {.offset_s = between_s, .offset_sd_s = kHostSdS, .reference_s = std::max(b.t_s.front(), a.t_s.front() - between_s)}, period_s);
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
/// clock knows; `warning` receives their contradiction. In a piece between gaps, only clearly similar signals count.
core::Result<Start> find_start(const Recording& a, const Recording& b, double period_s, bool is_piece, std::string& warning) {
  const auto by_host = start_by_host(a, b, period_s);
  const auto markers = align_by_markers(a, b);
  const auto by_marker = markers ? start_near(a, b, *markers, period_s) : std::nullopt;
  const bool is_long = !is_piece || std::min(a.t_s.back() - a.t_s.front(), b.t_s.back() - b.t_s.front()) >= kLeastPieceS;
  const core::Result<Alignment> too_short = core::fail(core::ErrorCode::Failed, "the stretch is too short");
  const auto by_signal = is_long ? align_by_correlation(a, b) : too_short;
  const bool is_sure = by_signal && (!is_piece || correlation(pair_up(a, b, *by_signal)) > kSureCorrelation);
  const auto start = is_sure ? start_near(a, b, *by_signal, period_s) : std::nullopt;
  if (by_host && !(start && is_contradicted(a, b, *by_host, *by_signal, period_s))) return *by_host;
  if (by_host) warning = "the signals contradict the times of the recordings by more than half a period of the pulses: the signals decide";
  if (!by_host && by_marker) return *by_marker;
  if (start) return *start;
  return core::fail(
      core::ErrorCode::Failed,
      "the pulses repeat every " + cli::decimal(period_s, 3) +
          " s, and nothing shows which of them belong together: the times are not of one computer, no two markers are equal, and " +
          (by_signal ? "the signals do not determine the offset well enough" : by_signal.error().what),
      "compare the parts of one session, or set the same two markers in both recordings, or let the subject make a few quick "
      "movements in both");
}

/// A stretch of a recording's clock.
struct Stretch {
  double from_s = 0.0;
  double to_s = 0.0;

  [[nodiscard]] double length_s() const { return to_s - from_s; }
};

/// Returns the segment of the recording after so many restarts of its clock.
Stretch segment_of(const Recording& recording, std::size_t restarts) {
  const auto& at_s = recording.restarts_s;
  const double end_s = std::max(recording.t_s.back(), recording.edges_s.back()) + 1.0;
  return {.from_s = restarts == 0 ? std::min(recording.t_s.front(), recording.edges_s.front()) : at_s[restarts - 1],
          .to_s = restarts == at_s.size() ? end_s : at_s[restarts]};
}

/// Returns the scans and pulses of a stretch, with the times as they are.
Recording cut(const Recording& recording, const Stretch& stretch) {
  Recording part{.t_s = {}, .x_mm = {}, .y_mm = {}, .edge_step_s = recording.edge_step_s, .host_clock = recording.host_clock};
  part.began_s = recording.began_s;
  const auto is_inside = [&](double t_s) { return t_s >= stretch.from_s && t_s < stretch.to_s; };
  for (std::size_t k = 0; k < recording.t_s.size(); ++k) {
    if (!is_inside(recording.t_s[k])) continue;
    part.t_s.push_back(recording.t_s[k]);
    part.x_mm.push_back(recording.x_mm[k]);
    part.y_mm.push_back(recording.y_mm[k]);
    if (!recording.marker.empty()) part.marker.push_back(recording.marker[k]);
  }
  std::ranges::copy_if(recording.edges_s, std::back_inserter(part.edges_s), is_inside);
  return part;
}

/// A piece between two restarts of a clock, by the numbers of restarts of both clocks before it.
struct PlaceOfPiece {
  std::size_t restarts_a = 0;
  std::size_t restarts_b = 0;
};

/// Returns about where a piece is on B's clock.
Stretch about(const Recording& a, const Recording& b, const PlaceOfPiece& place, double late_s) {
  const Stretch of_a = segment_of(a, place.restarts_a);
  const Stretch of_b = segment_of(b, place.restarts_b);
  return {.from_s = std::max(of_b.from_s, of_a.from_s - late_s), .to_s = std::min(of_b.to_s, of_a.to_s - late_s)};
}

/// Pairs the pulses of one piece. `late_s` says where to search; it may be wrong by kMostJumpS.
core::Result<PulsePairs> pairs_of_piece(const Recording& a, const Recording& b, const PlaceOfPiece& place, double late_s, double period_s,
                                        std::string& warning) {
  const Stretch on_b = about(a, b, place, late_s);
  const Stretch of_a = segment_of(a, place.restarts_a);
  const Recording of_piece_b = cut(b, on_b);
  const Recording of_piece_a = cut(a, {.from_s = std::max(of_a.from_s, on_b.from_s + late_s - kMostJumpS),
                                       .to_s = std::min(of_a.to_s, on_b.to_s + late_s + kMostJumpS)});
  const bool is_enough = std::min(of_piece_a.t_s.size(), of_piece_b.t_s.size()) >= 2 && !of_piece_a.edges_s.empty() &&
                         !of_piece_b.edges_s.empty() &&
                         std::min(of_piece_a.t_s.back() - of_piece_a.t_s.front(), of_piece_b.t_s.back() - of_piece_b.t_s.front()) > 2.0;
  if (!is_enough) return core::fail(core::ErrorCode::Failed, "a piece between two gaps is too short");
  DTS_TRY_ASSIGN(const Start start, find_start(of_piece_a, of_piece_b, period_s, true, warning));
  return follow_both_ways(of_piece_a, of_piece_b, start.i, start.j, kSamePulse * period_s);
}

/// Returns the pieces in the order of time, if A's reading minus B's is about `late_s`.
std::vector<PlaceOfPiece> pieces_in_order(const Recording& a, const Recording& b, double late_s) {
  std::vector<PlaceOfPiece> pieces{{}};
  while (pieces.back().restarts_a < a.restarts_s.size() || pieces.back().restarts_b < b.restarts_s.size()) {
    PlaceOfPiece next = pieces.back();
    const bool is_a = next.restarts_b == b.restarts_s.size() ||
                      (next.restarts_a < a.restarts_s.size() && a.restarts_s[next.restarts_a] - late_s < b.restarts_s[next.restarts_b]);
    is_a ? ++next.restarts_a : ++next.restarts_b;
    pieces.push_back(next);
  }
  return pieces;
}

/// Returns about by how much A's readings exceed B's.
std::optional<double> rough_late_s(const Recording& a, const Recording& b) {
  if (!a.host_clock.empty() && a.host_clock == b.host_clock) return b.began_s - a.began_s;
  const auto by_signal = align_by_correlation(a, b);
  return by_signal ? std::optional(by_signal->offset_s) : std::nullopt;
}

/// Pairs the pulses in each piece on its own, because a clock may have jumped by more than a period. A piece in which nothing shows which
/// pulses belong together has no pairs.
core::Result<PulsePairs> pairs_by_piece(const Recording& a, const Recording& b, double period_s, std::string& warning) {
  const double late_s = rough_late_s(a, b).value_or(0.0);
  const auto pieces = pieces_in_order(a, b, late_s);
  if (pieces.size() > kMostGaps) {
    return core::fail(core::ErrorCode::LimitExceeded, "the recordings have more than " + std::to_string(kMostGaps) + " gaps",
                      "export the part without gaps as CSV and compare that");
  }
  const auto longest =
      std::ranges::max_element(pieces, {}, [&](const PlaceOfPiece& place) { return about(a, b, place, late_s).length_s(); });
  DTS_TRY_ASSIGN(PulsePairs pairs, pairs_of_piece(a, b, *longest, late_s, period_s, warning));
  const auto late_of = [](const std::pair<double, double>& pair) { return pair.first - pair.second; };
  double near_s = late_of(pairs.back());
  const double first_late_s = late_of(pairs.front());
  for (auto piece = longest + 1; piece != pieces.end(); ++piece) {
    const auto more = pairs_of_piece(a, b, *piece, near_s, period_s, warning);
    if (!more || more->empty()) continue;
    near_s = late_of(more->back());
    for (const auto& pair : *more) {
      if (pair.first > pairs.back().first && pair.second > pairs.back().second) pairs.push_back(pair);
    }
  }
  near_s = first_late_s;
  for (auto piece = longest; piece != pieces.begin();) {
    --piece;
    auto more = pairs_of_piece(a, b, *piece, near_s, period_s, warning);
    if (!more || more->empty()) continue;
    near_s = late_of(more->front());
    std::erase_if(*more, [&](const auto& pair) { return pair.first >= pairs.front().first || pair.second >= pairs.front().second; });
    pairs.insert(pairs.begin(), more->begin(), more->end());
  }
  return pairs;
}

/// Returns the pulses that are in no pair.
std::vector<double> unpaired(const std::vector<double>& edges_s, const std::vector<double>& paired_s) {
  std::vector<double> rest;
  std::ranges::set_difference(edges_s, paired_s, std::back_inserter(rest));
  return rest;
}

std::size_t count_within(const std::vector<double>& times_s, const Stretch& stretch) {
  const auto first = std::ranges::lower_bound(times_s, stretch.from_s);
  const auto last = std::ranges::lower_bound(times_s, stretch.to_s);
  return last > first ? static_cast<std::size_t>(last - first) : 0;
}

/// Returns the first scans after gaps, with the restarts.
std::vector<double> gaps_of(const Recording& recording) {
  std::vector<double> gaps = recording.restarts_s;
  const double step_s = recording.step_s();
  for (std::size_t k = 1; k < recording.t_s.size(); ++k) {
    if (recording.t_s[k] - recording.t_s[k - 1] > kStepsOfGap * step_s) gaps.push_back(recording.t_s[k]);
  }
  std::ranges::sort(gaps);
  gaps.erase(std::unique(gaps.begin(), gaps.end()), gaps.end());
  return gaps;
}

/// Returns the restarts of a recording's clock, with those that only the pulses show: between two gaps, both recordings have pulses, and
/// most of them do not belong together.
std::vector<double> seen_restarts(const Recording& own, const std::vector<double>& own_s, const Recording& other,
                                  const std::vector<double>& others_s) {
  std::vector<double> restarts = own.restarts_s;
  const std::vector<double> gaps = gaps_of(own);
  if (own_s.empty() || gaps.size() > kMostGaps) return restarts;
  const std::vector<double> rest = unpaired(own.edges_s, own_s);
  const std::vector<double> others_rest = unpaired(other.edges_s, others_s);
  for (std::size_t k = 0; k <= gaps.size(); ++k) {
    const Stretch stretch{.from_s = k == 0 ? -1.0 : gaps[k - 1], .to_s = k == gaps.size() ? own.t_s.back() + 1.0 : gaps[k]};
    const auto next = static_cast<std::size_t>(std::ranges::lower_bound(own_s, stretch.from_s) - own_s.begin());
    const std::size_t near = std::min(next, own_s.size() - 1);
    const double to_other_s = others_s[near] - own_s[near];
    const std::size_t alone = count_within(rest, stretch);
    const std::size_t others_alone = count_within(others_rest, {.from_s = stretch.from_s + to_other_s, .to_s = stretch.to_s + to_other_s});
    if (alone <= count_within(own_s, stretch) || std::min(alone, others_alone) < kFewestAlone) continue;
    if (k > 0) restarts.push_back(gaps[k - 1]);
    if (k < gaps.size()) restarts.push_back(gaps[k]);
  }
  std::ranges::sort(restarts);
  restarts.erase(std::unique(restarts.begin(), restarts.end()), restarts.end());
  return restarts;
}

/// Returns whether the pulses show restarts that the recordings do not name.
bool add_seen_restarts(const PulsePairs& pairs, Recording& a, Recording& b) {
  std::vector<double> of_a_s;
  std::vector<double> of_b_s;
  for (const auto& [a_s, b_s] : pairs) {
    of_a_s.push_back(a_s);
    of_b_s.push_back(b_s);
  }
  std::vector<double> restarts_a_s = seen_restarts(a, of_a_s, b, of_b_s);
  std::vector<double> restarts_b_s = seen_restarts(b, of_b_s, a, of_a_s);
  const bool is_more = restarts_a_s.size() > a.restarts_s.size() || restarts_b_s.size() > b.restarts_s.size();
  a.restarts_s = std::move(restarts_a_s);
  b.restarts_s = std::move(restarts_b_s);
  return is_more;
}

core::Result<PulsePairs> all_pairs(const Recording& a, const Recording& b, double period_s, std::string& warning) {
  if (!a.restarts_s.empty() || !b.restarts_s.empty()) return pairs_by_piece(a, b, period_s, warning);
  DTS_TRY_ASSIGN(const Start start, find_start(a, b, period_s, false, warning));
  return follow_both_ways(a, b, start.i, start.j, kSamePulse * period_s);
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

/// The pulses of one recording, and which of them have a partner in the other.
struct Partners {
  std::vector<double> own_s{};
  std::vector<double> others_s{};
  std::vector<std::size_t> piece{};

  /// Returns the time on the other recording's clock, by the nearest pair; nothing between two pieces, where a pulse may be in a gap.
  [[nodiscard]] std::optional<double> to_other(double at_s) const {
    const auto next = static_cast<std::size_t>(std::ranges::upper_bound(own_s, at_s) - own_s.begin());
    if (next > 0 && next < own_s.size() && piece[next - 1] != piece[next]) return std::nullopt;
    const std::size_t near = next == own_s.size() ? next - 1 : next;
    return at_s + others_s[near] - own_s[near];
  }
};

std::vector<PulseFault> faults_of(const Recording& a, const Recording& b, const PulsePairs& pairs, double period_s) {
  const Restarts restarts(a, b);
  Partners of_a;
  for (const auto& [a_s, b_s] : pairs) {
    of_a.own_s.push_back(a_s);
    of_a.others_s.push_back(b_s);
    of_a.piece.push_back(restarts.piece_at(a_s, b_s));
  }
  const Partners of_b{.own_s = of_a.others_s, .others_s = of_a.own_s, .piece = of_a.piece};
  std::vector<PulseFault> faults;
  for (const double a_s : unpaired(a.edges_s, of_a.own_s)) {
    const auto b_s = of_a.to_other(a_s);
    if (!b_s || is_in_gap(b, *b_s)) continue;
    const bool is_lost = is_on_grid(of_a.own_s, a_s, period_s);
    faults.push_back({.kind = is_lost ? PulseFault::Kind::LostInB : PulseFault::Kind::ExtraInA, .time_s = a_s});
  }
  for (const double b_s : unpaired(b.edges_s, of_b.own_s)) {
    const auto a_s = of_b.to_other(b_s);
    if (!a_s || is_in_gap(a, *a_s)) continue;
    const bool is_lost = is_on_grid(of_b.own_s, b_s, period_s);
    faults.push_back({.kind = is_lost ? PulseFault::Kind::LostInA : PulseFault::Kind::ExtraInB, .time_s = *a_s});
  }
  std::ranges::sort(faults, {}, &PulseFault::time_s);
  return faults;
}

/// Returns the standard deviation of an error that all pulses of a recording have in common. If the pulses come with the recording's own
/// clock, all of them are rounded to scans alike, and many pulses are no better than one; else the rounding scatters and averages out.
double common_rounding_s(const Recording& recording, double period_s) {
  const double rounding_s = recording.edge_step_s / std::sqrt(12.0);
  std::size_t others = 0;
  for (std::size_t k = 1; k < recording.edges_s.size(); ++k) {
    const double interval_s = recording.edges_s[k] - recording.edges_s[k - 1];
    others += off_grid_s(interval_s, period_s) > kAlike * recording.edge_step_s ? 1 : 0;
  }
  return others <= kMostOthers ? rounding_s : 0.0;
}

/// Returns the longest time between pulses of one piece, on B's clock.
double longest_span_s(const std::vector<ClockReading>& readings, const Restarts& restarts) {
  double longest_s = 0.0;
  std::size_t first = 0;
  for (std::size_t k = 0; k < readings.size(); ++k) {
    const auto piece_of = [&](std::size_t at) { return restarts.piece_at(readings[at].b_s + readings[at].late_s, readings[at].b_s); };
    if (piece_of(k) != piece_of(first)) first = k;
    longest_s = std::max(longest_s, readings[k].b_s - readings[first].b_s);
  }
  return longest_s;
}

/// While the clocks drift apart by less than a scan, the rounding of one of them looks like a drift.
void widen_drift(const Recording& a, const Recording& b, double span_s, Alignment& alignment) {
  if (!std::isfinite(alignment.drift_ppm)) return;
  const double least_ppm = 1e6 * std::hypot(a.edge_step_s, b.edge_step_s) / std::sqrt(3.0) / span_s;
  alignment.drift_sd_ppm = std::max(alignment.drift_sd_ppm, least_ppm);
}

/// Takes the mean of both drifts, with the weights of their variances.
void combine_drift(const Alignment& by_signal, Alignment& alignment) {
  if (!std::isfinite(by_signal.drift_ppm) || !std::isfinite(alignment.drift_ppm)) return;
  const double of_pulses = alignment.drift_sd_ppm * alignment.drift_sd_ppm;
  const double of_signals = by_signal.drift_sd_ppm * by_signal.drift_sd_ppm;
  const double weight = of_pulses / (of_pulses + of_signals);
  alignment.drift_ppm += weight * (by_signal.drift_ppm - alignment.drift_ppm);
  alignment.drift_sd_ppm = std::sqrt(weight * of_signals);
}

/// Where all pulses are rounded alike, they leave the offset open within a scan, and the drift by a scan over their time. The signals
/// narrow both down, the offset only as far as that scan allows, because a filter of unknown delay may mislead them.
void remove_common_rounding(const Recording& a, const Recording& b, double period_s, double span_s, Alignment& alignment) {
  const double of_a_s = common_rounding_s(a, period_s);
  const double of_b_s = common_rounding_s(b, period_s);
  const double rounding_s = std::hypot(of_a_s, of_b_s);
  if (rounding_s == 0.0) return;
  const double pulse_sd_s = std::hypot(alignment.offset_sd_s, rounding_s);
  alignment.offset_sd_s = pulse_sd_s;
  for (Alignment::Piece& piece : alignment.pieces) {
    piece.sd_s = std::hypot(piece.sd_s, rounding_s);
    if (piece.shift_sd_s > 0.0) piece.shift_sd_s = std::hypot(piece.shift_sd_s, std::sqrt(2.0) * rounding_s);
  }
  widen_drift(a, b, span_s, alignment);
  if (!alignment.pieces.empty()) return;
  const auto by_signal = align_by_correlation(a, b);
  if (!by_signal || !by_signal->pieces.empty() || !(by_signal->offset_sd_s < pulse_sd_s)) return;
  const double signal_sd_s = std::max(by_signal->sd_at_s(alignment.reference_s), kLeastSignalSdS);
  const double weight = pulse_sd_s * pulse_sd_s / (pulse_sd_s * pulse_sd_s + signal_sd_s * signal_sd_s);
  const double most_s = std::sqrt(3.0) * (of_a_s + of_b_s);  // half a scan of each
  const double differs_s = by_signal->to_a_s(alignment.reference_s) - alignment.to_a_s(alignment.reference_s);
  alignment.offset_s += std::clamp(weight * differs_s, -most_s, most_s);
  const bool is_contradicted = std::abs(differs_s) > most_s + 4.0 * signal_sd_s;
  alignment.offset_sd_s = is_contradicted ? pulse_sd_s : std::sqrt(weight) * signal_sd_s;
  alignment.is_refined_by_signals = true;
  if (!is_contradicted) combine_drift(*by_signal, alignment);
}

}  // namespace

bool have_pulse_trains(const Recording& a, const Recording& b) {
  if (a.edges_s.size() < kFewestPulses || b.edges_s.size() < kFewestPulses) return false;
  const double period_s = period_of(a.edges_s);
  if (!(period_s > 0.0) || std::abs(period_of(b.edges_s) - period_s) > kMostApart * period_s + a.edge_step_s + b.edge_step_s) return false;
  return is_regular(a.edges_s, period_s) && is_regular(b.edges_s, period_s);
}

core::Result<Alignment> align_by_pulse_train(const Recording& recording_a, const Recording& recording_b) {
  Recording a = recording_a;
  Recording b = recording_b;
  if (std::max(a.edges_s.size(), b.edges_s.size()) > kMostPulses) {
    return core::fail(core::ErrorCode::LimitExceeded, "more than " + std::to_string(kMostPulses) + " pulses in one recording",
                      "check that the trigger is a digital level");
  }
  const double period_s = period_of(a.edges_s);
  std::string warning;
  auto found = all_pairs(a, b, period_s, warning);
  if (!found) {  // a jump at a gap that the recordings do not name may be why
    a.restarts_s = gaps_of(a);
    b.restarts_s = gaps_of(b);
    const bool has_gaps = a.restarts_s.size() + b.restarts_s.size() > recording_a.restarts_s.size() + recording_b.restarts_s.size();
    std::string ignored;
    auto by_gaps = has_gaps ? all_pairs(a, b, period_s, ignored) : found;
    if (!by_gaps) return tl::make_unexpected(found.error());
    found = std::move(by_gaps);
    warning = ignored;
  }
  PulsePairs pairs = std::move(*found);
  if (add_seen_restarts(pairs, a, b)) {
    warning.clear();
    DTS_TRY_ASSIGN(pairs, all_pairs(a, b, period_s, warning));
  }
  const double sd_s = std::hypot(a.edge_step_s, b.edge_step_s) / std::sqrt(12.0);
  const Restarts restarts(a, b);
  std::vector<ClockReading> readings;
  for (const auto& [a_s, b_s] : pairs) readings.push_back({.b_s = b_s, .late_s = a_s - b_s, .sd_s = sd_s});
  DTS_TRY_ASSIGN(auto alignment, fit_clocks(readings, restarts));
  remove_common_rounding(a, b, period_s, longest_span_s(readings, restarts), alignment);
  alignment.means = Alignment::Means::PulseTrain;
  alignment.period_s = period_s;
  alignment.warning = warning;
  alignment.faults = faults_of(a, b, pairs, period_s);
  return alignment;
}

}  // namespace dts::lab::compare
