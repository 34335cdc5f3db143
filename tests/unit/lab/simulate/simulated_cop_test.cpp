// SPDX-License-Identifier: Apache-2.0
#include "lab/simulate/simulated_cop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "files/rig_file.h"
#include "lab/simulate/simulated_rig.h"

namespace dts::lab::simulate {
namespace {

/// Returns what differs between both axes' series, about their means, over the last `scans`.
double rms_apart(const std::vector<double>& one, const std::vector<double>& other, std::size_t scans) {
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t i = one.size() - scans; i < one.size(); ++i) {
    sum += one[i] - other[i];
    squares += (one[i] - other[i]) * (one[i] - other[i]);
  }
  const auto count = static_cast<double>(scans);
  return std::sqrt(squares / count - (sum / count) * (sum / count));
}

std::string shipped(const std::string& file) {
  auto definition = files::rig_definition(DTS_SOURCE_DIR "/config/rigs/" + file);
  EXPECT_TRUE(definition.has_value()) << file;
  return definition ? *definition : "";
}

TEST(SimulatedCop, ShippedPairOfAStack_SeesTheSamePerson) {
  const auto floor = simulate_cop(shipped("floor-sim-stack.toml"), "floor", "sim:stack?seed=7&noise_mv=3", 20.0);
  const auto plate = simulate_cop(shipped("force-plate-sim-stack.toml"), "plate", "sim:stack?part=plate&seed=7", 20.0);
  ASSERT_TRUE(floor) << core::to_string(floor.error());
  ASSERT_TRUE(plate) << core::to_string(plate.error());
  ASSERT_EQ(floor->ml_mm.size(), 2000U);
  EXPECT_TRUE(std::isnan(plate->ml_mm[100]));  // nobody yet
  EXPECT_LT(rms_apart(floor->ml_mm, plate->ml_mm, 1200), 0.6);
  EXPECT_LT(rms_apart(floor->ap_mm, plate->ap_mm, 1200), 0.6);
}

TEST(SimulatedCop, FilterDelay_IsRemoved) {
  const std::string address = "sim:stack?seed=7&contact=one_foot&noise_mv=0&gap_spread_mm=0";
  std::string unfiltered = floor_definition(100.0);
  const std::string filter = "[[stage]]\nid = \"window_filter\"\nwindow_scans = 3\n\n";
  unfiltered.erase(unfiltered.find(filter), filter.size());
  const auto exact = simulate_cop(unfiltered, "floor", address, 20.0);
  const auto smooth = simulate_cop(floor_definition(100.0), "floor", address, 20.0);
  ASSERT_TRUE(exact && smooth);
  SimulatedCop late = *exact;
  std::rotate(late.ap_mm.rbegin(), late.ap_mm.rbegin() + 1, late.ap_mm.rend());
  EXPECT_LT(rms_apart(smooth->ap_mm, exact->ap_mm, 1200), 0.5 * rms_apart(smooth->ap_mm, late.ap_mm, 1200));
}

TEST(SimulatedCop, RigWithoutACentreOfPressure_IsRefused) {
  const std::string whole = force_plate_definition(100.0, 50.0);
  const auto refused =
      simulate_cop(whole.substr(0, whole.find("\n[[stage]]\nid = \"force_cop\"")), "half a plate", "sim:stack?part=plate", 1.0);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().what, "half a plate makes no stream \"cop\"");
}

}  // namespace
}  // namespace dts::lab::simulate
