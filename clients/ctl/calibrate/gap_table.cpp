// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/gap_table.h"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>

namespace dts::ctl {
namespace {

using client::ErrorCode;

constexpr std::string_view kHeader = "gap_mm,volts";
constexpr std::size_t kMaxLines = 100'000;
constexpr std::size_t kMaxLineLength = 200;
constexpr double kLargestGapMm = 1000.0;
constexpr double kLargestV = 100.0;

std::optional<double> number(std::string_view text, double smallest, double largest) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !(value >= smallest && value <= largest)) return std::nullopt;
  return value;
}

}  // namespace

client::Result<std::vector<physics::GapReading>> read_gap_table(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return client::fail(ErrorCode::InvalidArgument, file + ": no such file");
  std::ifstream stream(file, std::ios::binary);
  std::vector<physics::GapReading> readings;
  std::string line;
  for (std::size_t row = 1; std::getline(stream, line); ++row) {
    const auto wrong = [&](std::size_t column, const std::string& why) {
      return client::fail(ErrorCode::InvalidArgument, file + ":" + std::to_string(row) + ":" + std::to_string(column) + ": " + why,
                          "write a CSV file with the header " + std::string(kHeader));
    };
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.size() > kMaxLineLength || row > kMaxLines) return wrong(1, "too long");
    if (row == 1) {
      if (line != kHeader) return wrong(1, "the header is missing");
      continue;
    }
    const std::size_t comma = std::min(line.find(','), line.size());
    const std::string_view text = line;
    const auto gap_mm = number(text.substr(0, comma), 0.0, kLargestGapMm);
    if (!gap_mm) return wrong(1, "gap_mm must be a number; allowed: 0 .. 1000");
    const auto volts = comma < line.size() ? number(text.substr(comma + 1), -kLargestV, kLargestV) : std::nullopt;
    if (!volts) return wrong(comma + 2, "volts must be a number; allowed: -100 .. 100");
    readings.push_back({.gap = {*gap_mm}, .volts = {*volts}, .row = row});
  }
  return readings;
}

}  // namespace dts::ctl
