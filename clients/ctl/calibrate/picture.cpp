// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "cli/table.h"

namespace dts::ctl {
namespace {

using cli::decimal;

constexpr int kColumns = 33;  // letters are about twice as high as wide
constexpr int kRows = 17;

struct Shade {
  double most_mm;
  char symbol;
};
constexpr std::array kShades{Shade{0.1, '.'}, Shade{0.3, 'o'}, Shade{1.0, 'O'}, Shade{INFINITY, '#'}};
constexpr const char* kLegend = "error: . up to 0.1 mm   o up to 0.3 mm   O up to 1 mm   # more";

char symbol(double error_mm) {
  for (const Shade& shade : kShades) {
    if (error_mm <= shade.most_mm) return shade.symbol;
  }
  return '?';  // NaN: no estimate
}

/// Returns the cell of a position in a grid of `cells` over `length_mm`.
std::size_t cell(double position_mm, double length_mm, int cells) {
  const double part = length_mm > 0.0 ? position_mm / length_mm : 0.0;
  return static_cast<std::size_t>(std::clamp(std::lround(part * (cells - 1)), 0L, static_cast<long>(cells - 1)));
}

/// Returns the same key for positions in the same row or column of a map.
long grid_key(double position_mm) { return std::lround(10.0 * position_mm); }

std::string one_map(const std::vector<PointError>& errors) {
  std::map<long, std::map<long, char>> rows;
  std::set<long> columns;
  for (const PointError& error : errors) {
    rows[grid_key(error.point.y_mm)][grid_key(error.point.x_mm)] = symbol(error.total_mm());
    columns.insert(grid_key(error.point.x_mm));
  }
  std::string text;
  for (auto row = rows.rbegin(); row != rows.rend(); ++row) {  // forward at the top
    const std::string y = decimal(static_cast<double>(row->first) / 10.0, 0);
    text += std::string(6 - std::min<std::size_t>(6, y.size()), ' ') + y + " ";
    for (const long column : columns) {
      const auto found = row->second.find(column);
      text += std::string("  ") + (found == row->second.end() ? ' ' : found->second);
    }
    text += '\n';
  }
  return text;
}

}  // namespace

std::string spot_picture(const PlateView& plate, const PlannedPoint& spot) {
  std::vector<std::string> raster(kRows, std::string(kColumns, ' '));
  const auto put = [&](double x_mm, double y_mm, char mark) {
    raster[kRows - 1 - cell(y_mm, plate.b_mm, kRows)][cell(x_mm, plate.a_mm, kColumns)] = mark;
  };
  for (std::size_t i = 0; i < plate.labels.size(); ++i) put(plate.sensor_x_mm[i], plate.sensor_y_mm[i], 'o');
  put(spot.x_mm, spot.y_mm, 'X');
  const std::string edge = "  +" + std::string(kColumns, '-') + "+\n";
  std::string text = edge;
  for (const std::string& row : raster) text += "  |" + row + "|\n";
  return text + edge;
}

std::string place_text(const PlateView& plate, const PlannedPoint& spot) {
  return "x " + decimal(spot.x_mm, 2) + ", y " + decimal(spot.y_mm, 2) + " mm from the left back corner (" +
         decimal(spot.x_mm - plate.a_mm / 2.0, 2) + ", " + decimal(spot.y_mm - plate.b_mm / 2.0, 2) + " mm from the centre)";
}

double PointError::total_mm() const noexcept { return std::hypot(x_error_mm, y_error_mm); }

ErrorSummary summary(const std::vector<PointError>& errors) {
  ErrorSummary result;
  for (const PointError& error : errors) {
    const auto count = static_cast<double>(errors.size());
    result.rms_x_mm += error.x_error_mm * error.x_error_mm / count;
    result.rms_y_mm += error.y_error_mm * error.y_error_mm / count;
    result.max_total_mm = std::max(result.max_total_mm, error.total_mm());
  }
  result.rms_total_mm = std::sqrt(result.rms_x_mm + result.rms_y_mm);
  result.rms_x_mm = std::sqrt(result.rms_x_mm);
  result.rms_y_mm = std::sqrt(result.rms_y_mm);
  return result;
}

std::string error_map(const std::vector<PointError>& errors) {
  std::map<double, std::vector<PointError>> by_load;
  for (const PointError& error : errors) by_load[error.point.load_n].push_back(error);
  std::string text;
  for (const auto& [load_n, of_load] : by_load) {
    const ErrorSummary figures = summary(of_load);
    text += decimal(load_n, 0) + " N: rms " + decimal(figures.rms_total_mm, 2) + " mm, at most " + decimal(figures.max_total_mm, 2) +
            " mm\n" + one_map(of_load);
  }
  return text + "  " + kLegend + '\n';
}

}  // namespace dts::ctl
