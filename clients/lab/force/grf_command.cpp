// SPDX-License-Identifier: Apache-2.0
// `dtslab grf`: the horizontal force of the ground, from a centre of pressure alone.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/table.h"
#include "core/number_text.h"
#include "files/whole_file.h"
#include "lab/base/command.h"
#include "lab/base/csv.h"
#include "lab/base/position_columns.h"
#include "lab/base/problems.h"
#include "lab/force/force_commands.h"
#include "posturography/ground_reaction.h"

namespace dts::lab::force {
namespace {

using posturography::GroundReaction;

struct Arguments {
  std::string file;
  double height_m = 0.0;
  std::string csv;
  bool is_json = false;
};

/// The error to expect: RMSE over RMS of the force that a plate measured, median of 6 recordings of quiet standing of Santos & Duarte
/// (2016) in that band, the larger axis.
struct Expected {
  double from_hz;
  double to_hz;
  double rmse_over_rms;
};
constexpr std::array kExpected{Expected{0.1, 0.2, 0.91}, Expected{0.2, 1.0, 0.12}, Expected{1.0, 2.0, 0.38}};
constexpr double kExpectedOverall = 0.20;

/// A load that varies more than this part of its mean is not quiet standing.
constexpr double kMostLoadVariation = 0.05;

std::string table_text(const std::vector<double>& t_s, const posturography::CopSeries& series, const GroundReaction& force) {
  std::string text = "t_s,fx_n,fy_n,fz_n\n";
  for (std::size_t i = 0; i < force.ml_n.size(); ++i) {
    text += core::number_text(t_s.front() + static_cast<double>(i) / series.rate_hz);
    for (const double value : {force.ml_n[i], force.ap_n[i], series.load_n[i]}) add_csv_number(text, value);
    text += '\n';
  }
  return text;
}

std::vector<std::string> warnings_of(const posturography::CopSeries& series, const GroundReaction& force) {
  std::vector<std::string> warnings;
  if (force.supported + 2 * static_cast<std::size_t>(std::ceil(posturography::kForceMarginS * series.rate_hz)) < force.ml_n.size()) {
    warnings.emplace_back("parts without load or with gaps have no result");
  }
  if (force.load_sd_n > kMostLoadVariation * force.mass_kg * posturography::kGravity) {
    warnings.emplace_back("the load varies by more than 5 %: this is not quiet standing, and the result means little");
  }
  return warnings;
}

cli::Json to_json(const GroundReaction& force, const std::vector<std::string>& warnings) {
  cli::Json json{{"band_hz", {posturography::kLowestForceHz, posturography::kHighestForceHz}}};
  cli::set_number(json, "effective_length_m", force.effective_length_m);
  cli::set_number(json, "mass_kg", force.mass_kg);
  cli::set_number(json, "expected_rmse_over_rms", kExpectedOverall);
  cli::Json bands = cli::Json::array();
  for (const Expected& band : kExpected) {
    bands.push_back({{"band_hz", {band.from_hz, band.to_hz}}, {"expected_rmse_over_rms", band.rmse_over_rms}});
  }
  json["bands"] = bands;
  json["supported_samples"] = force.supported;
  json["warnings"] = warnings;
  return json;
}

void print(const GroundReaction& force, cli::Console& console) {
  console.out << "horizontal force from the centre of pressure: " << cli::decimal(force.mass_kg, 1) << " kg, pendulum of "
              << cli::decimal(force.effective_length_m, 3) << " m\n\n";
  cli::Table table({"BAND (Hz)", ">EXPECTED ERROR (RMSE / RMS)"});
  for (const Expected& band : kExpected) {
    table.add({{cli::decimal(band.from_hz, 1) + " to " + cli::decimal(band.to_hz, 1)}, {cli::decimal(band.rmse_over_rms, 2)}});
  }
  table.print(console);
}

int run_grf(const Arguments& arguments, cli::Console& console) {
  const auto apart = check_out(arguments.csv, {arguments.file});
  if (!apart) return fail_with(console, apart.error());
  files::Problems problems;
  std::vector<CsvColumn> columns{{.name = "t_s"}, {.name = "load_n", .may_be_empty = true}};
  add_position_columns(columns);
  const CsvTable table = CsvTable::read(arguments.file, columns, problems);
  const auto position = position_columns(arguments.file, table, problems);
  if (!problems.empty() || !position) return report_problems(console, problems);
  const std::vector<double>& t_s = table.numbers("t_s");
  const auto series = posturography::even_series(t_s, table.numbers(position->ml), table.numbers(position->ap), table.numbers("load_n"));
  if (!series) return fail_with(console, series.error());
  const auto force = posturography::ground_reaction(*series, arguments.height_m);
  if (!force) return fail_with(console, force.error());
  const auto written = files::write_whole_file(arguments.csv, table_text(t_s, *series, *force));
  if (!written) return fail_with(console, written.error());
  const std::vector<std::string> warnings = warnings_of(*series, *force);
  if (arguments.is_json) {
    console.out << cli::document(to_json(*force, warnings));
  } else {
    print(*force, console);
  }
  for (const std::string& warning : warnings) warn(console, warning);
  return cli::kOk;
}

}  // namespace

void add_grf(cli::CommandLine& line) {
  const auto [command, arguments] = add_command(
      line, line.app, "grf",
      "Estimate the horizontal force of the ground on a standing person from the centre of pressure, between 0.1 and 2 Hz. The person "
      "counts as an inverted pendulum. The estimate has no constant part, no step, and no force of one foot against the other",
      "dtslab grf standing.csv --height 1.75 --csv force.csv | a person of 1.75 m\n", run_grf);
  command
      .add_option("FILE", arguments.file,
                  "CSV file with columns t_s,x_mm,y_mm,load_n or t_s,ml_mm,ap_mm,load_n, as dtsctl session export writes it")
      ->required()
      ->option_text(" ");
  command.add_option("--height", arguments.height_m, "Body height in metres")->option_text("M")->required();
  command.add_option("--csv", arguments.csv, "File to write: t_s,fx_n,fy_n,fz_n; empty cells where there is no result")
      ->option_text("OUT.csv")
      ->required();
  add_json(command, arguments.is_json);
}

}  // namespace dts::lab::force
