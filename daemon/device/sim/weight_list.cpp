// SPDX-License-Identifier: Apache-2.0
#include "device/sim/weight_list.h"

#include "device/sim/csv_rows.h"

namespace dts::device::sim {
namespace {

constexpr CsvForm kWeightForm{.subject = "list of weights",
                              .header = "x_mm,y_mm,load_n",
                              .hint = "a list of weights is a CSV file with the header x_mm,y_mm,load_n; positions from the plate's centre",
                              .max_rows = kMaxWeights};
constexpr double kLeastN = 1.0;
constexpr double kMostN = 2000.0;

}  // namespace

core::Result<std::vector<Weight>> load_weights(const std::string& path, const physics::Plate& plate) {
  std::vector<Weight> weights;
  const auto add_row = [&](std::span<const double> row, const std::string& place) -> core::Status {
    const physics::Point position{plate.a / 2.0 + core::Millimetres{row[0]}, plate.b / 2.0 + core::Millimetres{row[1]}};
    const bool is_on_plate = position.x.value >= 0.0 && position.x <= plate.a && position.y.value >= 0.0 && position.y <= plate.b;
    if (!is_on_plate) {
      return refuse_row(kWeightForm, place,
                        "not on the plate; allowed: x_mm " + std::to_string(-plate.a.value / 2.0) + " .. " +
                            std::to_string(plate.a.value / 2.0) + ", y_mm " + std::to_string(-plate.b.value / 2.0) + " .. " +
                            std::to_string(plate.b.value / 2.0));
    }
    if (row[2] < kLeastN || row[2] > kMostN) return refuse_row(kWeightForm, place, "load_n is out of range; allowed: 1 .. 2000");
    weights.push_back({position, row[2]});
    return {};
  };
  DTS_TRY(read_csv(path, kWeightForm, add_row));
  return weights;
}

}  // namespace dts::device::sim
