// SPDX-License-Identifier: Apache-2.0
#include "files/force_plate_file.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <tuple>
#include <utility>

namespace dts::files {
namespace {

using physics::ForcePlate;
using physics::kKistlerChannels;
using physics::kSixComponents;
using physics::SixBySix;

constexpr double kLargest = 1e9;
constexpr double kMicrovoltsPerVolt = 1e6;
constexpr double kMillivoltsPerVolt = 1e3;

/// Makes absent keys known, so that a misspelt one is suggested.
void know(TomlReader& reader, std::initializer_list<std::string_view> keys) {
  for (const std::string_view key : keys) {
    if (!reader.has(key)) static_cast<void>(reader.node(key));
  }
}

/// Reports keys that are known but have no use in this table.
void report_unused(TomlReader& reader, std::initializer_list<std::string_view> keys, const std::string& used_with) {
  for (const std::string_view key : keys) {
    if (reader.node(key) != nullptr) reader.report(key, std::string(key) + " is used only with " + used_with + ": remove it");
  }
}

/// Reports that the table has both keys.
void report_both(TomlReader& reader, std::string_view one, std::string_view other) {
  static_cast<void>(reader.node(other));
  reader.report(other, std::string(one) + " and " + std::string(other) + " exclude each other: give one of the two");
}

/// Returns the list at `key`, which must be there and have `count` numbers; zeros if it is wrong, with a problem.
template <std::size_t Count>
std::array<double, Count> required_list(TomlReader& reader, std::string_view key) {
  std::array<double, Count> values{};
  reader.require(key);
  know(reader, {key});
  if (!reader.has(key)) return values;
  const std::vector<double> read = read_list(reader, key, reader.node(key), Count, Count, kLargest);
  std::ranges::copy(read, values.begin());
  return values;
}

SixBySix required_matrix(TomlReader& reader, std::string_view key) {
  SixBySix matrix{};
  const toml::node* const found = reader.node(key);
  const toml::array* const rows = found == nullptr ? nullptr : found->as_array();
  if (rows == nullptr || rows->size() != kSixComponents) {
    reader.report(key, std::string(key) + " must be a list of 6 rows of 6 numbers");
    return matrix;
  }
  for (std::size_t row = 0; row < kSixComponents; ++row) {
    const std::vector<double> read = read_list(reader, key, rows->get(row), kSixComponents, kSixComponents, kLargest);
    std::ranges::copy(read, matrix.at(row).begin());
  }
  return matrix;
}

/// Returns the eight numbers at `key`, none of which may be 0; zeros if the list is wrong, with a problem.
std::array<double, kKistlerChannels> eight_not_zero(TomlReader& reader, std::string_view key, const Problems& problems) {
  const std::size_t known_problems = problems.size();
  const auto values = required_list<kKistlerChannels>(reader, key);
  const bool has_zero = std::ranges::find(values, 0.0) != values.end();
  if (has_zero && problems.size() == known_problems) reader.report(key, std::string(key) + " has a 0");
  return values;
}

std::array<double, kKistlerChannels> kistler_scales(TomlReader& reader, const Problems& problems) {
  std::array<double, kKistlerChannels> newtons_per_volt{};
  if (reader.has("sensitivity_pc_per_n") && !reader.has("scale_mv_per_n")) {
    const auto sensitivity = eight_not_zero(reader, "sensitivity_pc_per_n", problems);
    const auto range = eight_not_zero(reader, "range_pc", problems);
    const double full_scale_v = reader.number("full_scale_v", 10.0, 0.001, 1000.0);
    for (std::size_t k = 0; k < kKistlerChannels; ++k) newtons_per_volt.at(k) = range.at(k) / (full_scale_v * sensitivity.at(k));
    return newtons_per_volt;
  }
  if (reader.has("sensitivity_pc_per_n")) {
    report_both(reader, "scale_mv_per_n", "sensitivity_pc_per_n");
    for (const char* const key : {"range_pc", "full_scale_v"}) static_cast<void>(reader.node(key));
  } else {
    report_unused(reader, {"range_pc", "full_scale_v"}, "sensitivity_pc_per_n");
  }
  const auto scale = eight_not_zero(reader, "scale_mv_per_n", problems);
  for (std::size_t k = 0; k < kKistlerChannels; ++k) newtons_per_volt.at(k) = kMillivoltsPerVolt / scale.at(k);
  return newtons_per_volt;
}

core::Result<ForcePlate> kistler(TomlReader& reader, const Problems& problems, std::optional<physics::PointPolynomial>& polynomial) {
  know(reader, {"scale_mv_per_n", "sensitivity_pc_per_n", "range_pc", "full_scale_v", "cop_poly_x", "cop_poly_y"});
  physics::KistlerPlate plate{.newtons_per_unit = kistler_scales(reader, problems)};
  for (const auto& [key, target, least, most] : {std::tuple{"a_mm", &plate.a_mm, 1.0, 5000.0}, std::tuple{"b_mm", &plate.b_mm, 1.0, 5000.0},
                                                 std::tuple{"az0_mm", &plate.az0_mm, -1000.0, -0.001}}) {
    reader.require(key);
    *target = reader.number(key, least, least, most);
  }
  if (reader.has("cop_poly_x") || reader.has("cop_poly_y")) {
    polynomial.emplace();
    polynomial->x = required_list<6>(reader, "cop_poly_x");
    polynomial->y = required_list<6>(reader, "cop_poly_y");
  }
  return ForcePlate::create(plate);
}

/// Returns, for each channel, what its volts are to be multiplied by before the matrix: 1e6 / (excitation x gain).
std::array<double, kSixComponents> microvolts_per_volt(TomlReader& reader, const Problems& problems) {
  const std::size_t known_problems = problems.size();
  const auto excitation_v = required_list<kSixComponents>(reader, "excitation_v");
  const auto gain = required_list<kSixComponents>(reader, "gain");
  if (problems.size() > known_problems) return {};
  std::array<double, kSixComponents> factors{};
  for (std::size_t k = 0; k < kSixComponents; ++k) {
    for (const auto& [key, value] : {std::pair{"excitation_v", excitation_v.at(k)}, std::pair{"gain", gain.at(k)}}) {
      if (!(value > 0.0)) reader.report(key, std::string(key) + ": number " + std::to_string(k + 1) + " is not above 0");
    }
    factors.at(k) = kMicrovoltsPerVolt / (excitation_v.at(k) * gain.at(k));
  }
  return factors;
}

core::Result<ForcePlate> six_component(TomlReader& reader, const Problems& problems) {
  const std::size_t known_problems = problems.size();
  know(reader, {"matrix", "matrix_unit", "sensitivity", "excitation_v", "gain"});
  physics::SixComponentPlate plate;
  std::array<double, kSixComponents> factors{1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
  const bool is_sensitivity = reader.has("sensitivity") && !reader.has("matrix");
  if (!is_sensitivity) reader.require("matrix");
  const std::string key = is_sensitivity ? "sensitivity" : "matrix";
  if (reader.has(key)) plate.matrix = required_matrix(reader, key);
  if (is_sensitivity) {
    report_unused(reader, {"matrix_unit"}, "matrix");
    factors = microvolts_per_volt(reader, problems);
  } else {
    if (reader.has("sensitivity")) report_both(reader, "matrix", "sensitivity");
    reader.require("matrix_unit");
    if (reader.choice("matrix_unit", {"n_per_v", "n_per_uv_per_v"}) == "n_per_uv_per_v") {
      factors = microvolts_per_volt(reader, problems);
    } else {
      report_unused(reader, {"excitation_v", "gain"}, "matrix_unit = \"n_per_uv_per_v\" or sensitivity");
    }
  }
  plate.surface_mm = required_list<3>(reader, "surface_mm");
  if (problems.size() == known_problems) {
    const auto inverse = physics::calibration_from_sensitivity(plate.matrix);
    if (!inverse) reader.report(key, key + " is singular: copy all 36 values of the maker's sheet");
    if (inverse && is_sensitivity) plate.matrix = *inverse;
  }
  for (auto& row : plate.matrix) {
    for (std::size_t k = 0; k < kSixComponents; ++k) row.at(k) *= factors.at(k);
  }
  return ForcePlate::create(plate);
}

core::Result<ForcePlate> load_cells(TomlReader& reader) {
  physics::LoadCellPlate plate;
  reader.require("position_mm");
  const toml::node* const found = reader.node("position_mm");
  const toml::array* const positions = found == nullptr ? nullptr : found->as_array();
  const std::size_t count = positions == nullptr ? 0 : positions->size();
  if (found != nullptr && (count < physics::kFewestLoadCells || count > physics::kMostLoadCells)) {
    reader.report("position_mm", "position_mm must be a list of 3 or 4 pairs of numbers");
  }
  for (std::size_t cell = 0; cell < count && count <= physics::kMostLoadCells; ++cell) {
    const std::vector<double> pair = read_list(reader, "position_mm", positions->get(cell), 2, 2, kLargest);
    plate.cells.push_back({.x_mm = pair.empty() ? 0.0 : pair[0], .y_mm = pair.empty() ? 0.0 : pair[1], .newtons_per_unit = 1.0});
  }
  reader.require("scale_n_per_v");
  const toml::node* const scale = reader.node("scale_n_per_v");
  if (scale != nullptr && scale->is_number()) {
    const double newtons_per_volt = reader.number("scale_n_per_v", 1.0, -kLargest, kLargest);
    for (auto& cell : plate.cells) cell.newtons_per_unit = newtons_per_volt;
  } else if (scale != nullptr) {
    const std::vector<double> scales = read_list(reader, "scale_n_per_v", scale, plate.cells.size(), plate.cells.size(), kLargest);
    for (std::size_t cell = 0; cell < scales.size(); ++cell) plate.cells[cell].newtons_per_unit = scales[cell];
  }
  return ForcePlate::create(plate);
}

}  // namespace

std::optional<ForcePlateFile> read_force_plate(TomlReader reader, Problems& problems) {
  const std::size_t known_problems = problems.size();
  reader.require("kind");
  know(reader, {"kind", "tare"});
  if (!reader.has("kind")) {
    reader.finish();
    return std::nullopt;
  }
  const std::string kind = reader.choice("kind", {"kistler8", "six_component", "load_cells"});
  if (problems.size() > known_problems) return std::nullopt;
  const bool is_z_down = reader.choice("axes", {"z_down", "z_up"}) == "z_down";
  std::optional<physics::PointPolynomial> polynomial;
  auto plate = kind == "kistler8"        ? kistler(reader, problems, polynomial)
               : kind == "six_component" ? six_component(reader, problems)
                                         : load_cells(reader);
  if (!plate && problems.size() == known_problems) reader.report("", core::to_string(plate.error()));
  if (!plate) {
    if (reader.has("tare")) static_cast<void>(reader.node("tare"));
    reader.finish();
    return std::nullopt;
  }
  std::vector<double> tare_volts(plate->channel_count(), 0.0);
  if (reader.has("tare")) {
    TomlReader tare = reader.table("tare");
    tare.require("volts");
    const toml::node* const volts = tare.node("volts");
    if (volts != nullptr) {
      const std::vector<double> read = read_list(tare, "volts", volts, tare_volts.size(), tare_volts.size(), 1000.0);
      std::ranges::copy(read, tare_volts.begin());
    }
    tare.finish();
  }
  reader.finish();
  if (problems.size() > known_problems) return std::nullopt;
  return ForcePlateFile{
      .kind = kind, .plate = std::move(*plate), .polynomial = polynomial, .is_z_down = is_z_down, .tare_volts = std::move(tare_volts)};
}

std::optional<ForcePlateFile> read_force_plate(const std::string& file, Problems& problems) {
  const std::size_t known_problems = problems.size();
  const auto table = parse_toml(file, problems);
  if (!table) return std::nullopt;
  TomlReader reader(&*table, "", file, problems);
  reader.require("force_plate");
  if (!reader.has("force_plate")) {
    know(reader, {"force_plate"});
    reader.finish();
    return std::nullopt;
  }
  auto plate = read_force_plate(reader.table("force_plate"), problems);
  reader.finish();
  return problems.size() == known_problems ? std::move(plate) : std::nullopt;
}

}  // namespace dts::files
