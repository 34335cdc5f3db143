// SPDX-License-Identifier: Apache-2.0
#include "device/sim/cop_recording.h"

#include <algorithm>
#include <cmath>

#include "device/sim/csv_rows.h"

namespace dts::device::sim {
namespace {

constexpr CsvForm kCopForm{.subject = "recording",
                           .header = "t_s,x_mm,y_mm",
                           .hint = "a recording is a CSV file with the header t_s,x_mm,y_mm and one number per column",
                           .max_rows = CopRecording::kMaxRows,
                           .min_rows = 2};

dts::sim::CopPosition between(dts::sim::CopPosition a, dts::sim::CopPosition b, double part) noexcept {
  return {a.ml_mm + part * (b.ml_mm - a.ml_mm), a.ap_mm + part * (b.ap_mm - a.ap_mm)};
}

}  // namespace

core::Result<CopRecording> CopRecording::load(const std::string& path) {
  CopRecording recording;
  const auto add_row = [&](std::span<const double> row, const std::string& place) { return recording.append(row, place); };
  DTS_TRY(read_csv(path, kCopForm, add_row));
  recording.subtract_mean();
  return recording;
}

core::Status CopRecording::append(std::span<const double> row, const std::string& place) {
  const double time_s = row[0];
  const double ml_mm = row[1];
  const double ap_mm = row[2];
  if (std::abs(ml_mm) > kMaxMillimetres || std::abs(ap_mm) > kMaxMillimetres) {
    return refuse_row(kCopForm, place, "a position beyond " + std::to_string(kMaxMillimetres) + " mm");
  }
  if (times_s_.empty()) first_time_s_ = time_s;
  const double since_first_s = time_s - first_time_s_;
  if (!times_s_.empty() && !(since_first_s > times_s_.back()))
    return refuse_row(kCopForm, place, "the time is not later than in the row before");
  times_s_.push_back(since_first_s);
  positions_.push_back({ml_mm, ap_mm});
  return {};
}

void CopRecording::subtract_mean() noexcept {
  dts::sim::CopPosition sum;
  for (const dts::sim::CopPosition& position : positions_) sum = {sum.ml_mm + position.ml_mm, sum.ap_mm + position.ap_mm};
  const auto count = static_cast<double>(positions_.size());
  for (dts::sim::CopPosition& position : positions_) {
    position = {position.ml_mm - sum.ml_mm / count, position.ap_mm - sum.ap_mm / count};
  }
}

dts::sim::CopPosition CopRecording::at(double time_s) const noexcept {
  const auto later = std::upper_bound(times_s_.begin(), times_s_.end(), time_s);
  if (later == times_s_.begin()) return positions_.front();
  if (later == times_s_.end()) return positions_.back();
  const auto after = static_cast<std::size_t>(later - times_s_.begin());
  const double part = (time_s - times_s_[after - 1]) / (times_s_[after] - times_s_[after - 1]);
  return between(positions_[after - 1], positions_[after], part);
}

dts::sim::CopPosition CopRecording::repeated_at(double time_s) const noexcept {
  if (time_s <= 0.0) return positions_.front();
  const double in_round_s = std::fmod(time_s, duration_s() + kBridgeS);
  if (in_round_s <= duration_s()) return at(in_round_s);
  return between(positions_.back(), positions_.front(), (in_round_s - duration_s()) / kBridgeS);
}

}  // namespace dts::device::sim
