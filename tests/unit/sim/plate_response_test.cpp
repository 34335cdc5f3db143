// SPDX-License-Identifier: Apache-2.0
#include "sim/plate_response.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace dts::sim {
namespace {

StandingMoment leaning() {
  StandingMoment moment{.ml_n = 4.0, .ap_n = -7.0};
  moment.contact.cop = {30.0, -20.0};
  moment.contact.load_n = 700.0;
  return moment;
}

physics::ForcePlateModel six_components() {
  physics::SixComponentPlate six;
  for (std::size_t i = 0; i < physics::kSixComponents; ++i) six.matrix.at(i).at(i) = 50.0;
  six.matrix[0][2] = 0.7;  // cross-talk that the maker has measured: part of the calibration
  return {.plate = *physics::ForcePlate::create(six), .channel_names = {}, .tare_v = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6}};
}

TEST(PlateResponse, SixComponents_MeanTheForceAboutTheSurfaceAndKeepTheTare) {
  const physics::ForcePlateModel model = six_components();
  std::vector<double> volts(6);

  PlateResponse(model, 60.0, {}).write_volts(leaning(), 10.0, volts);

  for (std::size_t i = 0; i < volts.size(); ++i) volts[i] -= model.tare_v[i];
  const physics::Wrench found = physics::in_subject_frame(model.plate.wrench(volts), model.mounting);
  EXPECT_NEAR(found.force_n[0], 4.0, 1e-9);
  EXPECT_NEAR(found.force_n[1], -7.0, 1e-9);
  EXPECT_NEAR(found.force_n[2], 700.0, 1e-9);
  EXPECT_NEAR(found.moment_nm[0], -0.020 * 700.0 + 0.060 * 7.0, 1e-9);  // y Fz - z Fy
  EXPECT_NEAR(found.moment_nm[1], 0.060 * 4.0 - 0.030 * 700.0, 1e-9);   // z Fx - x Fz
  EXPECT_NEAR(found.moment_nm[2], -0.030 * 7.0 + 0.020 * 4.0, 1e-9);    // x Fy - y Fx
}

TEST(PlateResponse, LoadCells_SeeTheCopInTheirPlane) {
  const physics::LoadCellPlate cells{.cells = {{200.0, 150.0, 100.0}, {-200.0, 150.0, 100.0}, {0.0, -150.0, 100.0}}};
  const physics::Mounting mounting{.ml = physics::PlateAxis::PlusX, .ap = physics::PlateAxis::PlusY, .is_z_down = false};
  const physics::ForcePlateModel model{
      .plate = *physics::ForcePlate::create(cells), .channel_names = {}, .mounting = mounting, .tare_v = {0.0, 0.0, 0.0}};
  std::vector<double> volts(3);

  PlateResponse(model, 50.0, {}).write_volts(leaning(), 0.0, volts);

  const physics::ForcePoint point = physics::force_point(physics::in_subject_frame(model.plate.wrench(volts), mounting));
  EXPECT_NEAR(point.x_mm, 30.0 - 50.0 * 4.0 / 700.0, 1e-9);  // off by height x shear / load
  EXPECT_NEAR(point.y_mm, -20.0 + 50.0 * 7.0 / 700.0, 1e-9);
}

TEST(PlateResponse, NobodyThere_OnlyTareAndDrift) {
  const physics::ForcePlateModel model = six_components();
  const PlateResponse response(model, 60.0, {.cross_talk = 0.02, .drift_n_per_s = 0.5, .seed = 3});
  std::vector<double> at_reset(6);
  std::vector<double> later(6);

  response.write_volts({}, 0.0, at_reset);
  response.write_volts({}, 20.0, later);

  EXPECT_EQ(at_reset, model.tare_v);
  for (std::size_t i = 0; i < later.size(); ++i) later[i] -= model.tare_v[i];
  EXPECT_NEAR(std::abs(model.plate.wrench(later).force_n[2]), 10.0, 1e-9);
}

}  // namespace
}  // namespace dts::sim
