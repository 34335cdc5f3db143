// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/cop_report.h"

#include <filesystem>

#include "cli/table.h"
#include "files/toml_text.h"

namespace dts::ctl {
namespace {

using cli::decimal;
using cli::Json;

/// Returns the line for the rig's file that makes the daemon use the calibration. The path is absolute, because the daemon resolves
/// relative paths from the folder of the rig's file.
std::string rig_line(const std::string& file) { return "calibration = " + files::toml_quoted(std::filesystem::absolute(file).string()); }

Json figures(const ErrorSummary& summary) {
  Json json = Json::object();
  cli::set_number(json, "rms_x_mm", summary.rms_x_mm);
  cli::set_number(json, "rms_y_mm", summary.rms_y_mm);
  cli::set_number(json, "rms_total_mm", summary.rms_total_mm);
  cli::set_number(json, "max_total_mm", summary.max_total_mm);
  return json;
}

Json points(const std::vector<PointError>& errors) {
  Json list = Json::array();
  for (const PointError& error : errors) {
    Json& point = list.emplace_back(Json::object());
    cli::set_number(point, "x_mm", error.point.x_mm);
    cli::set_number(point, "y_mm", error.point.y_mm);
    cli::set_number(point, "load_n", error.point.load_n);
    cli::set_number(point, "x_error_mm", error.x_error_mm);
    cli::set_number(point, "y_error_mm", error.y_error_mm);
  }
  return list;
}

std::string figures_text(const ErrorSummary& summary) {
  return "rms x " + decimal(summary.rms_x_mm, 2) + ", y " + decimal(summary.rms_y_mm, 2) + ", total " + decimal(summary.rms_total_mm, 2) +
         " mm; at most " + decimal(summary.max_total_mm, 2) + " mm";
}

}  // namespace

std::vector<PointError> residuals(const physics::CopCalibration& calibration) {
  std::vector<PointError> errors;
  for (const physics::CopCalibrationPoint& point : calibration.points) {
    errors.push_back({.point = {point.sample.load_position.x.value, point.sample.load_position.y.value, point.sample.load.value},
                      .x_error_mm = point.x_error_mm,
                      .y_error_mm = point.y_error_mm});
  }
  return errors;
}

PointError verify(const physics::CopCalibration& calibration, const PlannedPoint& point, const std::vector<double>& deflection_mm) {
  const physics::CopEstimate estimate = calibration.estimator.estimate(deflection_mm);
  return {.point = point, .x_error_mm = estimate.x_mm - point.x_mm, .y_error_mm = estimate.y_mm - point.y_mm};
}

Json to_json(const CopReport& report) {
  const physics::CopCalibration& calibration = report.calibration;
  Json json{{"rig", calibration.origin.rig},
            {"estimator", std::string(physics::to_string(calibration.estimator.method()))},
            {"id", calibration.id},
            {"created_utc", calibration.origin.created_utc},
            {"daq_model", calibration.origin.daq_model},
            {"daq_serial", calibration.origin.daq_serial},
            {"file", report.file},
            {"rig_file_line", rig_line(report.file)}};
  const auto errors = residuals(calibration);
  json["residuals"] = figures(summary(errors));
  if (calibration.cross_validated) {
    json["cross_validated"] = {{"rms_total_mm", calibration.cross_validated->rms_total_mm},
                               {"load_rms_percent", calibration.cross_validated->load_rms_percent}};
  }
  const auto& valid_n = calibration.estimator.validity().load_n;
  json["valid_load_n"] = {valid_n.lowest, valid_n.highest};
  json["points"] = points(errors);
  if (report.verification.empty()) return json;
  json["verification"] = figures(summary(report.verification));
  json["verification"]["points"] = points(report.verification);
  return json;
}

void print(cli::Console& console, const CopReport& report) {
  const auto errors = residuals(report.calibration);
  console.out << "Residuals at the calibration's own points:\n" << error_map(errors);
  console.out << figures_text(summary(errors)) << '\n';
  if (const auto& unseen = report.calibration.cross_validated) {  // each point is estimated by a fit without it
    console.out << "cross-validation, each point left out in turn: total " << decimal(unseen->rms_total_mm, 2) << " mm, load "
                << decimal(unseen->load_rms_percent, 2) << " % rms\n";
  }
  if (!report.verification.empty()) {
    console.out << "\nVerification at points of thesis Table 4.1:\n" << error_map(report.verification);
    console.out << figures_text(summary(report.verification)) << "   (thesis: rms x 1.66, y 2.51, total 3.0 mm)\n";
  }
  const auto& valid_n = report.calibration.estimator.validity().load_n;
  console.out << "\nvalid for loads of " << decimal(valid_n.lowest, 0) << " .. " << decimal(valid_n.highest, 0)
              << " N; values of lighter and heavier people are flagged as uncalibrated";
  console.out << "\nwritten to " << cli::printable(report.file) << " as " << report.calibration.id
              << "\nto use it, add this line at the top of the rig file, and remove any other estimator from its stage cop:\n    "
              << cli::printable(rig_line(report.file)) << std::endl;
}

}  // namespace dts::ctl
