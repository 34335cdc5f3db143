// SPDX-License-Identifier: Apache-2.0
#include "lab/compare/clock_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "lab/compare/event_match.h"

namespace dts::lab::compare {
namespace {

constexpr std::size_t kMostPieces = 1000;
constexpr int kMostPasses = 10;
constexpr double kOutlierSd = 5.0;
constexpr double kMadToSd = 1.4826;
constexpr std::size_t kBatches = 10;
constexpr std::size_t kFewestForBatches = 50;

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

struct PieceSums {
  double weight = 0.0;
  double mean_b_s = 0.0;
  double mean_late_s = 0.0;
};

/// Least squares over the readings that are used: one drift, an offset for each piece.
class ClockLine {
 public:
  ClockLine(const std::vector<ClockReading>& readings, const std::vector<std::size_t>& piece_of, std::size_t pieces)
      : readings_(readings), piece_of_(piece_of), used_(readings.size(), true), sums_(pieces) {}

  /// Starts with medians, which outliers do not move; then leaves out readings that are far off, until no reading changes.
  void run() {
    set_medians();
    for (int pass = 0; pass < kMostPasses; ++pass) {
      const bool is_changed = leave_out_far_ones();
      if (pass > 0 && !is_changed) break;
      solve();
    }
  }

  [[nodiscard]] Alignment alignment() const {
    const auto largest =
        static_cast<std::size_t>(std::ranges::max_element(sums_, {}, [](const PieceSums& sums) { return sums.weight; }) - sums_.begin());
    const double factor = variance_factor();
    Alignment alignment{.offset_s = sums_[largest].mean_late_s,
                        .offset_sd_s = std::sqrt(factor / sums_[largest].weight),
                        .reference_s = sums_[largest].mean_b_s,
                        .event_count = used_count()};
    const double drift_sd_ppm = 1e6 * std::sqrt(factor / spread_);
    if (has_drift() && drift_sd_ppm < kVaguestDriftPpm) {
      alignment.drift_ppm = 1e6 * drift_;
      alignment.drift_sd_ppm = drift_sd_ppm;
    }
    if (sums_.size() == 1) return alignment;
    for (const PieceSums& sums : sums_) {
      const double at_reference_s = sums.mean_late_s - drift_ * (sums.mean_b_s - alignment.reference_s);
      const bool is_known = sums.weight > 0.0;
      if (!is_known) {
        constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
        alignment.pieces.push_back({.shift_s = kUnknown, .shift_sd_s = kUnknown, .reference_s = kUnknown, .sd_s = kUnknown});
        continue;
      }
      const double by_drift_s = has_drift() ? std::sqrt(factor / spread_) * (sums.mean_b_s - alignment.reference_s) : 0.0;
      const double sd_s = std::sqrt(factor / sums.weight);
      const bool is_reference = &sums == &sums_[largest];
      alignment.pieces.push_back({.shift_s = at_reference_s - alignment.offset_s,
                                  .shift_sd_s = is_reference ? 0.0 : std::hypot(sd_s, alignment.offset_sd_s, by_drift_s),
                                  .reference_s = sums.mean_b_s,
                                  .sd_s = sd_s});
    }
    return alignment;
  }

  [[nodiscard]] std::vector<double> late_s() const {
    std::vector<double> late;
    for (const PieceSums& sums : sums_) late.push_back(sums.weight > 0.0 ? sums.mean_late_s : std::numeric_limits<double>::quiet_NaN());
    return late;
  }

 private:
  [[nodiscard]] std::size_t used_count() const { return static_cast<std::size_t>(std::ranges::count(used_, true)); }
  [[nodiscard]] double weight(std::size_t k) const { return 1.0 / (readings_[k].sd_s * readings_[k].sd_s); }
  [[nodiscard]] bool has_drift() const { return spread_ > 0.0; }
  [[nodiscard]] double residual_s(std::size_t k) const {
    const PieceSums& sums = sums_[piece_of_[k]];
    return readings_[k].late_s - sums.mean_late_s - drift_ * (readings_[k].b_s - sums.mean_b_s);
  }

  void set_medians() {
    std::vector<double> slopes;
    const std::size_t half = readings_.size() / 2;
    for (std::size_t k = 0; k + half < readings_.size(); ++k) {
      const ClockReading& from = readings_[k];
      const ClockReading& to = readings_[k + half];
      if (piece_of_[k] == piece_of_[k + half] && to.b_s > from.b_s) slopes.push_back((to.late_s - from.late_s) / (to.b_s - from.b_s));
    }
    drift_ = slopes.empty() ? 0.0 : median(std::move(slopes));
    for (std::size_t piece = 0; piece < sums_.size(); ++piece) {
      std::vector<double> lates;
      for (std::size_t k = 0; k < readings_.size(); ++k) {
        if (piece_of_[k] == piece) lates.push_back(readings_[k].late_s - drift_ * readings_[k].b_s);
      }
      if (!lates.empty()) sums_[piece] = {.weight = 1.0, .mean_b_s = 0.0, .mean_late_s = median(std::move(lates))};
    }
  }

  bool leave_out_far_ones() {
    std::vector<double> sizes;
    for (std::size_t k = 0; k < readings_.size(); ++k) sizes.push_back(std::abs(residual_s(k)) / readings_[k].sd_s);
    const double limit = kOutlierSd * std::max(1.0, kMadToSd * median(sizes));
    bool is_changed = false;
    for (std::size_t k = 0; k < sizes.size(); ++k) {
      const bool is_used = sizes[k] <= limit;
      is_changed = is_changed || is_used != used_[k];
      used_[k] = is_used;
    }
    return is_changed;
  }

  void solve() {
    sums_.assign(sums_.size(), PieceSums());
    for (std::size_t k = 0; k < readings_.size(); ++k) {
      if (!used_[k]) continue;
      PieceSums& sums = sums_[piece_of_[k]];
      sums.weight += weight(k);
      sums.mean_b_s += weight(k) / sums.weight * (readings_[k].b_s - sums.mean_b_s);
      sums.mean_late_s += weight(k) / sums.weight * (readings_[k].late_s - sums.mean_late_s);
    }
    spread_ = 0.0;
    double product = 0.0;
    for (std::size_t k = 0; k < readings_.size(); ++k) {
      if (!used_[k]) continue;
      const PieceSums& sums = sums_[piece_of_[k]];
      const double from_mean_s = readings_[k].b_s - sums.mean_b_s;
      spread_ += weight(k) * from_mean_s * from_mean_s;
      product += weight(k) * from_mean_s * (readings_[k].late_s - sums.mean_late_s);
    }
    drift_ = has_drift() ? product / spread_ : 0.0;
  }

  /// Returns by how much the variances exceed those of independent readings with the given standard deviations.
  [[nodiscard]] double variance_factor() const {
    std::vector<double> residuals;
    for (std::size_t k = 0; k < readings_.size(); ++k) {
      if (used_[k]) residuals.push_back(residual_s(k) / readings_[k].sd_s);
    }
    const auto count = static_cast<double>(residuals.size());
    const double unknowns =
        static_cast<double>(std::ranges::count_if(sums_, [](const PieceSums& sums) { return sums.weight > 0.0; })) + 1.0;
    double squares = 0.0;
    for (const double residual : residuals) squares += residual * residual;
    double factor = count > unknowns ? std::max(1.0, squares / (count - unknowns)) : 1.0;
    if (residuals.size() < kFewestForBatches) return factor;
    // Neighbouring residuals may be alike (rounding while the clocks drift slowly): means of batches then scatter more.
    const std::size_t size = residuals.size() / kBatches;
    double batches = 0.0;
    for (std::size_t batch = 0; batch < kBatches; ++batch) {
      double sum = 0.0;
      for (const double residual : std::span(residuals).subspan(batch * size, size)) sum += residual;
      batches += sum * sum / static_cast<double>(size) / static_cast<double>(kBatches - 2);
    }
    return std::max(factor, batches);
  }

  const std::vector<ClockReading>& readings_;
  const std::vector<std::size_t>& piece_of_;
  std::vector<bool> used_;
  std::vector<PieceSums> sums_;
  double drift_ = 0.0;
  double spread_ = 0.0;
};

}  // namespace

core::Result<Alignment> fit_clocks(const std::vector<ClockReading>& readings, const Restarts& restarts) {
  if (readings.empty()) return core::fail(core::ErrorCode::Failed, "the recordings have no common event");
  if (restarts.piece_count() > kMostPieces) {
    return core::fail(core::ErrorCode::LimitExceeded, "the recordings have more than " + std::to_string(kMostPieces) + " gaps",
                      "export the part without gaps as CSV and compare that");
  }
  std::vector<std::size_t> piece_of;
  for (const ClockReading& reading : readings) piece_of.push_back(restarts.piece_at(reading.b_s + reading.late_s, reading.b_s));
  ClockLine fit(readings, piece_of, restarts.piece_count());
  fit.run();
  Alignment alignment = fit.alignment();
  const std::vector<double> starts_s = restarts.starts_on_b_s(fit.late_s());
  for (std::size_t piece = 0; piece < alignment.pieces.size(); ++piece) {
    alignment.pieces[piece].from_s = piece == 0 ? -std::numeric_limits<double>::infinity() : starts_s[piece - 1];
  }
  return alignment;
}

std::size_t Restarts::piece_at(double a_s, double b_s) const noexcept {
  const auto passed = [](const std::vector<double>& restarts_s, double at_s) {
    return static_cast<std::size_t>(std::ranges::upper_bound(restarts_s, at_s) - restarts_s.begin());
  };
  return passed(a_s_, a_s) + passed(b_s_, b_s);
}

std::vector<double> Restarts::starts_on_b_s(const std::vector<double>& late_s) const {
  std::vector<double> starts;
  std::size_t i = 0;
  std::size_t j = 0;
  double known_s = 0.0;
  for (const double late : late_s) {
    if (!std::isfinite(late)) continue;
    known_s = late;
    break;
  }
  while (i < a_s_.size() || j < b_s_.size()) {
    const double next_late_s = late_s[i + j + 1];
    if (std::isfinite(next_late_s)) known_s = next_late_s;
    const double of_a_s = i < a_s_.size() ? a_s_[i] - known_s : std::numeric_limits<double>::infinity();
    const double of_b_s = j < b_s_.size() ? b_s_[j] : std::numeric_limits<double>::infinity();
    of_a_s < of_b_s ? ++i : ++j;
    starts.push_back(std::max(std::min(of_a_s, of_b_s), starts.empty() ? -std::numeric_limits<double>::infinity() : starts.back()));
  }
  return starts;
}

}  // namespace dts::lab::compare
