// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/cop_guide.h"

#include <algorithm>
#include <numeric>

#include "cli/table.h"
#include "cli/try.h"
#include "ctl/calibrate/picture.h"

namespace dts::ctl {
namespace {

using cli::decimal;
using client::Result;

/// The sum of four sensors with 3 mV noise varies by 0.01 mm; 20 N in the middle of the thesis's plate cause 0.5 mm.
constexpr double kEmptySumMm = 0.1;

/// A plate without calibration measures wrong loads: two feet on it read 9 % low. Kilograms instead of newtons differ by a factor of 9.81.
constexpr double kWrongWeightRatio = 1.6;

/// How far the centre of the deflections may be on the wrong side of the plate's centre, because of noise and unequal sensors.
constexpr double kWrongSideMm = 3.0;

/// Returns the centre of the deflections along one axis: always on the load's side of the sensors' middle, but much closer to the middle.
double deflection_centre_mm(const std::vector<double>& position_mm, const std::vector<double>& deflection_mm) {
  double moment = 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < position_mm.size(); ++i) {
    moment += deflection_mm[i] * position_mm[i];
    sum += deflection_mm[i];
  }
  return moment / sum;
}

/// Returns true if a load left of the middle bends the plate to the right, or the reverse: a wrong place, or sensors in the wrong order.
bool is_on_the_other_side(const std::vector<double>& position_mm, const std::vector<double>& deflection_mm, double place_mm) {
  const auto [first, last] = std::ranges::minmax(position_mm);
  const double middle_mm = 0.5 * (first + last);
  const double off_mm = deflection_centre_mm(position_mm, deflection_mm) - middle_mm;
  return place_mm < middle_mm ? off_mm > kWrongSideMm : place_mm > middle_mm && off_mm < -kWrongSideMm;
}

}  // namespace

bool is_loaded(std::span<const double> deflection_mm) noexcept {
  return std::accumulate(deflection_mm.begin(), deflection_mm.end(), 0.0) > kEmptySumMm;
}

std::string load_text(std::span<const double> deflection_mm) {
  const double sum_mm = std::accumulate(deflection_mm.begin(), deflection_mm.end(), 0.0);
  return std::string(is_loaded(deflection_mm) ? "the plate is loaded" : "the plate is empty") + ": sum of deflections " +
         decimal(sum_mm, 2) + " mm";
}

std::size_t CopGuide::next() const {
  std::size_t index = 0;
  while (index < is_skipped_.size() && (parts_.progress.points()[index] || is_skipped_[index])) ++index;
  return index;
}

Result<bool> CopGuide::measure_until(std::size_t end) {
  while (next() < end) {
    const std::size_t index = next();
    announce(index);
    if (parts_.prompt != nullptr) {
      const Reply reply = parts_.prompt->ask("  Is the weight in place?", Prompt::kWithAll);
      if (reply == Answer::Quit) return false;
      DTS_TRY_ASSIGN(const auto goes_on, go_on(reply, index));
      if (!goes_on) continue;
      DTS_TRY(parts_.measurer.begin_anew());
    }
    DTS_TRY_ASSIGN(const auto stopped, measure(index));
    if (stopped == Answer::Quit) return false;
    if (stopped == Answer::Skip) is_skipped_[index] = true;
    if (parts_.progress.points()[index]) last_ = index;
  }
  begin_ = end;
  last_.reset();
  return true;
}

/// Returns true if the point is to be measured now.
Result<bool> CopGuide::go_on(const Reply& reply, std::size_t index) {
  if (reply == Answer::Go) return true;
  if (reply == Answer::Skip) {
    is_skipped_[index] = true;
    return false;
  }
  DTS_TRY(forget(reply.number));
  return false;
}

Result<void> CopGuide::forget(std::optional<std::size_t> number) {
  const std::size_t index = number ? *number - 1 : last_.value_or(parts_.points.size());
  if (index >= begin_ && index < parts_.points.size() && (parts_.progress.points()[index] || is_skipped_[index])) {
    is_skipped_[index] = false;
    return parts_.progress.forget(index);
  }
  parts_.say(number ? "  point " + std::to_string(*number) + " has not been measured in this run" : "  no point has been measured yet");
  return {};
}

Result<Answer> CopGuide::measure(std::size_t index) {
  const bool is_automatic = parts_.prompt == nullptr;
  if (is_automatic) {
    const auto is_empty = [](std::span<const double> scan) { return !is_loaded(scan); };
    DTS_TRY(parts_.measurer.wait_until(is_empty));
  }
  DTS_TRY_ASSIGN(const auto measured, parts_.measurer.measure(is_loaded));
  if (!measured) return parts_.typed != nullptr ? parts_.typed->value_or(Answer::Quit) : Answer::Quit;
  const SteadyReading& reading = *measured;
  const PlannedPoint& point = parts_.points[index];
  if (is_on_the_other_side(parts_.plate.sensor_x_mm, reading.mean, point.x_mm) ||
      is_on_the_other_side(parts_.plate.sensor_y_mm, reading.mean, point.y_mm)) {
    parts_.say("  not recorded: the plate bends on the other side. Check the position of the weight and the order of the sensors.");
    return Answer::Go;
  }
  DTS_TRY(parts_.progress.record(index, reading));
  report(index, reading);
  doubt_weight(point.load_n);
  return Answer::Go;
}

void CopGuide::doubt_weight(double load_n) {
  const auto found_n = parts_.estimated_load_n ? parts_.estimated_load_n() : std::nullopt;
  if (!found_n || !(*found_n > 0.0) || std::max(*found_n / load_n, load_n / *found_n) < kWrongWeightRatio) return;
  if (!doubted_loads_n_.insert(load_n).second) return;
  parts_.say("  warning: the present calibration of the rig shows " + decimal(*found_n, 0) + " N for this weight of " + decimal(load_n, 0) +
             " N. Check the weight and its unit (1 kg weighs 9.81 N).");
}

void CopGuide::announce(std::size_t index) const {
  const PlannedPoint& point = parts_.points[index];
  parts_.say("Point " + std::to_string(index + 1) + " of " + std::to_string(parts_.points.size()) + ": place " + decimal(point.load_n, 0) +
             " N at " + place_text(parts_.plate, point));
  if (!parts_.draws) return;
  std::string picture = spot_picture(parts_.plate, point);
  picture.pop_back();
  parts_.say(picture);
}

void CopGuide::report(std::size_t index, const SteadyReading& reading) const {
  std::string text = "  read";
  double noise_mm = 0.0;
  for (std::size_t i = 0; i < reading.mean.size(); ++i) {
    text += "  " + parts_.plate.labels[i] + " " + decimal(reading.mean[i], 3);
    noise_mm = std::max(noise_mm, reading.noise[i]);
  }
  const bool is_last = index + 1 == parts_.points.size();
  parts_.say(text + " mm; noise up to " + decimal(noise_mm, 4) + " mm over " + std::to_string(reading.scans) + " scans" +
             (is_last ? "" : "; remove the weight"));
}

}  // namespace dts::ctl
