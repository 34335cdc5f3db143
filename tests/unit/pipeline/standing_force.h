// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "pipeline/fault.h"
#include "pipeline/stages/force_stream.h"
#include "unit/pipeline/standing_signal.h"

namespace dts::pipeline {

/// A Kistler 9281EA: 25 N/V in the shear channels, 250 N/V in the vertical ones; AP is the plate's -y.
inline physics::ForcePlateModel kistler_plate() {
  return {
      .plate = physics::ForcePlate::create(
                   physics::KistlerPlate{.newtons_per_unit = {25, 25, 25, 25, 250, 250, 250, 250}, .a_mm = 120, .b_mm = 200, .az0_mm = -48})
                   .value(),
      .channel_names = {"fx12", "fx34", "fy14", "fy23", "fz1", "fz2", "fz3", "fz4"},
      .mounting = {.ml = physics::PlateAxis::PlusX, .ap = physics::PlateAxis::MinusY, .is_z_down = true},
      .tare_v = std::vector<double>(8, 0.0)};
}

/// Four load cells of 100 N/V at (+-200, +-150) mm; the person's right is x, forward is y.
inline physics::ForcePlateModel cell_plate() {
  const physics::LoadCellPlate cells{.cells = {{200, 150, 100}, {-200, 150, 100}, {-200, -150, 100}, {200, -150, 100}}};
  return {.plate = physics::ForcePlate::create(cells).value(),
          .channel_names = {"cell1", "cell2", "cell3", "cell4"},
          .mounting = {.ml = physics::PlateAxis::PlusX, .ap = physics::PlateAxis::PlusY, .is_z_down = false},
          .tare_v = std::vector<double>(4, 0.0)};
}

/// The surface is 400 x 600 mm.
inline physics::RigModel with_force_plate(physics::ForcePlateModel plate) {
  physics::RigModel rig;
  rig.plate.a = {400.0};
  rig.plate.b = {600.0};
  rig.force_plate = std::move(plate);
  return rig;
}

/// Somebody of 490 N who sways on `kistler_plate`: volts with noise in steps of 5 mV. With faults: nobody from scan 200 to 450, while the
/// zero drifts by 3 N/s; 0.8 s of 18 N at both ends, between the two thresholds of the contact; lost values and doubts of the device. The
/// first scan is faulty, so that no tare succeeds.
inline Signal standing_force_volts(std::size_t scans, std::uint64_t seed, Faults faults) {
  constexpr std::size_t kEndScans = 80;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<std::vector<double>> columns(8, std::vector<double>(scans));
  Signal signal = make_signal(100.0, "V", columns);
  double x_mm = 10.0;
  double y_mm = -20.0;
  for (std::size_t i = 0; i < scans; ++i) {
    const bool is_end = faults == Faults::Some && (i < kEndScans || i + kEndScans >= scans);
    const bool is_empty = faults == Faults::Some && i >= 200 && i < 450;
    x_mm = std::clamp(x_mm + 0.5 * noise(random), -60.0, 60.0);
    y_mm = std::clamp(y_mm + 0.5 * noise(random), -60.0, 60.0);
    const double load_n = is_end ? 18.0 : is_empty ? 0.03 * static_cast<double>(i - 200) : 490.0;
    const double shear_n = is_empty ? 0.0 : 2.0 * noise(random);
    const double across = x_mm / 120.0;
    const double along = y_mm / 200.0;
    const std::array<double, 8> newtons{shear_n,
                                        -shear_n,
                                        shear_n,
                                        0.5 * shear_n,
                                        0.25 * load_n * (1.0 + across) * (1.0 + along),
                                        0.25 * load_n * (1.0 - across) * (1.0 + along),
                                        0.25 * load_n * (1.0 - across) * (1.0 - along),
                                        0.25 * load_n * (1.0 + across) * (1.0 - along)};
    for (std::size_t c = 0; c < newtons.size(); ++c) {
      signal.values[c][i] = quantised_v(newtons[c] / (c < 4 ? 25.0 : 250.0) + 0.003 * noise(random));
    }
    if (faults == Faults::None || is_end || is_empty) continue;
    if (uniform(random) < 0.01) {
      for (auto& bits : signal.bits) bits[i] = core::quality::kRotation;
    }
    const std::size_t c = random() % 8;
    if (uniform(random) < 0.01) signal.values[c][i] = std::numeric_limits<double>::quiet_NaN();
    if (uniform(random) < 0.01) signal.bits[c][i] = core::quality::kRail;
  }
  if (faults == Faults::Some && scans > 0) signal.bits[1][0] = core::quality::kRotation;
  return signal;
}

/// The stream "force" of the same person.
inline Signal standing_force(std::size_t scans, std::uint64_t seed, Faults faults) {
  const Signal volts = standing_force_volts(scans, seed, faults);
  const physics::ForcePlateModel plate = kistler_plate();
  Signal signal = make_signal(100.0, "", std::vector<std::vector<double>>(6, std::vector<double>(scans)));
  signal.format.channels = force_channels(true);
  for (std::size_t i = 0; i < scans; ++i) {
    std::array<double, 8> channels{};
    std::uint8_t bits = 0;
    for (std::size_t c = 0; c < channels.size(); ++c) {
      channels[c] = volts.values[c][i];
      bits |= explained(channels[c], volts.bits[c][i]);
    }
    const auto [f, m] = physics::in_subject_frame(plate.plate.wrench(channels), plate.mounting);
    for (std::size_t c = 0; c < 3; ++c) {
      signal.values[c][i] = f.at(c);
      signal.values[c + 3][i] = m.at(c);
      signal.bits[c][i] = bits;
      signal.bits[c + 3][i] = bits;
    }
  }
  return signal;
}

}  // namespace dts::pipeline
