// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>

#include "core/special_numbers.h"
#include "unit/pipeline/standing_force.h"

namespace dts::pipeline {
namespace {

using core::kNaN;
using core::quality::kNoContact;
using core::quality::kOutOfRange;
using core::quality::kUncalibrated;
using core::quality::kUntared;
using testing::ElementsAre;
using Options = std::map<std::string, OptionValue, std::less<>>;

/// Scans of fx fy fz mx my mz.
Signal forces(const std::vector<std::array<double, 6>>& scans) {
  Signal signal = make_signal(100.0, "", std::vector<std::vector<double>>(6));
  signal.format.channels = force_channels(true);
  for (std::size_t c = 0; c < 6; ++c) {
    for (const auto& scan : scans) signal.values[c].push_back(scan.at(c));
    signal.bits[c].assign(scans.size(), 0);
  }
  return signal;
}

Output run(const Signal& signal, const Options& options = {}, physics::ForcePlateModel plate = kistler_plate()) {
  StageSurroundings surroundings(with_force_plate(std::move(plate)));
  return prepare_and_run(*surroundings.make({.id = "force_cop", .options = options}), signal);
}

/// 700 N at 30 mm to the right and 50 mm behind: Mx = y Fz, My = -x Fz.
constexpr std::array<double, 6> kStanding{7.0, -14.0, 700.0, -35.0, -21.0, 1.0};

TEST(ForceCopStage, ForceAndMoment_BecomeCentreOfPressureAndLoad) {
  const Output output = run(forces({kStanding}));

  EXPECT_NEAR(output.values[0][0], 30.0, 1e-12);
  EXPECT_NEAR(output.values[1][0], -50.0, 1e-12);
  EXPECT_EQ(output.values[2][0], 700.0);
  EXPECT_EQ(output.bits[0][0], 0);
}

TEST(ForceCopStage, OnTopOfAPlatform_TheLineOfTheForceIsFollowed) {
  const Output output = run(forces({kStanding}), {{"top_mm", 60.0}});

  EXPECT_NEAR(output.values[0][0], 30.0 + 60.0 * 7.0 / 700.0, 1e-12);
  EXPECT_NEAR(output.values[1][0], -50.0 - 60.0 * 14.0 / 700.0, 1e-12);
}

TEST(ForceCopStage, Contact_HasAThresholdAndAHysteresis) {
  const auto load = [](double fz) { return std::array<double, 6>{0, 0, fz, 0, 0, 0}; };

  const Output output = run(forces({load(19.9), load(20.0), load(16.0), load(15.9), load(19.9), load(-50.0)}));

  EXPECT_THAT(output.bits[0], ElementsAre(kNoContact, 0, 0, kNoContact, kNoContact, kNoContact));
  EXPECT_THAT(output.bits[2], ElementsAre(0, 0, 0, 0, 0, 0));
  EXPECT_TRUE(std::isnan(output.values[0][0]) && std::isnan(output.values[1][5]));
  EXPECT_EQ(output.values[2][5], -50.0);
}

TEST(ForceCopStage, AFault_HidesTheScanAndKeepsTheContact) {
  Signal signal = forces({kStanding, kStanding, {0, 0, 17.0, 0, 0, 0}});
  signal.values[4][1] = kNaN;
  signal.bits[4][1] = kOutOfRange;
  for (auto& bits : signal.bits) bits[2] = kUntared;

  const Output output = run(signal);

  for (std::size_t c = 0; c < 3; ++c) EXPECT_TRUE(std::isnan(output.values[c][1]));
  EXPECT_THAT(output.bits[2], ElementsAre(0, kOutOfRange, kUntared));
  EXPECT_THAT(output.bits[0], ElementsAre(0, kOutOfRange, kUntared));
}

TEST(ForceCopStage, OutsideTheSurface_TheValueIsDoubtful) {
  const auto at = [](double x_m, double y_m) { return std::array<double, 6>{0, 0, 100.0, 100.0 * y_m, -100.0 * x_m, 0}; };

  const Output output = run(forces({at(0.2, 0.3), at(0.201, 0.0), at(0.0, -0.301)}));

  EXPECT_THAT(output.bits[1], ElementsAre(0, kUncalibrated, kUncalibrated));
  EXPECT_NEAR(output.values[0][1], 201.0, 1e-9);
}

/// The polynomial of the 9281E: at (100, 150) mm of the plate, x is 4.269 mm too large (sheet on force plates, section 2).
TEST(ForceCopStage, TheMakersCorrection_AppliesInTheAxesOfThePlate) {
  physics::ForcePlateModel plate = kistler_plate();
  plate.polynomial.emplace();
  plate.polynomial->x = {7.92063e-15, -5.821e-10, -2.77102e-6, -1.76083e-10, 1.29695e-5, -0.0413979};
  const Output along_x = run(forces({{0, 0, 700.0, -0.150 * 700.0, -0.100 * 700.0, 0}}), {}, plate);  // ML = +x, AP = -y
  plate.mounting = {.ml = physics::PlateAxis::MinusY, .ap = physics::PlateAxis::MinusX, .is_z_down = true};
  const Output along_y = run(forces({{0, 0, 700.0, 0.100 * 700.0, 0.150 * 700.0, 0}}), {}, plate);  // plate (-100, 150)

  const double error_mm = 100.0 - along_x.values[0][0];
  EXPECT_NEAR(std::abs(error_mm), 4.269, 5e-4);
  EXPECT_NEAR(along_x.values[1][0], -150.0, 1e-9);
  EXPECT_NEAR(along_y.values[0][0], -150.0, 1e-9);
  EXPECT_NEAR(100.0 - along_y.values[1][0], error_mm, 1e-9);
}

TEST(ForceCopStage, LoadCells_GiveTheCentreInTheirPlane) {
  Signal signal = make_signal(100.0, "", {{500.0}, {15.0}, {-40.0}});
  signal.format.channels = force_channels(false);

  const Output output = run(signal, {}, cell_plate());

  EXPECT_NEAR(output.values[0][0], 80.0, 1e-9);
  EXPECT_NEAR(output.values[1][0], 30.0, 1e-9);
  EXPECT_EQ(output.values[2][0], 500.0);
}

}  // namespace
}  // namespace dts::pipeline
