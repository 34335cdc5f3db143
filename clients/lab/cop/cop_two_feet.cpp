// SPDX-License-Identifier: Apache-2.0
// `dtslab cop two-feet`: adds the correction for a person on two feet to the calibration of a rig.
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/progress.h"
#include "cli/table.h"
#include "core/special_numbers.h"
#include "files/cop_calibration_file.h"
#include "files/rig_file.h"
#include "lab/base/command.h"
#include "lab/base/problems.h"
#include "lab/cop/cop_command.h"
#include "physics/body/two_link.h"
#include "physics/cop/two_feet_fit.h"

namespace dts::lab::cop {
namespace {

struct TwoFeetArguments {
  std::string rig;
  std::string out;
  bool is_json = false;
};

using physics::CopCalibration;
using physics::CopMethod;

/// Calibrates on the plate model. Leaves out the points: the rig file determines them.
core::Result<CopCalibration> calibrate_on_model(CopMethod method, const physics::RigModel& rig, const std::string& name) {
  if (method == CopMethod::Model) {
    return core::fail(core::ErrorCode::InvalidArgument, "estimator \"model\" of the rig has no coefficients for a calibration file",
                      "set another estimator in [[stage]] \"cop\" of the rig file");
  }
  DTS_TRY_ASSIGN(const auto samples, physics::model_samples(method, rig, physics::PlateBehaviour::Stiffening));
  DTS_TRY_ASSIGN(auto calibration, physics::calibrate_cop(method, samples, {.created_utc = now_utc(), .rig = name}));
  calibration.points.clear();
  return calibration;
}

int run_two_feet(const TwoFeetArguments& arguments, cli::Console& console) {
  if (const auto status = check_out(arguments.out, {arguments.rig}); !status) return fail_with(console, status.error());
  if (const auto status = check_is_new(arguments.out); !status) return fail_with(console, status.error());
  files::Problems problems;
  const auto rig = files::read_rig_to_calibrate(arguments.rig, problems);
  if (!problems.empty()) return report_problems(console, problems);
  auto calibration = rig.calibration ? core::Result<CopCalibration>(*rig.calibration)
                                     : calibrate_on_model(rig.method, rig.model, std::filesystem::path(arguments.rig).stem().string());
  if (!calibration) return fail_with(console, calibration.error());
  core::Result<physics::TwoFeetFit> fitted;
  {
    cli::Progress progress(console, "simulating people on two feet");
    fitted = physics::fit_two_feet(rig.method, rig.model, physics::kTwoFeetStances, [&progress](double done) { progress.report(done); });
  }
  if (!fitted) return fail_with(console, fitted.error());
  auto correction = physics::TwoFeetCorrection::from_form(fitted->form);
  if (!correction) return fail_with(console, correction.error());
  constexpr std::string_view kSuffix = "-two-feet";
  if (!calibration->id.ends_with(kSuffix)) calibration->id += kSuffix;
  calibration->two_feet = *correction;
  if (const auto written = files::write_cop_calibration(arguments.out, *calibration); !written) return fail_with(console, written.error());
  const double too_heavy_kg = fitted->too_heavy_n.value_or(core::kNaN) / physics::kGravityMPerS2;
  if (arguments.is_json) {
    cli::Json json{{"id", calibration->id},
                   {"estimator", std::string(physics::to_string(calibration->estimator.method()))},
                   {"on_top_of", rig.calibration ? "calibration" : "plate_model"},
                   {"stances", physics::kTwoFeetStances},
                   {"travel_mm", fitted->form.travel_mm}};
    cli::set_number(json, "too_heavy_kg", too_heavy_kg);
    json["file"] = arguments.out;
    console.out << cli::document(json);
    return cli::kOk;
  }
  console.out << calibration->id << ": " << (rig.calibration ? "the calibration of the rig" : "calibrated on the plate model")
              << ", corrected for two feet with " << physics::kTwoFeetStances << " simulated people\n";
  if (std::isfinite(too_heavy_kg)) {
    warn(console, "people above " + cli::decimal(too_heavy_kg, 0) + " kg can bend this plate by more than " +
                      cli::decimal(fitted->form.travel_mm, 1) + " mm, beyond the travel of the sensors; use a stiffer plate for them");
  }
  cli::print_hint(console, "to use it, write into the rig file: calibration = \"" + arguments.out + "\"");
  return cli::kOk;
}

}  // namespace

void add_two_feet(cli::CommandLine& line, CLI::App& cop) {
  const auto [command, arguments] = add_command(
      line, cop, "two-feet", "Add the correction for a person on two feet to a rig's calibration, or to its plate model",
      "dtslab cop two-feet --rig rig.toml --out cal.toml | then write calibration = \"cal.toml\" into rig.toml\n", run_two_feet);
  command.add_option("--rig", arguments.rig, "Rig file with plate, sensors and, if measured, calibration")->option_text("FILE")->required();
  command.add_option("--out", arguments.out, "Calibration file to write; never overwritten")->option_text("CAL.toml")->required();
  add_json(command, arguments.is_json);
}

}  // namespace dts::lab::cop
