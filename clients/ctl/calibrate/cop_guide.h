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

/// What the guide works with; all of it outlives the guide.
struct GuideParts {
  const PlateView& plate;
  const std::vector<PlannedPoint>& points;
  Measurer& measurer;
  ProgressFile& progress;
  const std::optional<Answer>* typed = nullptr;  ///< Why the person stopped the measurer.
  const Prompt* prompt = nullptr;                ///< nullptr: a new load after a lift-off is the next point.
  bool draws = false;                            ///< Shows a picture of the plate at each point.
  std::function<void(const std::string&)> say;
  std::function<std::optional<double>()> estimated_load_n{};  ///< What the daemon takes the load on the plate for; may be empty.
};

/// Leads a person with a weight from point to point: where to put it, wait for rest, what was read, next. A point where the plate
/// bends on the wrong side is asked for again.
class CopGuide {
 public:
  explicit CopGuide(GuideParts parts) : parts_(std::move(parts)), is_skipped_(parts_.points.size(), false) {}

  /// Measures what is missing of the first `end` points, but for those that the person skips. False: the person quit; what was measured
  /// is kept. Points of an earlier call are not asked for again.
  [[nodiscard]] client::Result<bool> measure_until(std::size_t end);

 private:
  /// Records the point unless it contradicts its place. Quit or Skip: the person typed that meanwhile.
  [[nodiscard]] client::Result<Answer> measure(std::size_t index);
  /// Redo: forgets the point of that number, or the last one.
  [[nodiscard]] client::Result<void> forget(std::optional<std::size_t> number);
  [[nodiscard]] std::size_t next() const;
  /// What the person answers before a point, or types while it is measured.
  [[nodiscard]] client::Result<bool> go_on(const Reply& reply, std::size_t index);
  void announce(std::size_t index) const;
  void report(std::size_t index, const SteadyReading& reading) const;
  /// Says, once for each load, when the daemon takes the weight for something else: the wrong weight, or kilograms.
  void doubt_weight(double load_n);

  GuideParts parts_;
  std::size_t begin_ = 0;            ///< What is before it was settled by an earlier call.
  std::optional<std::size_t> last_;  ///< The last point measured in this run, for redo.
  std::vector<bool> is_skipped_;
  std::set<double> doubted_loads_n_;
};

/// Whether a load lies on the plate: the deflections' sum, mm, is beyond what an empty plate shows.
[[nodiscard]] bool is_loaded(std::span<const double> deflection_mm) noexcept;
/// "the plate looks empty: the deflections' sum is 0.02 mm"
[[nodiscard]] std::string load_text(std::span<const double> deflection_mm);

}  // namespace dts::ctl
