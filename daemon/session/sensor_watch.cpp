// SPDX-License-Identifier: Apache-2.0
#include "session/sensor_watch.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace dts::session {
namespace {

namespace quality = core::quality;

constexpr std::uint8_t kAll = 0xFF;
/// In order of priority; only the first match of a sensor is reported. A sensor at 10 V, for example, is also outside its curve.
constexpr std::array<std::pair<std::uint8_t, std::string_view>, 3> kProblems{
    {{quality::kStuck, "unchanged"}, {quality::kRail, "at the end of the range"}, {quality::kOutOfRange, "outside the calibration curve"}}};

}  // namespace

SensorWatch::SensorWatch(std::size_t sensor_count, std::uint64_t period_scans)
    : period_scans_(std::max<std::uint64_t>(period_scans, 1)), current_{.sensor_count = std::min(sensor_count, core::kMaxChannels)} {}

void SensorWatch::add(const core::Block& sensors) noexcept {
  if (sensors.channel_count() != current_.sensor_count || sensors.count() == 0) return;
  if (scans_ == 0) current_.bits.fill(kAll);
  for (std::size_t sensor = 0; sensor < current_.sensor_count; ++sensor) {
    for (const std::uint8_t bits : sensors.quality(sensor)) current_.bits[sensor] &= bits;
  }
  scans_ += sensors.count();
  if (scans_ < period_scans_) return;
  latest_.store(current_);
  scans_ = 0;
}

std::string sensor_problems(const SensorDoubts& doubts, const std::vector<std::string>& names, std::string_view advice) {
  std::string text;
  std::uint8_t reported = 0;
  for (const auto& [bit, problem] : kProblems) {
    std::string concerned;
    for (std::size_t sensor = 0; sensor < std::min(doubts.sensor_count, names.size()); ++sensor) {
      const std::uint8_t bits = doubts.bits[sensor];
      if ((bits & bit) != 0 && (bits & reported) == 0) concerned += (concerned.empty() ? "" : ", ") + names[sensor];
    }
    reported |= bit;
    if (!concerned.empty()) text += (text.empty() ? "sensors that do not measure: " : "; ") + concerned + " (" + std::string(problem) + ")";
  }
  return text.empty() ? "" : text + ": " + std::string(advice);
}

}  // namespace dts::session
