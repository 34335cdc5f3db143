// SPDX-License-Identifier: Apache-2.0
// Known loads on force plates of three kinds, as voltages at the inputs of an emulated USB DAQ, through the normal dtsd.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <vector>

#include "usb/host_program/emulator_process.h"

namespace dts::emulator {
namespace {

using test::eventually;

constexpr double kSettleS = 0.3;        // what was on its way when the load changed
constexpr std::size_t kScans = 100;     // of one mean
constexpr double kFullScaleN = 5000.0;  // vertical; the shear channels have a tenth of it

/// The reaction on the person in the subject's frame, the point where it acts, and the free moment.
struct Load {
  double fx_n = 0.0;
  double fy_n = 0.0;
  double fz_n = 0.0;
  double ml_mm = 0.0;
  double ap_mm = 0.0;
  double tz_nm = 0.0;
};

/// The action about the origin of the transducer, in a plate whose x is ML, whose -y is AP and whose z points down; `surface_m`: centre of
/// the surface, seen from there.
std::array<double, 6> action(const Load& load, const std::array<double, 3>& surface_m) {
  const double fx = -load.fx_n;
  const double fy = load.fy_n;
  const double fz = load.fz_n;
  const double x = surface_m[0] + load.ml_mm / 1000.0;
  const double y = surface_m[1] - load.ap_mm / 1000.0;
  const double z = surface_m[2];
  return {fx, fy, fz, y * fz - z * fy, z * fx - x * fz, x * fy - y * fx + load.tz_nm};
}

std::string list_of(const std::vector<double>& values) {
  std::ostringstream text;
  text.precision(17);
  for (std::size_t i = 0; i < values.size(); ++i) text << (i == 0 ? "[" : ", ") << values[i];
  return text.str() + "]";
}

std::string rig_text(const std::string& table, const std::string& guard = "") {
  return "kind = \"floor\"\n[force_plate]\n" + table + "[acquire]\nrate_hz = 200.0\n[[stage]]\nid = \"guard\"\n" + guard +
         "[[stage]]\nid = \"force_plate\"\n[[stage]]\nid = \"force_cop\"\n[[stage]]\nid = \"steadiness\"\n";
}

const std::string kMounting = "ml = \"+x\"\nap = \"-y\"\nsize_mm = [400, 600]\n";

/// A 9281EA at 5 kN: the inverse of Kistler's formulae.
struct Kistler {
  static constexpr std::size_t kChannels = 8;
  static constexpr bool kHasShear = true;
  const std::vector<double> mv_per_n{38.117, 37.723, 38.062, 38.008, 3.898, 3.889, 3.885, 3.891};

  [[nodiscard]] std::string table() const {
    return "kind = \"kistler8\"\nscale_mv_per_n = " + list_of(mv_per_n) + "\na_mm = 120\nb_mm = 200\naz0_mm = -48\n" + kMounting;
  }
  [[nodiscard]] std::vector<double> volts(const Load& load) const {
    const double a = 0.120;
    const double b = 0.200;
    const auto [fx, fy, fz, mx, my, mz] = action(load, {0, 0, -0.048});
    // Two fifths of the moment about z come from the channels along x, so that no two channels are equal.
    std::vector<double> channels{fx / 2 - 0.4 * mz / (2 * b),          fx / 2 + 0.4 * mz / (2 * b),
                                 fy / 2 + 0.6 * mz / (2 * a),          fy / 2 - 0.6 * mz / (2 * a),
                                 fz / 4 + mx / (4 * b) - my / (4 * a), fz / 4 + mx / (4 * b) + my / (4 * a),
                                 fz / 4 - mx / (4 * b) + my / (4 * a), fz / 4 - mx / (4 * b) - my / (4 * a)};
    for (std::size_t c = 0; c < kChannels; ++c) channels[c] *= mv_per_n[c] / 1000.0;
    return channels;
  }
};

/// A plate with cross-talk at 5 kN: its sensitivity is known, so the volts need no inverse.
struct SixComponents {
  static constexpr std::size_t kChannels = 6;
  static constexpr bool kHasShear = true;
  static constexpr double kExcitationV = 10.0;
  static constexpr double kGain = 1000.0;
  /// uV/(V N) and uV/(V N m); rows are channels.
  const std::array<std::array<double, 6>, 6> sensitivity{{{0.655, 0.006, -0.003, 0.010, 0.002, -0.004},
                                                          {-0.008, 0.650, 0.004, -0.012, 0.006, 0.003},
                                                          {0.001, -0.002, 0.167, 0.004, -0.003, 0.001},
                                                          {0.002, 0.016, -0.001, 1.348, 0.011, -0.007},
                                                          {-0.014, 0.003, 0.002, -0.009, 1.352, 0.008},
                                                          {0.004, -0.005, 0.001, 0.012, -0.006, 2.552}}};

  [[nodiscard]] std::string table() const {
    std::string rows;
    for (const auto& row : sensitivity) rows += (rows.empty() ? "[" : ", ") + list_of({row.begin(), row.end()});
    return "kind = \"six_component\"\nsensitivity = " + rows + "]\nexcitation_v = " + list_of(std::vector<double>(6, kExcitationV)) +
           "\ngain = " + list_of(std::vector<double>(6, kGain)) + "\nsurface_mm = [1.5, -2.5, -40]\n" + kMounting;
  }
  [[nodiscard]] std::vector<double> volts(const Load& load) const {
    const auto loads = action(load, {0.0015, -0.0025, -0.040});
    std::vector<double> channels;
    for (const auto& row : sensitivity) {
      double microvolts_per_volt = 0.0;
      for (std::size_t c = 0; c < row.size(); ++c) microvolts_per_volt += row.at(c) * loads.at(c);
      channels.push_back(microvolts_per_volt * 1e-6 * kExcitationV * kGain);
    }
    return channels;
  }
};

/// Four cells at (+-200, +-150) mm with 125 N/V: 5 kN in all at 10 V. x is ML, y is AP, z points up.
struct LoadCells {
  static constexpr std::size_t kChannels = 4;
  static constexpr bool kHasShear = false;

  [[nodiscard]] static std::string table() {
    return "kind = \"load_cells\"\nposition_mm = [[200, 150], [-200, 150], [-200, -150], [200, -150]]\nscale_n_per_v = [125, 125, 125, "
           "125]\n"
           "axes = \"z_up\"\nml = \"+x\"\nap = \"+y\"\nsize_mm = [450, 350]\n";
  }
  [[nodiscard]] static std::vector<double> volts(const Load& load) {
    std::vector<double> channels;
    for (const auto& [x, y] : {std::pair{200.0, 150.0}, {-200.0, 150.0}, {-200.0, -150.0}, {200.0, -150.0}}) {
      channels.push_back(load.fz_n / 4.0 * (1.0 + load.ml_mm / x) * (1.0 + load.ap_mm / y) / 125.0);
    }
    return channels;
  }
};

struct Measured {
  std::vector<double> force;  ///< Means of floor/force.
  std::array<double, 3> cop{};
  std::size_t force_scans = 0;
  std::size_t cop_scans = 0;
};

std::int64_t monotonic_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string hold_command(const std::vector<double>& volts) {
  std::ostringstream command;
  command.precision(12);
  command << "hold";
  for (const double value : volts) command << ' ' << value;
  return command.str();
}

/// Holds the load on the plate, whose empty channels read `zero_v`, and returns the means of what dtsd publishes.
template <class Plate>
Measured measure(EmulatorProcess& emulator, client::Subscriber& subscriber, const Plate& plate, const Load& load, double zero_v) {
  std::vector<double> held = plate.volts(load);
  for (double& volts : held) volts += zero_v;
  EXPECT_EQ(emulator.ask(hold_command(held)), "ok");
  const std::int64_t from_ns = monotonic_ns() + static_cast<std::int64_t>(kSettleS * 1e9);
  Measured sums;
  sums.force.resize(Plate::kHasShear ? 6 : 3);
  const auto add = [&](const client::Block& block) {
    if (block.host_time_ns < from_ns) return;
    const bool is_cop = block.stream == "cop";
    EXPECT_EQ(block.channel_count(), is_cop ? 3U : sums.force.size());
    for (std::size_t c = 0; c < std::min(block.channel_count(), is_cop ? std::size_t{3} : sums.force.size()); ++c) {
      for (const float value : block.column(c)) (is_cop ? sums.cop.at(c) : sums.force.at(c)) += static_cast<double>(value);
      EXPECT_EQ(block.quality[c], 0) << block.topic;
    }
    (is_cop ? sums.cop_scans : sums.force_scans) += block.scan_count;
  };
  EXPECT_TRUE(eventually([&] {
    for (auto message = subscriber.receive(std::chrono::milliseconds(20)); message && message->has_value();
         message = subscriber.receive(std::chrono::milliseconds(0))) {
      if (const auto* block = std::get_if<client::Block>(&**message)) add(*block);
    }
    return sums.cop_scans >= kScans && sums.force_scans >= kScans;
  })) << emulator.log();
  for (double& value : sums.force) value /= static_cast<double>(sums.force_scans);
  for (double& value : sums.cop) value /= static_cast<double>(sums.cop_scans);
  return sums;
}

/// The largest errors over all loads.
struct Errors {
  double vertical_n = 0.0;
  double shear_n = 0.0;
  double cop_200_mm = 0.0;
  double cop_700_mm = 0.0;
};

void widen(double& largest, double error) { largest = std::max(largest, std::abs(error)); }

template <class Plate>
Errors errors_of(const std::string& daq, const std::string& guard = "") {
  const Plate plate;
  constexpr double kZeroV = 0.0123;
  std::string channels;
  for (std::size_t c = 0; c < Plate::kChannels; ++c) channels += (c == 0 ? "" : ",") + std::to_string(c);
  EmulatorProcess emulator(
      {.daq = daq, .uri = "mcc:" + daq + "?channels=" + channels, .scene = "hold", .rig_text = rig_text(plate.table(), guard)});
  EXPECT_TRUE(eventually([&] { return emulator.is_streaming(); })) << emulator.log();
  auto subscriber = emulator.subscribe({"floor/force", "floor/cop"});
  const auto tare = [&] { return emulator.ctl({"tare", "--rig", "floor"}); };
  EXPECT_EQ(emulator.ask(hold_command(plate.volts({.fz_n = 700.0}))), "ok");
  EXPECT_TRUE(eventually([&] { return tare().err.find("the plate of rig 'floor' is loaded") != std::string::npos; }));
  EXPECT_EQ(emulator.ask(hold_command(std::vector<double>(Plate::kChannels, kZeroV))), "ok");
  EXPECT_TRUE(eventually([&] { return tare().status == 0; }));

  EXPECT_EQ(emulator.ctl({"device", "test", "floor"}).status, 0);
  EXPECT_NE(emulator.ctl({"rig", "show", "floor"}).out.find("force plate"), std::string::npos);

  Errors errors;
  for (const double fz_n : {200.0, 700.0}) {
    for (const Load& load :
         {Load{.fz_n = fz_n}, Load{.fz_n = fz_n, .ml_mm = 60, .ap_mm = -40}, Load{.fz_n = fz_n, .ml_mm = -80, .ap_mm = 50},
          Load{.fx_n = 30, .fz_n = fz_n, .tz_nm = 3}, Load{.fx_n = -30, .fz_n = fz_n, .ml_mm = 40},
          Load{.fy_n = 30, .fz_n = fz_n, .ap_mm = -70}, Load{.fy_n = -30, .fz_n = fz_n, .tz_nm = -3}}) {
      const Measured found = measure(emulator, subscriber, plate, load, kZeroV);
      double& cop_mm = fz_n < 500.0 ? errors.cop_200_mm : errors.cop_700_mm;
      widen(cop_mm, std::hypot(found.cop[0] - load.ml_mm, found.cop[1] - load.ap_mm));
      widen(errors.vertical_n, found.cop[2] - fz_n);
      widen(errors.vertical_n, found.force[Plate::kHasShear ? 2 : 0] - fz_n);
      if (!Plate::kHasShear) continue;
      widen(errors.shear_n, found.force[0] - load.fx_n);
      widen(errors.shear_n, found.force[1] - load.fy_n);
      EXPECT_NEAR(found.force[5], load.tz_nm + (load.ml_mm * load.fy_n - load.ap_mm * load.fx_n) / 1000.0, 0.5);
    }
  }
  std::printf("  %s: Fz within %.2f N, shear within %.2f N, COP within %.3f mm at 200 N and %.3f mm at 700 N\n", daq.c_str(),
              errors.vertical_n, errors.shear_n, errors.cop_200_mm, errors.cop_700_mm);
  EXPECT_EQ(emulator.quit(), 0);
  return errors;
}

void expect_16_bit(const Errors& errors) {
  EXPECT_LE(errors.vertical_n, 0.002 * kFullScaleN);
  EXPECT_LE(errors.shear_n, 0.002 * 0.1 * kFullScaleN);
  EXPECT_LE(errors.cop_200_mm, 0.5);
  EXPECT_LE(errors.cop_700_mm, 0.1);
}

TEST(UsbForcePlateTest, KnownLoadsOnAKistlerPlate_AreMeasured) {
  RecordProperty("requirement", "ACQ-16");
  expect_16_bit(errors_of<Kistler>("1608fs-plus"));
}

TEST(UsbForcePlateTest, KnownLoadsOnAPlateOfSixComponents_AreMeasured) {
  RecordProperty("requirement", "ACQ-16");
  expect_16_bit(errors_of<SixComponents>("1608fs-plus"));
}

TEST(UsbForcePlateTest, KnownLoadsOnLoadCells_AreMeasured) {
  RecordProperty("requirement", "ACQ-16");
  expect_16_bit(errors_of<LoadCells>("1608fs-plus"));
}

/// With 12 bit, a plate at 5 kN is too coarse for posture: one code is 1.25 N in each vertical channel. A voltage at rest stays at one
/// code.
TEST(UsbForcePlateTest, Of12Bit_TheCentreOfPressureIsCoarse) {
  const Errors errors = errors_of<Kistler>("1208fs-plus", "stuck_ms = 0\n");

  EXPECT_LE(errors.vertical_n, 0.002 * kFullScaleN);
  EXPECT_LE(errors.cop_200_mm, 3.0);
  EXPECT_LE(errors.cop_700_mm, 0.9);
}

}  // namespace
}  // namespace dts::emulator
