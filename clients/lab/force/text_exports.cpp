// SPDX-License-Identifier: Apache-2.0
#include "lab/force/text_exports.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <memory>
#include <utility>

#include "core/number_text.h"
#include "lab/force/column_names.h"
#include "physics/conversions.h"

namespace dts::lab::force {
namespace {

/// Times that differ by less than this part from a whole rate have that rate: they are rounded.
constexpr double kWholeRate = 1e-4;
/// A stated rate that differs by more than this part from that of the times contradicts them.
constexpr double kSameRate = 0.05;

std::string lower(std::string_view text) {
  std::string small(text);
  std::ranges::transform(small, small.begin(), [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return small;
}

bool is_opensim_end(const std::string& line) { return lower(line).starts_with("endheader"); }

char separator_of(std::string_view line) {
  for (const char separator : {'\t', ';', ','}) {
    if (line.find(separator) != std::string_view::npos) return separator;
  }
  return ' ';
}

/// The line with the names of the columns.
struct Names {
  std::size_t line = 0;  ///< Index into the beginning.
  char separator = ',';
  NamedColumns columns;
  std::size_t first_row = 0;  ///< Line of the first row of numbers, counted from 1.
  std::size_t row_cells = 0;  ///< Cells that each row must have; 0: those that are read.
};

/// Returns whether this is the row of units or an empty line. A row of empty cells and "nan" is one of undefined numbers.
bool is_row_of_units(const std::vector<TextCell>& cells, char separator) {
  bool has_text = cells.size() <= 1;
  for (const TextCell& cell : cells) {
    bool is_number = false;
    if (!std::isnan(number_of(cell.text, separator, is_number))) return false;
    has_text = has_text || !is_number;
  }
  return has_text;
}

std::optional<Names> find_names(const Beginning& beginning) {
  for (std::size_t line = 0; line < beginning.lines.size(); ++line) {
    const char separator = separator_of(beginning.lines[line]);
    const auto names = cells_of(beginning.lines[line], separator);
    std::vector<TextCell> units;
    const bool has_next = line + 1 < beginning.lines.size();
    if (has_next) units = cells_of(beginning.lines[line + 1], separator);
    const bool has_units = has_next && is_row_of_units(units, separator);
    NamedColumns columns = named_columns(names, has_units ? units : std::vector<TextCell>());
    if (columns.plates.empty()) continue;
    return Names{.line = line, .separator = separator, .columns = std::move(columns), .first_row = line + (has_units ? 3 : 2)};
  }
  return std::nullopt;
}

std::optional<Names> find_opensim_names(const Beginning& beginning) {
  const auto end = std::ranges::find_if(beginning.lines, is_opensim_end);
  if (end == beginning.lines.end() || end + 1 == beginning.lines.end()) return std::nullopt;
  const auto line = static_cast<std::size_t>(end - beginning.lines.begin()) + 1;
  // A tab ends a cell, so that a cell may be empty; between spaces, none may be: it would move those behind it.
  const auto separator_at = [&](std::size_t number) { return beginning.lines[number].find('\t') != std::string::npos ? '\t' : ' '; };
  const auto cells = cells_of(beginning.lines[line], separator_at(line));
  const char separator = line + 1 < beginning.lines.size() ? separator_at(line + 1) : ' ';
  return Names{.line = line,
               .separator = separator,
               .columns = opensim_columns(cells),
               .first_row = line + 2,
               .row_cells = separator == ' ' ? cells.size() : 0};
}

/// Returns the first number above 0 behind a key in the lines before the names: "Rate (Hz):<tab>1000", "nRows=100". The key is the first
/// text of its line, so that "Generated: 2014" is no rate.
std::optional<double> fact_of(const Beginning& beginning, const Names& names, std::string_view key, char separator) {
  for (std::size_t line = 0; line < names.line; ++line) {
    const std::string text = lower(beginning.lines[line]);
    const std::size_t begin = text.find_first_not_of(" \t\"");
    if (begin == std::string::npos || !std::string_view(text).substr(begin).starts_with(key)) continue;
    std::string rest = beginning.lines[line].substr(begin + key.size());
    if (!rest.empty() && std::isalpha(static_cast<unsigned char>(rest.front())) != 0) continue;
    std::ranges::replace(rest, ':', separator);
    std::ranges::replace(rest, '=', separator);
    for (const TextCell& cell : cells_of(rest, separator)) {
      bool is_number = false;
      const double value = number_of(cell.text, separator, is_number);
      if (is_number && value > 0.0) return value;
    }
  }
  return std::nullopt;
}

/// The columns of one plate in the numbers that were read.
struct TextPlate {
  std::array<std::optional<std::pair<std::size_t, double>>, 10> values;  ///< Index and scale: F, M, COP, free moment.
  bool is_cop_of_file = false;
};

struct TextContents {
  std::vector<std::vector<double>> columns;
  std::vector<TextPlate> plates;
  std::size_t vertical = 2;
};

ForceSample text_sample(const TextContents& contents, std::size_t index, std::size_t row) {
  const TextPlate& plate = contents.plates[index];
  std::array<double, 10> values{};
  for (std::size_t k = 0; k < values.size(); ++k) {
    values[k] = plate.values[k] ? contents.columns[plate.values[k]->first][row] * plate.values[k]->second : core::kNaN;
  }
  ForceSample sample{.force_n = {values[0], values[1], values[2]},
                     .moment_nm = {values[3], values[4], values[5]},
                     .cop_mm = {values[6], values[7], values[8]},
                     .free_moment_nm = values[9]};
  if (plate.is_cop_of_file) {
    const bool is_on_surface = contents.vertical == 2 && !plate.values[8] && std::isfinite(sample.cop_mm[0] + sample.cop_mm[1]);
    if (is_on_surface) sample.cop_mm[2] = 0.0;
    return sample;
  }
  const auto point = physics::force_point({.force_n = sample.force_n, .moment_nm = sample.moment_nm});
  sample.cop_mm = {point.x_mm, point.y_mm, 0.0};
  if (!plate.values[9]) sample.free_moment_nm = point.free_moment_nm;
  return sample;
}

/// Collects the columns to read, each once.
class Wanted {
 public:
  std::size_t add(const ColumnPlace& column) {
    const auto found = std::ranges::find(places, column.place);
    if (found != places.end()) return static_cast<std::size_t>(found - places.begin());
    places.push_back(column.place);
    return places.size() - 1;
  }
  std::vector<std::size_t> places;
};

TextPlate text_plate(const PlateColumns& columns, bool is_opensim, Wanted& wanted) {
  TextPlate plate;
  const auto add = [&](std::size_t index, const std::optional<ColumnPlace>& column) {
    if (column) plate.values.at(index) = {wanted.add(*column), column->scale};
  };
  const bool is_about_surface = columns.surface_moment[0] && columns.surface_moment[1];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    add(axis, columns.force.at(axis));
    add(3 + axis, is_about_surface && columns.surface_moment.at(axis) ? columns.surface_moment.at(axis) : columns.moment.at(axis));
  }
  add(9, columns.free_moment);
  plate.is_cop_of_file = is_opensim || !(columns.force[2] && plate.values[3] && plate.values[4]);
  if (!plate.is_cop_of_file) return plate;
  for (std::size_t axis = 0; axis < 3; ++axis) add(6 + axis, columns.cop.at(axis));
  return plate;
}

/// Returns the rate of times that may be rounded, or repeated (Motive repeats the time of its frame); 0 if they do not rise.
double rate_of(const std::vector<double>& t_s) {
  const auto last = std::ranges::find(t_s, t_s.back());  // the first row of the last time
  const double rate_hz = static_cast<double>(last - t_s.begin()) / (t_s.back() - t_s.front());
  if (!(rate_hz > 0.0) || !std::isfinite(rate_hz)) return 0.0;
  const double whole_hz = std::round(rate_hz);
  return std::abs(rate_hz - whole_hz) < kWholeRate * rate_hz && whole_hz > 0.0 ? whole_hz : rate_hz;
}

/// Sets times and rate. Returns why it cannot.
std::optional<std::string> set_times(ForceFile& facts, std::optional<double> stated_hz, std::vector<double> t_s) {
  bool is_rising = true;
  for (std::size_t row = 0; row < t_s.size(); ++row) {
    if (std::isnan(t_s[row])) return "row " + std::to_string(row + 1) + " has no time";
    if (row > 0 && t_s[row] < t_s[row - 1]) return "row " + std::to_string(row + 1) + ": the time is less than in the row before";
    is_rising = is_rising && (row == 0 || t_s[row] > t_s[row - 1]);
  }
  const double found_hz = t_s.size() > 1 ? rate_of(t_s) : 0.0;
  facts.rate_hz = stated_hz && (facts.format == "bioware" || found_hz <= 0.0) ? *stated_hz : found_hz;
  if (!(facts.rate_hz > 0.0)) return "there is no rate: no column of times, and no line with the rate";
  if (stated_hz && is_rising && found_hz > 0.0 && std::abs(*stated_hz - found_hz) > kSameRate * found_hz) {
    facts.warnings.push_back("the file states " + core::number_text(*stated_hz) + " Hz, but its times have " + core::number_text(found_hz) +
                             " Hz: " + core::number_text(facts.rate_hz) + " Hz is used");
  }
  if (is_rising && !t_s.empty()) facts.t_s = std::move(t_s);
  return std::nullopt;
}

std::string format_name(TextFormat format, const Beginning& beginning) {
  switch (format) {
    case TextFormat::BioWare: return "bioware";
    case TextFormat::Motive: return "motive";
    case TextFormat::OpenSim: return "opensim";
    case TextFormat::Columns: break;
  }
  const bool is_bertec =
      std::ranges::any_of(beginning.lines, [](const std::string& line) { return lower(line).find("bertec") != std::string::npos; });
  return is_bertec ? "bertec" : "columns";
}

void add_warnings(ForceFile& facts, TextFormat format, const std::vector<PlateColumns>& plates, const TextContents& contents) {
  for (std::size_t k = 0; k < plates.size(); ++k) {
    PlateFacts& plate = facts.plates.emplace_back();
    const TextPlate& read = contents.plates[k];
    plate.has_force = read.values[0] || read.values[1] || read.values[2];
    if (format != TextFormat::BioWare) continue;
    if (read.is_cop_of_file && plates[k].has_cop())
      plate.warnings.emplace_back("Ax and Ay may be relative to their own mean: BioWare does not say");
    const bool is_about_surface = plates[k].surface_moment[0] && plates[k].surface_moment[1];
    if (plates[k].moment[0] && !is_about_surface) plate.warnings.emplace_back("the file does not say about which point Mx and My are");
  }
}

}  // namespace

std::optional<TextFormat> text_format(const Beginning& beginning) {
  if (beginning.lines.empty()) return std::nullopt;
  const auto opensim = find_opensim_names(beginning);
  if (opensim) return opensim->columns.plates.empty() ? std::nullopt : std::optional(TextFormat::OpenSim);
  if (beginning.lines.front().starts_with("BioWare")) return TextFormat::BioWare;
  const auto names = find_names(beginning);
  if (!names) return std::nullopt;
  return lower(beginning.lines[names->line]).find("mocapframe") != std::string::npos ? TextFormat::Motive : TextFormat::Columns;
}

core::Result<ForceFile> read_text_export(const std::string& file, const Beginning& beginning, TextFormat format) {
  const bool is_opensim = format == TextFormat::OpenSim;
  const auto names = is_opensim ? find_opensim_names(beginning) : find_names(beginning);
  if (!names) return unreadable(file, "no line has the names of a force plate's columns (Fx, Fy, Fz)", "export the file again");
  Wanted wanted;
  const auto contents = std::make_shared<TextContents>();
  contents->vertical = is_opensim ? 1 : 2;
  for (const PlateColumns& plate : names->columns.plates) contents->plates.push_back(text_plate(plate, is_opensim, wanted));
  if (names->columns.time) wanted.add(*names->columns.time);
  DTS_TRY_ASSIGN(auto read, read_columns(file, names->first_row, names->separator, wanted.places, names->row_cells));
  contents->columns = std::move(read.columns);

  ForceFile facts{.format = format_name(format, beginning), .samples = contents->columns.front().size()};
  facts.axes = is_opensim ? Axes::Laboratory : Axes::Plate;
  facts.vertical = contents->vertical;
  facts.warnings = std::move(read.warnings);
  std::vector<double> t_s;
  if (names->columns.time) {
    t_s = std::move(contents->columns[wanted.add(*names->columns.time)]);
    for (double& time_s : t_s) time_s *= names->columns.time->scale;
  }
  std::optional<double> stated_hz;
  for (const char* const key : {"rate", "sampling rate", "sample rate"}) {
    if (!stated_hz) stated_hz = fact_of(beginning, *names, key, names->separator);
  }
  if (const auto wrong = set_times(facts, stated_hz, std::move(t_s))) {
    return unreadable(file, *wrong, "export the file again, with times");
  }
  const auto stated = is_opensim ? fact_of(beginning, *names, "nrows", ' ') : std::nullopt;
  if (stated && *stated != static_cast<double>(facts.samples)) {
    facts.warnings.push_back("nRows is not the number of rows: the file has " + std::to_string(facts.samples));
  }
  add_warnings(facts, format, names->columns.plates, *contents);
  facts.sample_at = [contents](std::size_t plate, std::size_t sample) { return text_sample(*contents, plate, sample); };
  return facts;
}

}  // namespace dts::lab::force
