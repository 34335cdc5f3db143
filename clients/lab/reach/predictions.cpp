// SPDX-License-Identifier: Apache-2.0
#include "lab/reach/predictions.h"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/cell_text.h"
#include "files/whole_file.h"

namespace dts::lab::reach {
namespace {

constexpr const char* kHeader = "subject,trial,t_p1,t_p2,t_p3,p1_mm,p2_mm,p3_mm,class,p_class,trunk_deg,trunk_lo_deg,trunk_hi_deg\n";

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) return {};
  std::array<char, 64> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed, decimals);
  return end.ec == std::errc() ? std::string(digits.data(), end.ptr) : std::string();
}

std::string time_text(const core::ReachPoint& point, const core::Rate& rate) {
  return std::isfinite(point.value_mm) ? fixed(static_cast<double>(rate.time_ns(point.scan)) * 1e-9, 4) : std::string();
}

std::string reach_text(const Prediction& prediction) {
  if (!prediction.reach) return ",,,,,";
  const core::ReachEvent& reach = *prediction.reach;
  return time_text(reach.p1, prediction.rate) + "," + time_text(reach.p2, prediction.rate) + "," + time_text(reach.p3, prediction.rate) +
         "," + fixed(reach.features.p1_mm, 4) + "," + fixed(reach.features.p2_mm, 4) + "," + fixed(reach.features.p3_mm, 4);
}

std::string movement_text(const std::optional<core::TrunkMovement>& movement) {
  if (!movement) return ",,,,";
  const int trunk_class = static_cast<int>(movement->trunk_class);
  const bool has_probability = trunk_class >= 1 && trunk_class <= 3;
  const double probability =
      has_probability ? movement->probability[static_cast<std::size_t>(trunk_class - 1)] : std::numeric_limits<double>::quiet_NaN();
  return std::to_string(trunk_class) + "," + fixed(probability, 4) + "," + fixed(movement->trunk_deg, 2) + "," +
         fixed(movement->trunk_lo_deg, 2) + "," + fixed(movement->trunk_hi_deg, 2);
}

}  // namespace

std::string prediction_text(std::span<const Prediction> predictions) {
  std::string text = kHeader;
  for (const Prediction& prediction : predictions) {
    text += core::csv_cell(prediction.subject) + "," + std::to_string(prediction.trial) + "," + reach_text(prediction) + "," +
            movement_text(prediction.movement) + "\n";
  }
  return text;
}

core::Status write_predictions(std::span<const Prediction> predictions, const std::string& file) {
  return files::write_whole_file(file, prediction_text(predictions));
}

}  // namespace dts::lab::reach
