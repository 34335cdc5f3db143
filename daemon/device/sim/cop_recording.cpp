// SPDX-License-Identifier: Apache-2.0
#include "device/sim/cop_recording.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace dts::device::sim {
namespace {

using core::ErrorCode;

constexpr std::string_view kHeader = "t_s,x_mm,y_mm";
constexpr std::string_view kFormHint = "a recording is a CSV file with the header t_s,x_mm,y_mm and one number per column";
constexpr std::size_t kMaxLineLength = 256;
constexpr std::uintmax_t kMaxFileBytes = kMaxLineLength * CopRecording::kMaxRows;

tl::unexpected<core::Error> refuse(const std::string& place, const std::string& why) {
  return core::fail(ErrorCode::InvalidArgument, place + ": " + why, std::string(kFormHint));
}

/// Three finite numbers separated by commas and nothing else.
bool parse_row(std::string_view line, std::array<double, 3>& row) {
  for (std::size_t column = 0; column < row.size(); ++column) {
    const bool is_last = column + 1 == row.size();
    const std::size_t comma = line.find(',');
    if ((comma == std::string_view::npos) != is_last) return false;
    const std::string_view cell = line.substr(0, comma);
    const auto [stopped_at, error] = std::from_chars(cell.data(), cell.data() + cell.size(), row[column]);
    if (error != std::errc{} || stopped_at != cell.data() + cell.size() || !std::isfinite(row[column])) return false;
    if (!is_last) line.remove_prefix(comma + 1);
  }
  return true;
}

core::Status check_file(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return core::fail(ErrorCode::NotFound, "recording " + path + ": no such file", "give the path from the daemon's folder or from /");
  }
  if (std::filesystem::file_size(path, error) > kMaxFileBytes || error) return refuse(path, "too large");
  return {};
}

void remove_carriage_return(std::string& line) {
  if (!line.empty() && line.back() == '\r') line.pop_back();
}

physics::CopPosition between(physics::CopPosition a, physics::CopPosition b, double part) noexcept {
  return {a.ml_mm + part * (b.ml_mm - a.ml_mm), a.ap_mm + part * (b.ap_mm - a.ap_mm)};
}

}  // namespace

core::Result<CopRecording> CopRecording::load(const std::string& path) {
  if (auto checked = check_file(path); !checked) return tl::make_unexpected(checked.error());
  std::ifstream file(path, std::ios::binary);
  if (!file) return core::fail(ErrorCode::Failed, "recording " + path + ": cannot be read");
  std::string line;
  std::getline(file, line);
  remove_carriage_return(line);
  if (line != kHeader) return refuse(path + ":1", "the header is \"" + line.substr(0, kMaxLineLength) + "\"");

  CopRecording recording;
  for (std::size_t number = 2; std::getline(file, line); ++number) {
    remove_carriage_return(line);
    const std::string place = path + ":" + std::to_string(number);
    if (auto appended = recording.append(line, place); !appended) return tl::make_unexpected(appended.error());
  }
  if (recording.positions_.size() < 2) return refuse(path, "fewer than two rows");
  recording.subtract_mean();
  return recording;
}

core::Status CopRecording::append(std::string_view line, const std::string& place) {
  std::array<double, 3> row{};
  if (line.size() > kMaxLineLength) return refuse(place, "longer than " + std::to_string(kMaxLineLength) + " characters");
  if (!parse_row(line, row)) return refuse(place, "\"" + std::string(line) + "\" is not three numbers");
  const auto [time_s, ml_mm, ap_mm] = row;
  if (std::abs(ml_mm) > kMaxMillimetres || std::abs(ap_mm) > kMaxMillimetres) {
    return refuse(place, "a position beyond " + std::to_string(kMaxMillimetres) + " mm");
  }
  if (positions_.size() >= kMaxRows) return refuse(place, "more than " + std::to_string(kMaxRows) + " rows");
  if (times_s_.empty()) first_time_s_ = time_s;
  const double since_first_s = time_s - first_time_s_;
  if (!times_s_.empty() && !(since_first_s > times_s_.back())) return refuse(place, "the time does not rise");
  times_s_.push_back(since_first_s);
  positions_.push_back({ml_mm, ap_mm});
  return {};
}

void CopRecording::subtract_mean() noexcept {
  physics::CopPosition sum;
  for (const physics::CopPosition& position : positions_) sum = {sum.ml_mm + position.ml_mm, sum.ap_mm + position.ap_mm};
  const auto count = static_cast<double>(positions_.size());
  for (physics::CopPosition& position : positions_) {
    position = {position.ml_mm - sum.ml_mm / count, position.ap_mm - sum.ap_mm / count};
  }
}

physics::CopPosition CopRecording::at(double time_s) const noexcept {
  const auto later = std::upper_bound(times_s_.begin(), times_s_.end(), time_s);
  if (later == times_s_.begin()) return positions_.front();
  if (later == times_s_.end()) return positions_.back();
  const auto after = static_cast<std::size_t>(later - times_s_.begin());
  const double part = (time_s - times_s_[after - 1]) / (times_s_[after] - times_s_[after - 1]);
  return between(positions_[after - 1], positions_[after], part);
}

physics::CopPosition CopRecording::repeated_at(double time_s) const noexcept {
  if (time_s <= 0.0) return positions_.front();
  const double in_round_s = std::fmod(time_s, duration_s() + kBridgeS);
  if (in_round_s <= duration_s()) return at(in_round_s);
  return between(positions_.back(), positions_.front(), (in_round_s - duration_s()) / kBridgeS);
}

}  // namespace dts::device::sim
