// SPDX-License-Identifier: Apache-2.0
#include "accuracy/evaluation.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dts::accuracy {
namespace {

constexpr double kScanTolerance = 1e-6;  // 4.5 s and the rates have no exact product

/// Linear between the scans; NaN outside.
double at(const std::vector<double>& column, double scan) {
  const double before = std::floor(scan + kScanTolerance);
  if (before < 0.0 || before >= static_cast<double>(column.size())) return std::numeric_limits<double>::quiet_NaN();
  const auto index = static_cast<std::size_t>(before);
  const double part = scan - before;
  if (part < kScanTolerance) return column[index];
  if (index + 1 >= column.size()) return std::numeric_limits<double>::quiet_NaN();
  return column[index] + part * (column[index + 1] - column[index]);
}

std::size_t first_scan_of(double time_s, double rate_hz) { return static_cast<std::size_t>(std::ceil(time_s * rate_hz - kScanTolerance)); }

std::size_t last_scan_of(double time_s, double rate_hz) { return static_cast<std::size_t>(std::floor(time_s * rate_hz + kScanTolerance)); }

struct Sums {
  double published_n = 0.0;
  double true_n = 0.0;
};

void add_scan(const RigCapture& rig, std::size_t scan, Evaluation& result, Sums& load) {
  const auto& [ml, ap, load_n] = rig.cop.columns;
  if (scan >= rig.cop.size()) return;
  const double true_scan = (static_cast<double>(scan) / rig.cop.rate_hz - rig.cop.delay_s) * rig.truth.rate_hz;
  const double true_ml = at(rig.truth.columns[0], true_scan);
  const double true_ap = at(rig.truth.columns[1], true_scan);
  const double true_n = at(rig.truth.columns[2], true_scan);
  if (!std::isfinite(ml[scan] + ap[scan] + load_n[scan] + true_ml + true_ap + true_n)) return;
  result.published.ml_mm.push_back(ml[scan]);
  result.published.ap_mm.push_back(ap[scan]);
  result.truth.ml_mm.push_back(true_ml);
  result.truth.ap_mm.push_back(true_ap);
  result.doubts |= rig.cop.doubts[scan];
  load.published_n += load_n[scan];
  load.true_n += true_n;
}

}  // namespace

Evaluation evaluate(const Case& wanted, const RigCapture& rig) {
  Evaluation result;
  Sums load;
  result.rate_hz = rig.cop.rate_hz;
  result.lost_scans = rig.lost_on_the_way + rig.lost_before_pipeline;
  result.dropped_blocks = rig.dropped_blocks;
  const std::size_t first = first_scan_of(wanted.first_s + 2.0 * rig.cop.delay_s, rig.cop.rate_hz);
  const std::size_t last = last_scan_of(wanted.last_s, rig.cop.rate_hz);
  result.expected_scans = last >= first ? last - first + 1 : 0;
  for (std::size_t scan = first; scan <= last; ++scan) add_scan(rig, scan, result, load);
  result.compared_scans = result.truth.ml_mm.size();
  if (result.compared_scans == 0) return result;
  result.ml = compare(result.published.ml_mm, result.truth.ml_mm);
  result.ap = compare(result.published.ap_mm, result.truth.ap_mm);
  result.load_error = load.published_n / load.true_n - 1.0;
  return result;
}

double largest_truth_error_mm(const Case& wanted, const RigCapture& rig, const RecordingFile& recording) {
  const double rate_hz = rig.truth.rate_hz;
  double largest = 0.0;
  for (std::size_t scan = first_scan_of(wanted.first_s, rate_hz); scan <= last_scan_of(wanted.last_s, rate_hz); ++scan) {
    const double time_s = static_cast<double>(scan) / rate_hz - wanted.first_s;
    const double ml = std::abs(at(rig.truth.columns[0], static_cast<double>(scan)) - recording.ml_mm_at(time_s));
    const double ap = std::abs(at(rig.truth.columns[1], static_cast<double>(scan)) - recording.ap_mm_at(time_s));
    if (!std::isfinite(ml + ap)) return std::numeric_limits<double>::infinity();
    largest = std::max({largest, ml, ap});
  }
  return largest;
}

}  // namespace dts::accuracy
