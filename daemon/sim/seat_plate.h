// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "core/result.h"
#include "physics/plate/plate.h"
#include "sim/seat_load.h"

namespace dts::sim {

/// Where a body touches the seat (reach-model section 4).
struct SeatContact {
  double off_centre_mm = 0.0;  ///< Centre of the patch to the right of the plate's centre line.
  double width_mm = 240.0;
  double depth_mm = 200.0;
};

/// Deflection of a chair's plate at its sensors, tabulated over the depth at which the body sits; no plate is solved after creation. Uses
/// Navier's series if all edges are simply supported, else InfluenceTable's finite differences. The frame carries the part of the load
/// beyond an edge. Const methods: Thread: any. Realtime-safe: yes.
class SeatPlate {
 public:
  static constexpr double kStepMm = 1.0;

  /// Fails with InvalidArgument if the plate, the support, a probe or the contact is invalid.
  [[nodiscard]] static core::Result<SeatPlate> create(const physics::Plate& plate, const physics::Support& support,
                                                      std::span<const physics::Point> probes, const SeatContact& contact);

  [[nodiscard]] std::size_t probe_count() const noexcept { return uniform_mm_per_n_.size(); }
  /// `mm` must have one element per probe.
  void deflect(const SeatLoad& load, std::span<double> mm) const noexcept;

 private:
  SeatPlate() = default;
  void tabulate_series(const physics::Plate& plate, std::span<const physics::Point> probes, const SeatContact& contact);
  core::Status tabulate_grid(const physics::Plate& plate, const physics::Support& support, std::span<const physics::Point> probes,
                             const SeatContact& contact);

  double first_mm_ = 0.0;         ///< Depth of row 0: the patch only just misses the plate.
  std::size_t rows_ = 0;          ///< One per kStepMm.
  std::vector<double> mm_per_n_;  ///< One per row and probe, row by row.
  std::vector<double> uniform_mm_per_n_;
};

}  // namespace dts::sim
