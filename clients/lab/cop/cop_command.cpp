// SPDX-License-Identifier: Apache-2.0
#include "lab/cop/cop_command.h"

#include <array>
#include <ctime>
#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/table.h"
#include "files/cop_calibration_file.h"
#include "files/toml_reader.h"
#include "lab/base/command.h"
#include "lab/base/problems.h"
#include "lab/base/rig.h"
#include "lab/cop/cop_points.h"

namespace dts::lab::cop {
namespace {

struct FitArguments {
  std::string points;  ///< CSV of point loads.
  std::string rig;
  std::string estimator = "poly3";
  std::string daq_model;  ///< Of the DAQ that measured `points`; empty: unknown.
  std::string daq_serial;
  std::string out;
  bool is_json = false;
};

using physics::CopCalibration;
using physics::CopErrorFigures;

cli::Json to_json(const CopErrorFigures& figures) {
  cli::Json json = cli::Json::object();
  cli::set_number(json, "rms_x_mm", figures.rms_x_mm);
  cli::set_number(json, "rms_y_mm", figures.rms_y_mm);
  cli::set_number(json, "rms_total_mm", figures.rms_total_mm);
  cli::set_number(json, "max_total_mm", figures.max_total_mm);
  cli::set_number(json, "load_rms_percent", figures.load_rms_percent);
  return json;
}

void print_fit(const CopCalibration& calibration, const FitArguments& arguments, cli::Console& console) {
  const std::string method(to_string(calibration.estimator.method()));
  if (arguments.is_json) {
    cli::Json json{{"id", calibration.id}, {"estimator", method}, {"points", calibration.points.size()}, {"file", arguments.out}};
    json["residuals"] = to_json(calibration.residuals);
    if (calibration.cross_validated) json["cross_validated"] = to_json(*calibration.cross_validated);
    console.out << cli::document(json);
    return;
  }
  cli::Table table({calibration.id, ">RMS X (mm)", ">RMS Y (mm)", ">RMS TOTAL (mm)", ">LARGEST (mm)", ">LOAD RMS (%)"});
  const auto add = [&](const std::string& name, const CopErrorFigures& figures) {
    table.add({{name},
               {cli::decimal(figures.rms_x_mm, 3)},
               {cli::decimal(figures.rms_y_mm, 3)},
               {cli::decimal(figures.rms_total_mm, 3)},
               {cli::decimal(figures.max_total_mm, 3)},
               {cli::decimal(figures.load_rms_percent, 3)}});
  };
  add("all " + std::to_string(calibration.points.size()) + " points", calibration.residuals);
  if (calibration.cross_validated) add("cross-validation", *calibration.cross_validated);
  table.print(console);
  cli::print_hint(console, "to use it: dtslab cop estimate " + arguments.out + " POINTS.csv --out EST.csv");
}

/// A longer text could not be read back from the calibration file.
std::string is_short(const std::string& text) {
  return text.size() <= files::kLongestText ? "" : "longer than " + std::to_string(files::kLongestText) + " characters";
}

// Above these limits a calibration is worse than the method allows: a measurement is wrong, or there are too few.
constexpr double kLargestOwnMm = 1.0;
constexpr double kLargestLeftOutMm = 2.0;
constexpr double kLargestLoadPercent = 5.0;
constexpr std::size_t kEnoughPositions = 36;  ///< 6 x 6, for the cubic polynomials of poly3.

/// Returns the number of different loaded positions.
std::size_t position_count(const CopCalibration& calibration) {
  std::set<std::pair<double, double>> places;
  for (const physics::CopCalibrationPoint& point : calibration.points) {
    places.emplace(point.sample.load_position.x.value, point.sample.load_position.y.value);
  }
  return places.size();
}

void warn_of_doubts(const CopCalibration& calibration, cli::Console& console) {
  const double own_mm = calibration.residuals.rms_total_mm;
  const double left_out_mm = calibration.cross_validated ? calibration.cross_validated->rms_total_mm : 0.0;
  const double load_percent = calibration.cross_validated ? calibration.cross_validated->load_rms_percent : 0.0;
  if (own_mm > kLargestOwnMm || left_out_mm > kLargestLeftOutMm) {
    std::string text = "the error of the calibration at its own points is " + cli::decimal(own_mm, 2) + " mm rms";
    if (calibration.cross_validated) text += ", in cross-validation " + cli::decimal(left_out_mm, 2) + " mm";
    const bool is_coarse = calibration.estimator.method() == physics::CopMethod::Poly3 && position_count(calibration) < kEnoughPositions;
    warn(console, text + (is_coarse ? "; with 6 x 6 positions or more the error is about ten times smaller"
                                    : "; check the points, and whether a sensor moved"));
  }
  if (load_percent > kLargestLoadPercent) {
    warn(console, "in cross-validation, the error of the load is " + cli::decimal(load_percent, 1) + " % rms; check the loads");
  }
}

int run_cop_fit(const FitArguments& arguments, cli::Console& console) {
  if (const auto status = check_out(arguments.out, {arguments.points, arguments.rig}); !status) return fail_with(console, status.error());
  if (const auto status = check_is_new(arguments.out); !status) return fail_with(console, status.error());
  files::Problems problems;
  const physics::RigModel rig = read_rig(arguments.rig, problems);
  if (!problems.empty()) return report_problems(console, problems);
  const CopPoints points = read_cop_points(arguments.points, rig.sensors.size(), true, rig.plate, problems);
  if (!problems.empty()) return report_problems(console, problems);
  const auto method = physics::parse_cop_method(arguments.estimator);
  if (!method) return fail_with(console, method.error());
  const physics::CopCalibrationOrigin origin{.created_utc = now_utc(),
                                             .rig = std::filesystem::path(arguments.rig).stem().string(),
                                             .daq_model = arguments.daq_model,
                                             .daq_serial = arguments.daq_serial};
  const auto calibration = physics::calibrate_cop(*method, points.samples, origin);
  if (!calibration) return fail_with(console, calibration.error());
  const auto written = files::write_cop_calibration(arguments.out, *calibration);
  if (!written) return fail_with(console, written.error());
  print_fit(*calibration, arguments, console);
  warn_of_doubts(*calibration, console);
  return cli::kOk;
}

}  // namespace

std::string now_utc() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  ::gmtime_r(&now, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text.data();
}

core::Status check_is_new(const std::string& out) {
  std::error_code error;
  if (!std::filesystem::exists(std::filesystem::symlink_status(out, error))) return {};
  return core::fail(core::ErrorCode::InvalidArgument, "--out " + out + " already exists: a calibration is never overwritten",
                    "give another file with --out");
}

void add_commands(cli::CommandLine& line) {
  CLI::App* cop = cli::add_group(line.app, "cop", "Calibrate and evaluate estimators of the centre of pressure",
                                 "dtslab cop fit points.csv --rig rig.toml --out cal.toml | a calibration from known loads\n"
                                 "dtslab cop two-feet --rig rig.toml --out cal.toml | with the correction for a person on two feet\n"
                                 "dtslab cop evaluate --noise realistic | expected error of a platform\n");
  const auto [fit, fitted] =
      add_command(line, *cop, "fit", "Calibrate an estimator with known loads",
                  "dtslab cop fit points.csv --rig rig.toml --out cal.toml | poly3\n"
                  "dtslab cop fit points.csv --rig rig.toml --estimator thesis --out cal.toml | as in section 4.4 of the thesis\n"
                  "dtslab cop fit points.csv --rig floor.toml --daq-model USB-6008 --daq-serial 01A2B3C4 --out cal.toml | names the DAQ\n",
                  run_cop_fit);
  fit.add_option("POINTS.csv", fitted.points, "CSV file with columns p_n,x_mm,y_mm and w1_mm,w2_mm,... per sensor; origin at a corner")
      ->required()
      ->option_text(" ");
  fit.add_option("--rig", fitted.rig, "Rig file with plate and sensors")->option_text("FILE")->required();
  add_estimator(fit, fitted.estimator, {"poly3", "thesis", "thesis_per_pair", "moment"});
  CLI::Option* model =
      fit.add_option("--daq-model", fitted.daq_model, "DAQ that measured POINTS.csv, as dtsctl device list prints it; else dtsd warns")
          ->option_text("MODEL")
          ->check(is_short);
  fit.add_option("--daq-serial", fitted.daq_serial, "Its serial number")->option_text("SERIAL")->check(is_short)->needs(model);
  fit.add_option("--out", fitted.out, "Calibration file to write; never overwritten")->option_text("CAL.toml")->required();
  add_json(fit, fitted.is_json);

  add_estimate(line, *cop);
  add_two_feet(line, *cop);
  add_evaluate(line, *cop);
}

void add_estimator(CLI::App& command, std::string& estimator, const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  command.add_option("--estimator", estimator, text + "; default: poly3")->option_text("NAME")->check(CLI::IsMember(names));
}

}  // namespace dts::lab::cop
