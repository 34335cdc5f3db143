// SPDX-License-Identifier: Apache-2.0
#include "sim/plate_response.h"

#include "sim/counter_random.h"

namespace dts::sim {
namespace {

constexpr std::uint64_t kDefectsSeed = 0x706c617465ULL;  // Keeps these random numbers apart from those of the noise for every seed.
constexpr double kDriftWithinMm = 50.0;                  // of the centre
constexpr double kShearOfDrift = 0.25;

physics::Wrench drift_wrench(const PlateDefects& defects, const CounterRandom& random) {
  const double up_n = random.uniform(4) < 0.5 ? -defects.drift_n_per_s : defects.drift_n_per_s;
  const physics::Wrench force{
      .force_n = {kShearOfDrift * up_n * either_side(random, 5), kShearOfDrift * up_n * either_side(random, 6), up_n}};
  return physics::about(force, {-kDriftWithinMm * either_side(random, 7), -kDriftWithinMm * either_side(random, 8), 0.0});
}

}  // namespace

PlateResponse::PlateResponse(const physics::ForcePlateModel& plate, double height_mm, const PlateDefects& defects)
    : inverse_(plate.plate, plate.mounting), tare_v_(plate.tare_v), height_mm_(height_mm) {
  const CounterRandom random(defects.seed ^ kDefectsSeed);
  shear_of_vertical_ml_ = defects.cross_talk * either_side(random, 0);
  shear_of_vertical_ap_ = defects.cross_talk * either_side(random, 1);
  vertical_of_ml_ = defects.cross_talk * either_side(random, 2);
  vertical_of_ap_ = defects.cross_talk * either_side(random, 3);
  drift_per_s_ = drift_wrench(defects, random);
}

physics::Wrench PlateResponse::about_surface(const StandingMoment& moment) const noexcept {
  const Contact& contact = moment.contact;
  if (contact.load_n <= 0.0) return {};
  const physics::Wrench at_cop{.force_n = {moment.ml_n, moment.ap_n, contact.load_n}};
  return physics::about(at_cop, {-contact.cop.ml_mm, -contact.cop.ap_mm, -height_mm_});
}

physics::Wrench PlateResponse::with_defects(const physics::Wrench& wrench, double since_reset_s) const noexcept {
  const auto& [ml, ap, up] = wrench.force_n;
  physics::Wrench shown = wrench;
  shown.force_n = {ml + shear_of_vertical_ml_ * up, ap + shear_of_vertical_ap_ * up, up + vertical_of_ml_ * ml + vertical_of_ap_ * ap};
  for (std::size_t i = 0; i < 3; ++i) {
    shown.force_n[i] += since_reset_s * drift_per_s_.force_n[i];
    shown.moment_nm[i] += since_reset_s * drift_per_s_.moment_nm[i];
  }
  return shown;
}

void PlateResponse::write_volts(const StandingMoment& moment, double since_reset_s, std::span<double> volts) const noexcept {
  inverse_.write_channels(with_defects(about_surface(moment), since_reset_s), volts);
  for (std::size_t channel = 0; channel < tare_v_.size(); ++channel) volts[channel] += tare_v_[channel];
}

}  // namespace dts::sim
