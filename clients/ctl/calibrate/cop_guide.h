// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
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
  const Prompt* prompt = nullptr;  ///< nullptr: a new load after a lift-off is the next point.
  bool draws = false;              ///< Shows a picture of the plate at each point.
  std::function<void(const std::string&)> say;
};

/// Leads a person with a weight from point to point: where to put it, wait for rest, what was read, next. A point where the plate
/// bends on the wrong side is asked for again.
class CopGuide {
 public:
  explicit CopGuide(GuideParts parts) : parts_(std::move(parts)) {}

  /// Measures what is missing of the first `end` points. False: the person quit; what was measured is kept.
  [[nodiscard]] client::Result<bool> measure_until(std::size_t end);

 private:
  /// Records the point unless it contradicts its place.
  [[nodiscard]] client::Result<void> measure(std::size_t index);
  [[nodiscard]] client::Result<void> forget(std::size_t index);
  void announce(std::size_t index) const;
  void report(std::size_t index, const SteadyReading& reading) const;

  GuideParts parts_;
};

/// Whether a load lies on the plate: the deflections' sum, mm, is beyond what an empty plate shows.
[[nodiscard]] bool is_loaded(std::span<const double> deflection_mm) noexcept;

}  // namespace dts::ctl
