// SPDX-License-Identifier: Apache-2.0
// `dtslab force`: the wrench and the centre of pressure in a file of force plates.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/table.h"
#include "cli/validators.h"
#include "core/number_text.h"
#include "files/whole_file.h"
#include "lab/base/command.h"
#include "lab/base/problems.h"
#include "lab/force/force_commands.h"
#include "lab/force/force_file.h"
#include "lab/force/plate_to_c3d.h"
#include "lab/force/plate_view.h"
#include "lab/force/sign_check.h"

namespace dts::lab::force {
namespace {

struct ForceArguments {
  std::string file;
  std::size_t plate = 1;
  std::string axes;  ///< Empty: those of the file.
  std::string zero = "none";
  std::string polynomial = "none";
  double least_force_n = kDefaultLeastForceN;
  std::string plate_file;
  std::string csv;
  std::string c3d;
  bool is_json = false;
};

constexpr std::size_t kTextAtOnce = std::size_t{1} << 20U;

/// A value of a sample and its name.
struct Column {
  const char* name;
  double (*value)(const ForceSample& sample);
};
constexpr std::array<Column, 10> kColumns{{{"fx_n", [](const ForceSample& sample) { return sample.force_n[0]; }},
                                           {"fy_n", [](const ForceSample& sample) { return sample.force_n[1]; }},
                                           {"fz_n", [](const ForceSample& sample) { return sample.force_n[2]; }},
                                           {"mx_nm", [](const ForceSample& sample) { return sample.moment_nm[0]; }},
                                           {"my_nm", [](const ForceSample& sample) { return sample.moment_nm[1]; }},
                                           {"mz_nm", [](const ForceSample& sample) { return sample.moment_nm[2]; }},
                                           {"copx_mm", [](const ForceSample& sample) { return sample.cop_mm[0]; }},
                                           {"copy_mm", [](const ForceSample& sample) { return sample.cop_mm[1]; }},
                                           {"copz_mm", [](const ForceSample& sample) { return sample.cop_mm[2]; }},
                                           {"tz_nm", [](const ForceSample& sample) { return sample.free_moment_nm; }}}};
using Means = std::array<double, kColumns.size()>;

/// Appends the shortest text that reads back as the same number; nothing for an undefined one. `add_csv_number` has 9 digits, which may
/// round to another float32 than the number itself.
void append_number(std::string& text, double value) {
  if (!std::isfinite(value)) return;
  std::array<char, 32> digits{};
  text.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
}

core::Status write_csv(const ForceFile& file, const PlateView& view, const std::string& out) {
  DTS_TRY_ASSIGN(auto writer, files::WholeFileWriter::create(out));
  std::string text = "t_s";
  for (const Column& column : kColumns) text += std::string(",") + column.name;
  text += '\n';
  for (std::size_t k = 0; k < file.samples; ++k) {
    append_number(text, file.time_s(k));
    const ForceSample sample = view.at(k);
    for (const Column& column : kColumns) {
      text += ',';
      append_number(text, column.value(sample));
    }
    text += '\n';
    if (text.size() < kTextAtOnce) continue;
    DTS_TRY(writer.append(text));
    text.clear();
  }
  DTS_TRY(writer.append(text));
  return writer.commit();
}

/// What the command shows of a plate.
struct PlateReport {
  Means means{};  ///< Over loaded samples; NaN where there is none.
  std::size_t loaded = 0;
};

PlateReport report_of(const ForceFile& file, std::size_t plate, Axes axes, double least_force_n) {
  PlateReport report;
  std::array<std::size_t, kColumns.size()> counts{};
  const PlateView view(file, plate, axes, least_force_n);
  for (std::size_t k = 0; file.plates[plate].is_usable && k < file.samples; ++k) {
    const auto sample = view.loaded_at(k);
    if (!sample) continue;
    ++report.loaded;
    for (std::size_t column = 0; column < kColumns.size(); ++column) {
      const double value = kColumns[column].value(*sample);
      if (!std::isfinite(value)) continue;
      report.means[column] += value;
      ++counts[column];
    }
  }
  for (std::size_t column = 0; column < kColumns.size(); ++column) {
    report.means[column] = counts[column] == 0 ? core::kNaN : report.means[column] / static_cast<double>(counts[column]);
  }
  return report;
}

cli::Json number_json(double value) { return std::isfinite(value) ? cli::Json(value) : cli::Json(nullptr); }

template <class Numbers>
cli::Json list_json(const Numbers& numbers) {
  cli::Json list = cli::Json::array();
  for (const auto number : numbers) list.push_back(number);
  return list;
}

double length_mm(const Vector& from, const Vector& to) { return std::hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]); }

cli::Json to_json(const ForceFile& file, std::size_t index, const PlateReport& report) {
  const PlateFacts& plate = file.plates[index];
  cli::Json json{{"plate", index + 1}};
  json["type"] = plate.c3d_type ? cli::Json(*plate.c3d_type) : cli::Json(nullptr);
  json["usable"] = plate.is_usable;
  json["zero_frames"] = file.zero_frames ? list_json(*file.zero_frames) : cli::Json(nullptr);
  json["zero_applied"] = plate.is_zero_applied;
  json["origin_mm"] = plate.origin_mm ? list_json(*plate.origin_mm) : cli::Json(nullptr);
  json["corners_mm"] = nullptr;
  json["size_mm"] = nullptr;
  if (plate.corners_mm) {
    json["corners_mm"] = cli::Json::array();
    for (const Vector& corner : *plate.corners_mm) json["corners_mm"].push_back(list_json(corner));
    const c3d::Corners& corners = *plate.corners_mm;
    json["size_mm"] = {length_mm(corners[0], corners[1]), length_mm(corners[0], corners[3])};
  }
  json["cop_poly"] = nullptr;
  if (plate.polynomial) json["cop_poly"] = {{"x", list_json(plate.polynomial->x)}, {"y", list_json(plate.polynomial->y)}};
  json["cop_poly_applied"] = plate.is_polynomial_applied;
  json["loaded_samples"] = report.loaded;
  json["mean"] = cli::Json::object();
  for (std::size_t column = 0; column < kColumns.size(); ++column) json["mean"][kColumns[column].name] = number_json(report.means[column]);
  json["warnings"] = plate.warnings;
  return json;
}

cli::Json to_json(const ForceFile& file, const std::vector<PlateReport>& reports, const std::vector<std::string>& warnings, Axes axes) {
  cli::Json json{{"format", file.format}, {"rate_hz", file.rate_hz}, {"samples", file.samples}};
  json["point_rate_hz"] = file.point_rate_hz ? cli::Json(*file.point_rate_hz) : cli::Json(nullptr);
  json["axes"] = axes == Axes::Plate ? "plate" : "lab";
  json["events"] = file.events.size();
  json["warnings"] = warnings;
  json["plates"] = cli::Json::array();
  for (std::size_t plate = 0; plate < reports.size(); ++plate) json["plates"].push_back(to_json(file, plate, reports[plate]));
  return json;
}

void print(const ForceFile& file, const std::vector<PlateReport>& reports, Axes axes, cli::Console& console) {
  console.out << file.format << ", " << file.samples << " samples at " << core::number_text(file.rate_hz) << " Hz, axes of the "
              << (axes == Axes::Plate ? "plate" : "laboratory") << ", means over loaded samples\n\n";
  cli::Table table({"PLATE", "TYPE", ">LOADED", ">FX (N)", ">FY (N)", ">FZ (N)", ">COP X (mm)", ">COP Y (mm)", ">TZ (N m)"});
  const auto text = [](double value, int decimals) { return std::isfinite(value) ? cli::decimal(value, decimals) : std::string("-"); };
  for (std::size_t plate = 0; plate < reports.size(); ++plate) {
    const auto& type = file.plates[plate].c3d_type;
    const Means& means = reports[plate].means;
    table.add({{std::to_string(plate + 1)},
               {type ? std::to_string(*type) : "-"},
               {std::to_string(reports[plate].loaded)},
               {text(means[0], 2)},
               {text(means[1], 2)},
               {text(means[2], 2)},
               {text(means[6], 2)},
               {text(means[7], 2)},
               {text(means[9], 3)}});
  }
  table.print(console);
}

/// Prints the error in one line: contract-plates.md allows no second line.
int fail_in_one_line(cli::Console& console, const core::Error& error, int status = cli::kFailed) {
  cli::print_error(console, error.hint.empty() ? error.what : error.what + "; " + error.hint);
  console.failure->code = static_cast<int>(error.code);
  return status;
}

core::Result<Axes> axes_of(const ForceArguments& arguments, ForceFile& file) {
  if (arguments.axes.empty()) return file.axes;
  const Axes axes = arguments.axes == "lab" ? Axes::Laboratory : Axes::Plate;
  if (axes == Axes::Plate && file.axes == Axes::Laboratory) {
    file.warnings.emplace_back("OpenSim files are in the axes of the laboratory: --axes plate has no effect");
    return file.axes;
  }
  if (axes == file.axes) return axes;
  if (file.format != "c3d") {
    return core::fail(core::ErrorCode::InvalidArgument, arguments.file + ": the file does not say where the plate is", "use --axes plate");
  }
  for (PlateFacts& plate : file.plates) {
    if (plate.is_usable && !place_of(plate)) plate.warnings.emplace_back("CORNERS do not span a plane: no axes of the laboratory");
  }
  return axes;
}

/// Returns all warnings, those of a plate with its number.
std::vector<std::string> all_warnings(const ForceFile& file) {
  std::vector<std::string> all = file.warnings;
  for (std::size_t plate = 0; plate < file.plates.size(); ++plate) {
    for (const std::string& warning : file.plates[plate].warnings) all.push_back("plate " + std::to_string(plate + 1) + ": " + warning);
  }
  return all;
}

bool is_same_path(const std::string& a, const std::string& b) {
  const auto path = [](const std::string& name) {
    std::error_code none;
    return std::filesystem::weakly_canonical(std::filesystem::absolute(name, none), none);
  };
  return path(a) == path(b);
}

int run_force(const ForceArguments& arguments, cli::Console& console) {
  if (!arguments.csv.empty() && !arguments.c3d.empty() && is_same_path(arguments.csv, arguments.c3d)) {
    return fail_in_one_line(console,
                            {core::ErrorCode::InvalidArgument, "--csv and --to both name the file " + arguments.csv, "write to two files"},
                            cli::kUsage);
  }
  for (const std::string& out : {arguments.csv, arguments.c3d}) {
    if (out.empty()) continue;
    if (const auto apart = check_out(out, {arguments.file, arguments.plate_file}); !apart) {
      return fail_in_one_line(console, apart.error(), cli::kUsage);
    }
  }
  auto file = read_force_file(arguments.file, {.is_zero_of_file = arguments.zero == "file",
                                               .is_polynomial_of_file = arguments.polynomial == "file",
                                               .plate_file = arguments.plate_file});
  if (!file) return fail_in_one_line(console, file.error());
  if (arguments.plate > file->plates.size()) {
    return fail_in_one_line(
        console,
        {core::ErrorCode::InvalidArgument,
         arguments.file + " has " + std::to_string(file->plates.size()) + " plates, --plate is " + std::to_string(arguments.plate),
         "give a plate from 1"},
        cli::kUsage);
  }
  if (arguments.zero == "file" && file->format != "c3d") file->warnings.emplace_back("--zero file has no effect: only C3D has ZERO");
  const auto axes = axes_of(arguments, *file);
  if (!axes) return fail_in_one_line(console, axes.error(), cli::kUsage);
  std::vector<PlateReport> reports;
  for (std::size_t plate = 0; plate < file->plates.size(); ++plate) {
    reports.push_back(report_of(*file, plate, *axes, arguments.least_force_n));
  }
  add_sign_warnings(*file, arguments.least_force_n);
  if (!arguments.csv.empty()) {
    const PlateView view(*file, arguments.plate - 1, *axes, arguments.least_force_n);
    if (const auto written = write_csv(*file, view, arguments.csv); !written) return fail_in_one_line(console, written.error());
  }
  if (!arguments.c3d.empty()) {
    const auto written = write_c3d(*file, arguments.least_force_n, arguments.c3d, file->warnings);
    if (!written) return fail_in_one_line(console, written.error());
  }
  const std::vector<std::string> warnings = all_warnings(*file);
  if (arguments.is_json) {
    console.out << cli::document(to_json(*file, reports, warnings, *axes));
  } else {
    print(*file, reports, *axes, console);
  }
  for (const std::string& warning : warnings) warn(console, warning);
  return cli::kOk;
}

}  // namespace

void add_force(cli::CommandLine& line) {
  const auto [command, arguments] =
      add_command(line, line.app, "force",
                  "Read the force plates in a file: forces, moments about the surface, centre of pressure, free moment. The sign of the "
                  "file is kept; a warning says when signs contradict each other",
                  "dtslab force walk.c3d | the plates of a file, and what is doubtful\n"
                  "dtslab force walk.c3d --plate 2 --axes lab --csv plate2.csv | one plate in the axes of the laboratory\n"
                  "dtslab force jump.txt --json | a text export of BioWare, for a program\n"
                  "dtslab force volts.csv --plate-file plate.toml --csv force.csv | volts of a DAQ\n"
                  "dtslab force walk.mot --to walk.c3d | as C3D\n",
                  run_force);
  command
      .add_option("FILE", arguments.file,
                  "C3D, BioWare .txt, Motive or Bertec .csv, OpenSim .mot or .sto; or, with --plate-file, CSV with t_s,c1,.. in volts")
      ->required()
      ->option_text(" ");
  command.add_option("--plate", arguments.plate, "Plate for --csv, counted from 1; default: 1")
      ->option_text("N")
      ->check(cli::whole_number_between(1, 255));
  command.add_option("--axes", arguments.axes, "plate or lab; default: plate, OpenSim: lab")
      ->option_text("NAME")
      ->check(CLI::IsMember({"plate", "lab"}));
  command.add_option("--zero", arguments.zero, "file: subtract the mean of the frames in FORCE_PLATFORM:ZERO (C3D); default: none")
      ->option_text("NAME")
      ->check(CLI::IsMember({"none", "file"}));
  command.add_option("--min-force", arguments.least_force_n, "Below this vertical force there is no centre of pressure; default: 20")
      ->option_text("N")
      ->check(cli::number_between(0.0, 1e6, "newtons"));
  command.add_option("--cop-poly", arguments.polynomial, "file: correct the centre of pressure with FPCOPPOLY (C3D); default: none")
      ->option_text("NAME")
      ->check(CLI::IsMember({"none", "file"}));
  command.add_option("--plate-file", arguments.plate_file, "File with the table [force_plate], for raw channels")
      ->option_text("PLATE.toml");
  command.add_option("--csv", arguments.csv, "File to write: one row for each sample; empty cells where a value is undefined")
      ->option_text("OUT.csv")
      ->check(cli::text_of(1, 4096));
  command.add_option("--to", arguments.c3d, "C3D file to write: all plates as type 1, with events")
      ->option_text("OUT.c3d")
      ->check(cli::text_of(1, 4096));
  add_json(command, arguments.is_json);
}

}  // namespace dts::lab::force
