// SPDX-License-Identifier: Apache-2.0
#include "lab/compare/compare_command.h"

#include <cmath>
#include <filesystem>
#include <string>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/table.h"
#include "lab/base/command.h"
#include "lab/base/problems.h"
#include "lab/compare/compare.h"

namespace dts::lab::compare {
namespace {

struct Arguments {
  std::string first;  ///< Recordings.
  std::string second;
  force::CopChoice cop;  ///< Of files of force plates.
  bool is_json = false;
};

using cli::decimal;

cli::Json to_json(const AxisDifference& axis) {
  cli::Json json = cli::Json::object();
  cli::set_number(json, "rmse_mm", axis.rmse_mm);
  cli::set_number(json, "rmse_mean_removed_mm", axis.rmse_mean_removed_mm);
  cli::set_number(json, "mean_difference_mm", axis.mean_difference_mm);
  cli::set_number(json, "largest_mm", axis.largest_mm);
  cli::set_number(json, "largest_mean_removed_mm", axis.largest_mean_removed_mm);
  cli::set_number(json, "correlation", axis.correlation);
  return json;
}

cli::Json to_json(const Comparison& comparison) {
  const Alignment& alignment = comparison.alignment;
  cli::Json aligned{{"by", name(alignment.means)}};
  cli::set_number(aligned, "offset_s", alignment.offset_s);
  cli::set_number(aligned, "offset_sd_s", alignment.offset_sd_s);
  cli::set_number(aligned, "drift_ppm", alignment.drift_ppm);
  cli::set_number(aligned, "drift_sd_ppm", alignment.drift_sd_ppm);
  cli::set_number(aligned, "reference_s", alignment.reference_s);
  cli::set_number(aligned, "peak_correlation", alignment.peak_correlation);
  if (!alignment.warning.empty()) aligned["warning"] = alignment.warning;
  if (alignment.event_count > 0) aligned["events"] = alignment.event_count;
  cli::Json json{{"alignment", aligned}, {"overlap_s", comparison.overlap_s}, {"scans", comparison.scan_count}};
  cli::set_number(json, "correlation", comparison.correlation);
  json["x"] = to_json(comparison.x);
  json["y"] = to_json(comparison.y);
  cli::set_number(json, "rmse_total_mm", comparison.rmse_total_mm);
  cli::set_number(json, "rmse_total_mean_removed_mm", comparison.rmse_total_mean_removed_mm);
  return json;
}

std::string with_deviation(double value, double deviation, int decimals, const std::string& unit) {
  return decimal(value, decimals) + " +- " + decimal(deviation, decimals) + " " + unit;
}

void print(const Comparison& comparison, cli::Console& console) {
  const Alignment& alignment = comparison.alignment;
  console.out << "aligned by " << name(alignment.means);
  if (alignment.event_count > 0) console.out << " (" << alignment.event_count << (alignment.event_count == 1 ? " event)" : " events)");
  console.out << ": add " << with_deviation(alignment.offset_s, alignment.offset_sd_s, 4, "s") << " to the times of B";
  if (std::isfinite(alignment.drift_ppm)) {
    console.out << ", whose clock is " << with_deviation(alignment.drift_ppm, alignment.drift_sd_ppm, 1, "ppm") << " slow";
  }
  console.out << "\ncompared: " << comparison.scan_count << " scans over " << decimal(comparison.overlap_s, 2) << " s\n\n";
  cli::Table table({"AXIS", ">RMSE (mm)", ">MEAN REMOVED (mm)", ">B - A (mm)", ">LARGEST (mm)", ">MEAN REMOVED (mm)", ">CORRELATION"});
  const auto add = [&](const char* axis, const AxisDifference& of) {
    table.add({{axis},
               {decimal(of.rmse_mm, 3)},
               {decimal(of.rmse_mean_removed_mm, 3)},
               {decimal(of.mean_difference_mm, 3)},
               {decimal(of.largest_mm, 3)},
               {decimal(of.largest_mean_removed_mm, 3)},
               {decimal(of.correlation, 4)}});
  };
  add("x", comparison.x);
  add("y", comparison.y);
  table.add({{"both"}, {decimal(comparison.rmse_total_mm, 3)}, {decimal(comparison.rmse_total_mean_removed_mm, 3)}});
  table.print(console);
}

void print_warnings(const Comparison& comparison, cli::Console& console) {
  if (!comparison.alignment.warning.empty()) warn(console, comparison.alignment.warning);
  const bool is_opposed = comparison.x.correlation < 0.0 || comparison.y.correlation < 0.0;
  if (comparison.correlation > kLeastCorrelation && !is_opposed) return;
  warn(console, "the recordings do not agree: correlation " + decimal(comparison.correlation, 2) + " (x " +
                    decimal(comparison.x.correlation, 2) + ", y " + decimal(comparison.y.correlation, 2) +
                    "); check that the axes are the same and that both are of the same trial");
}

int run_compare(const Arguments& arguments, cli::Console& console) {
  files::Problems problems;
  const Recording a = read_recording(arguments.first, arguments.cop, problems);
  const Recording b = read_recording(arguments.second, arguments.cop, problems);
  if (!problems.empty()) return report_problems(console, problems);
  if (std::error_code none;
      std::filesystem::equivalent(arguments.first, arguments.second, none) && force::has_plates(arguments.first, arguments.cop)) {
    return fail_with(
        console, core::Error{core::ErrorCode::InvalidArgument, "A and B are the same plate: --plate counts for both",
                             "write each plate as CSV and compare these: dtslab force " + arguments.first + " --plate 2 --csv plate2.csv"});
  }
  const auto comparison = compare(a, b);
  if (!comparison) return fail_with(console, comparison.error());
  if (arguments.is_json) {
    console.out << cli::document(to_json(*comparison));
  } else {
    print(*comparison, console);
  }
  print_warnings(*comparison, console);
  return cli::kOk;
}

}  // namespace

void add_commands(cli::CommandLine& line) {
  const auto [command, arguments] =
      add_command(line, line.app, "compare", "Align two recordings of the centre of pressure and show their difference",
                  "dtslab compare plate.csv force_plate.csv | as thesis Table 4.2\n"
                  "dtslab compare session.xdf force_plate.csv --json | a recording of dtsd, for a program\n"
                  "dtslab compare session.xdf standing.c3d --ml +x --ap -y | beside a force plate in a C3D file\n",
                  run_compare);
  command
      .add_option("A", arguments.first,
                  "XDF recording, file of force plates, or CSV file with t_s,x_mm,y_mm (or ml_mm,ap_mm) and optionally trigger or marker")
      ->required()
      ->option_text(" ");
  command
      .add_option("B", arguments.second,
                  "Second recording, like A; rate and clock may differ. --plate, --ml and --ap count for A and B: if their plates differ, "
                  "write one "
                  "or both in the axes of the laboratory first: dtslab force FILE --plate N --axes lab --csv OUT.csv")
      ->required()
      ->option_text(" ");
  force::add_cop_choice(command, arguments.cop);
  add_json(command, arguments.is_json);
}

}  // namespace dts::lab::compare
