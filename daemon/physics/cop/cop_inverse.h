// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "core/result.h"
#include "physics/cop/cop_form.h"
#include "physics/plate/influence_table.h"

namespace dts::physics {

/// Finds the point load that bends the plate model most nearly as measured: Gauss-Newton for position and load (plate-model 5.3).
///
/// A stiffening plate is bent once, when this is made: how much less than linear theory says every sensor goes down per newton is
/// tabulated over position and load, and interpolated by cubics, as it is smooth. Immutable. Thread: any. Realtime-safe: `solve` yes, at
/// most `kMaxIterations` steps.
class CopInverse {
 public:
  static constexpr int kMaxIterations = 30;

  struct PointLoad {
    double x_mm = 0.0;
    double y_mm = 0.0;
    double load_n = 0.0;
  };

  /// Fails as the plate models do.
  [[nodiscard]] static core::Result<std::shared_ptr<const CopInverse>> create(const ModelForm& form);

  /// As many deflections as sensors, all finite.
  [[nodiscard]] PointLoad solve(std::span<const double> deflection_mm) const noexcept;

 private:
  CopInverse(InfluenceTable table, const ModelForm& form);
  [[nodiscard]] core::Status tabulate_stiffening(const ModelForm& form);

  /// Deflection of every sensor per newton of a load, mm/N.
  void influence(const PointLoad& load, std::span<double> mm_per_n) const noexcept;
  /// Sum of squares, mm^2.
  [[nodiscard]] double misfit(std::span<const double> deflection_mm, const PointLoad& load) const noexcept;
  /// The load at its position that explains the deflections best, stiffened as under `load`.
  [[nodiscard]] double best_load_n(std::span<const double> deflection_mm, const PointLoad& load) const noexcept;
  [[nodiscard]] PointLoad first_guess(std::span<const double> deflection_mm) const noexcept;
  /// One step; equal to `from` when it would lead nowhere better.
  [[nodiscard]] PointLoad improve(std::span<const double> deflection_mm, const PointLoad& from, double& damping) const noexcept;

  InfluenceTable table_;
  double a_mm_;
  double b_mm_;
  double heaviest_n_;
  std::vector<double> stiffening_mm_per_n_;  ///< By load, row, column and sensor; empty for a linear plate.
};

}  // namespace dts::physics
