// SPDX-License-Identifier: Apache-2.0
#include "physics/plate/influence_table.h"

#include <string>
#include <utility>

#include "physics/conversions.h"
#include "physics/plate/supported_plate.h"

namespace dts::physics {
namespace {}  // namespace

core::Result<InfluenceTable> InfluenceTable::create(const Plate& plate, const Support& support, std::span<const Point> probes,
                                                    int divisions) {
  for (const auto& status :
       {check_plate(plate), check_support(plate, support), check_divisions(divisions, Grid::kMinDivisions, Grid::kMaxDivisions)}) {
    if (!status) return tl::make_unexpected(status.error());
  }
  if (probes.empty()) return core::fail(core::ErrorCode::InvalidArgument, "there is no probe", "add at least one sensor position");
  for (std::size_t k = 0; k < probes.size(); ++k) {
    DTS_TRY(check_on_plate(plate, probes[k], "probe " + std::to_string(k)));
  }
  DTS_TRY_ASSIGN(const auto supported, SupportedPlate::create(make_fdm(plate, support, divisions), plate, support));
  InfluenceTable table;
  table.rows_ = GridFields(supported.discretisation().grid());
  for (const Point& probe : probes) {
    // By reciprocity, the field of deflections under 1 N at the probe is the deflection of the probe under 1 N at any point.
    const Eigen::VectorXd row =
        kMillimetresPerMetre * supported.bend(supported.vector(supported.discretisation().force({.centre = probe})));
    table.rows_.add({row.begin(), row.end()});
  }
  return table;
}

}  // namespace dts::physics
