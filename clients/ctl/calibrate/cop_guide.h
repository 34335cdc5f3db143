// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ctl/calibrate/measure.h"
#include "ctl/calibrate/plan.h"
#include "ctl/calibrate/progress_file.h"
#include "ctl/calibrate/prompt.h"

namespace dts::ctl {

/// The parts that the guide uses; all of them must outlive the guide.
struct GuideParts {
  const PlateView& plate;
  const std::vector<PlannedPoint>& points;
  Measurer& measurer;
  ProgressFile& progress;
  const std::optional<Answer>* typed = nullptr;  ///< The person's command that stopped the measurer.
  const Prompt* prompt = nullptr;                ///< nullptr: every new load after an empty plate is the next point.
  bool draws = false;                            ///< Shows a picture of the plate at each point.
  std::function<void(const std::string&)> say;
  std::function<std::optional<double>()> estimated_load_n{};  ///< Returns the daemon's estimate of the load on the plate; may be empty.
};

/// Guides a person with a weight from point to point: shows the place, waits until the load is steady, reports the reading. Repeats a point
/// if the plate bends on the wrong side.
class CopGuide {
 public:
  explicit CopGuide(GuideParts parts) : parts_(std::move(parts)), is_skipped_(parts_.points.size(), false) {}

  /// Measures the missing ones of the first `end` points, except those that the person skips. Returns false if the person quit; measured
  /// points are kept. Does not repeat points of an earlier call.
  [[nodiscard]] client::Result<bool> measure_until(std::size_t end);

 private:
  /// Records the point unless the reading contradicts its place. Returns Quit or Skip if the person typed that meanwhile.
  [[nodiscard]] client::Result<Answer> measure(std::size_t index);
  /// Deletes the point of that number, or the last one, so that it is measured again.
  [[nodiscard]] client::Result<void> forget(std::optional<std::size_t> number);
  [[nodiscard]] std::size_t next() const;
  /// Executes the person's answer before a point. Returns true if the point is to be measured now.
  [[nodiscard]] client::Result<bool> go_on(const Reply& reply, std::size_t index);
  void announce(std::size_t index) const;
  void report(std::size_t index, const SteadyReading& reading) const;
  /// Warns, once for each load, if the daemon's estimate differs much from the weight: a wrong weight, or kilograms instead of newtons.
  void doubt_weight(double load_n);

  GuideParts parts_;
  std::size_t begin_ = 0;            ///< First point of this call; earlier points belong to earlier calls.
  std::optional<std::size_t> last_;  ///< The last point measured in this call, for redo.
  std::vector<bool> is_skipped_;
  std::set<double> doubted_loads_n_;
};

/// Returns true if a load is on the plate: the sum of the deflections, mm, is larger than on an empty plate.
[[nodiscard]] bool is_loaded(std::span<const double> deflection_mm) noexcept;
/// Returns "the plate looks empty: the deflections' sum is 0.02 mm".
[[nodiscard]] std::string load_text(std::span<const double> deflection_mm);

}  // namespace dts::ctl
