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

/// Finds the point load whose deflections in the plate model are closest to the measured ones: Gauss-Newton for position and load
/// (plate-model 5.3).
///
/// A stiffening plate is solved only at creation. A table over position and load stores how much less than in linear theory each sensor
/// deflects per newton; it is interpolated by cubics, because it is smooth. Immutable. Thread: any. Realtime-safe: `solve` yes, at most
/// `kMaxIterations` steps.
class CopInverse {
 public:
  static constexpr int kMaxIterations = 30;

  struct PointLoad {
    double x_mm = 0.0;
    double y_mm = 0.0;
    double load_n = 0.0;
  };

  /// Fails as the plate models fail.
  [[nodiscard]] static core::Result<std::shared_ptr<const CopInverse>> create(const ModelForm& form);

  /// `deflection_mm` must have one finite value per sensor.
  [[nodiscard]] PointLoad solve(std::span<const double> deflection_mm) const noexcept;

 private:
  CopInverse(InfluenceTable table, const ModelForm& form);
  [[nodiscard]] core::Status tabulate_stiffening(const ModelForm& form);

  /// Computes the deflection of every sensor per newton of a load, mm/N.
  void influence(const PointLoad& load, std::span<double> mm_per_n) const noexcept;
  /// Returns the sum of squares, mm^2.
  [[nodiscard]] double misfit(std::span<const double> deflection_mm, const PointLoad& load) const noexcept;
  /// Returns the load at the position of `load` that fits the deflections best, with the stiffening under `load`.
  [[nodiscard]] double best_load_n(std::span<const double> deflection_mm, const PointLoad& load) const noexcept;
  [[nodiscard]] PointLoad first_guess(std::span<const double> deflection_mm) const noexcept;
  /// Computes one step; returns `from` if no step improves the fit.
  [[nodiscard]] PointLoad improve(std::span<const double> deflection_mm, const PointLoad& from, double& damping) const noexcept;

  InfluenceTable table_;
  double a_mm_;
  double b_mm_;
  double heaviest_n_;
  std::vector<double> stiffening_mm_per_n_;  ///< Indexed by load, row, column and sensor; empty for a linear plate.
};

}  // namespace dts::physics
