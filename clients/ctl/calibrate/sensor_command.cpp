// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/sensor_command.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/table.h"
#include "cli/try.h"
#include "ctl/calibrate/gap_guide.h"
#include "ctl/calibrate/gap_table.h"
#include "ctl/calibrate/rig_facts.h"
#include "ctl/commands.h"
#include "files/sensor_curve_file.h"
#include "files/toml_text.h"

namespace dts::ctl {
namespace {

using cli::Json;
using client::ErrorCode;
using client::Result;

constexpr std::uint8_t kRefusedVoltageQuality = v1::QUALITY_RAIL | v1::QUALITY_STUCK | v1::QUALITY_ROTATION;
constexpr double kDriftV = 0.005;  // one code of an 11-bit converter over +-5 V
constexpr double kNoiseV = 0.05;
constexpr const char* kAll = "all";

/// A sensor with its readings and its file.
struct SensorJob {
  v1::SensorInfo sensor;  ///< Without a rig only the label is set.
  std::vector<physics::GapReading> readings;
  std::string file;
  std::size_t samples_per_point = 1;
};

struct Finished {
  physics::SensorCalibration calibration;
  files::SensorCalibrationFacts facts;
  std::string file;
};

std::string default_name(const std::string& rig, const std::string& label) {
  return (rig.empty() ? "" : rig + "-") + label + "-" + utc_now().substr(0, 10) + ".toml";
}

/// Returns the sensor's file. `--out` names the file of one sensor, or the folder for all.
Result<std::string> file_for(const Arguments& arguments, const std::string& label) {
  const CalibrateArguments& wishes = arguments.calibrate;
  if (label.find_first_of("/\\") != std::string::npos || label != cli::printable(label) || label.empty()) {
    return client::fail(ErrorCode::InvalidArgument,
                        "'" + cli::printable(label) + "' cannot be a sensor label: the label becomes part of a file name",
                        "give --sensor a label without / and control characters");
  }
  const std::string name = default_name(arguments.rig, label);
  if (wishes.out.empty()) return free_file(name);
  return free_file(wishes.sensor == kAll ? (std::filesystem::path(wishes.out) / name).string() : wishes.out);
}

Result<std::vector<SensorJob>> choose_sensors(const Arguments& arguments, const RigFacts& facts) {
  const std::string& wanted = arguments.calibrate.sensor;
  std::vector<SensorJob> jobs;
  std::string known;
  for (const v1::SensorInfo& sensor : facts.rig.sensors()) {
    known += (known.empty() ? "" : ", ") + cli::printable(sensor.label());
    if (wanted != kAll && wanted != sensor.label()) continue;
    DTS_TRY_ASSIGN(auto file, file_for(arguments, sensor.label()));
    jobs.push_back({.sensor = sensor, .readings = {}, .file = std::move(file)});
  }
  if (!jobs.empty()) return jobs;
  return client::fail(ErrorCode::NotFound, "rig '" + arguments.rig + "' has no sensor '" + cli::printable(wanted) + "'",
                      "the sensors are: " + known + "; or give all");
}

/// Returns the cause of a quality bit of a voltage, and what to do at the sensor.
std::string voltage_advice(const std::string& label, std::uint8_t quality) {
  if ((quality & v1::QUALITY_RAIL) != 0)
    return "the voltage is at the limit of the input range; leave this gap out (--gaps) or use a wider input range";
  if ((quality & v1::QUALITY_STUCK) != 0) return "the voltage of " + label + " does not change; check its cable and supply";
  return "the channels may be in the wrong order; check the marker channel: dtsctl doctor";
}

Result<std::vector<SteadyReading>> measure(const Arguments& arguments, const std::vector<SensorJob>& jobs, double rate_hz, Feed& feed,
                                           cli::Console& console) {
  const CalibrateArguments& wishes = arguments.calibrate;
  DTS_TRY_ASSIGN(const auto scans, hold_scans(wishes.hold_s, rate_hz));
  const auto say = [&console](const std::string& line) { console.talk << line << std::endl; };
  MeasureOptions options{.unit = "V",
                         .limits = {.window_scans = scans, .drift = kDriftV, .noise = kNoiseV},
                         .refused_quality = kRefusedVoltageQuality,
                         .patience_scans = static_cast<std::size_t>(kPatienceS * rate_hz) + scans,
                         .say = say,
                         .sees = {},
                         .advise = voltage_advice};
  for (const SensorJob& job : jobs) options.labels.push_back(job.sensor.label());
  const std::vector<std::string> labels = options.labels;
  const Prompt prompt(console.talk, standard_input(), has_standard_input);
  const bool is_guided = !wishes.is_auto && is_input_terminal();
  if (is_guided) options.is_stopped = [&prompt] { return prompt.poll() == Answer::Quit; };
  Measurer measurer(feed, std::move(options));
  return measure_gaps(
      {.gaps_mm = wishes.gaps_mm, .measurer = measurer, .prompt = is_guided ? &prompt : nullptr, .say = say, .labels = labels});
}

/// Fills in the readings; returns false if the person quit.
Result<bool> measure_jobs(const Arguments& arguments, const RigFacts& facts, std::vector<SensorJob>& jobs, cli::Console& console) {
  DTS_TRY(facts.check_idle());
  DTS_TRY_ASSIGN(const auto where, target(arguments));
  DTS_TRY_ASSIGN(const auto rate_hz, facts.rate_hz("raw"));
  std::vector<std::string> channels;
  for (const SensorJob& job : jobs) channels.push_back(job.sensor.label() + "_v");  // the pipeline's names of its input columns
  DTS_TRY_ASSIGN(auto feed, LiveFeed::open(where, arguments.rig, "raw", channels));
  DTS_TRY_ASSIGN(const auto levels, measure(arguments, jobs, rate_hz, feed, console));
  const auto& gaps_mm = arguments.calibrate.gaps_mm;
  if (levels.size() < gaps_mm.size()) return false;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    for (std::size_t k = 0; k < gaps_mm.size(); ++k) {
      jobs[i].readings.push_back({.gap = {gaps_mm[k]}, .volts = {levels[k].mean[i]}, .row = k + 1});
      jobs[i].samples_per_point = levels[k].scans;
    }
  }
  return true;
}

/// `facts`: of the rig that was measured; nothing for points from a file, which may be of another DAQ.
Result<Finished> finish(const SensorJob& job, const RigFacts* facts, const std::string& rig) {
  const std::string label = job.sensor.label();
  auto calibration = physics::calibrate_sensor(job.readings);
  const auto refuse = [&](core::Error error) {
    error.what = "sensor " + label + ": " + error.what;
    return as_client_error(error);
  };
  if (!calibration) return refuse(calibration.error());
  files::SensorCalibrationFacts about{.origin = {.created_utc = utc_now(), .rig = rig, .sensor = label}};
  if (facts != nullptr) {
    about.origin.daq_model = facts->daq_model;
    about.origin.daq_serial = facts->daq_serial;
    about.origin.channel = job.sensor.channel();
    const double range_v = std::max(std::abs(job.sensor.range_low_v()), std::abs(job.sensor.range_high_v()));
    if (range_v > 0.0) about.range_v = range_v;  // 0: an older daemon does not report it
  }
  about.residual_mv = 1e3 * calibration->residual_v;
  if (calibration->repeat_v) about.repeat_mv = 1e3 * *calibration->repeat_v;
  about.readings_per_gap = calibration->least_readings;
  about.samples_per_point = job.samples_per_point;
  about = files::with_id(about, calibration->points);
  const std::string name = (rig.empty() ? "" : rig + "-") + label;
  if (auto curve = physics::SensorCurve::create(name, calibration->points); !curve) return refuse(curve.error());
  if (auto written = files::write_sensor_curve(job.file, name, calibration->points, about); !written) return refuse(written.error());
  return Finished{std::move(*calibration), std::move(about), job.file};
}

Json to_json(const Finished& finished) {
  const files::SensorCalibrationFacts& facts = finished.facts;
  const physics::SensorCurveOrigin& origin = facts.origin;
  Json json = Json::object();
  for (const auto& [key, text] :
       {std::pair{"sensor", &origin.sensor}, std::pair{"rig", &origin.rig}, std::pair{"id", &facts.id},
        std::pair{"created_utc", &origin.created_utc}, std::pair{"daq_model", &origin.daq_model},
        std::pair{"daq_serial", &origin.daq_serial}, std::pair{"channel", &origin.channel}, std::pair{"file", &finished.file}}) {
    if (!text->empty()) json[key] = *text;
  }
  if (facts.range_v) cli::set_number(json, "range_v", *facts.range_v);
  cli::set_number(json, "residual_mv", facts.residual_mv);
  if (facts.repeat_mv) cli::set_number(json, "repeat_mv", *facts.repeat_mv);
  json["readings_per_gap"] = facts.readings_per_gap;
  json["samples_per_point"] = facts.samples_per_point;
  json["points"] = Json::array();
  for (const physics::CurvePoint& point : finished.calibration.points) {
    json["points"].push_back({{"gap_mm", point.gap.value}, {"volts", point.volts.value}});
  }
  return json;
}

/// Warns if the unloaded gap is at or beyond the end of the curve: the empty plate could then not be tared.
void warn_of_range(const SensorJob& job, const Finished& finished, cli::Console& console) {
  constexpr double kMarginMm = 0.1;  // mounting tolerance of the sensors
  const double unloaded_mm = job.sensor.unloaded_gap_mm();
  const double largest_mm = finished.calibration.points.back().gap.value;
  if (!(unloaded_mm + kMarginMm > largest_mm)) return;
  console.talk << "warning: sensor " << cli::printable(finished.facts.origin.sensor) << " has an unloaded gap of "
               << cli::decimal(unloaded_mm, 2) << " mm, but its curve ends at " << cli::decimal(largest_mm, 2)
               << " mm: measure larger gaps, too" << std::endl;
}

void print(cli::Console& console, const std::vector<Finished>& all) {
  for (const Finished& finished : all) {
    console.out << "Sensor " << cli::printable(finished.facts.origin.sensor) << ", " << finished.facts.id << ":\n";
    cli::Table table({">gap mm", ">volts"});
    for (const physics::CurvePoint& point : finished.calibration.points) {
      table.add({{cli::decimal(point.gap.value, 3)}, {cli::decimal(point.volts.value, 4)}});
    }
    table.print(console);
    console.out << "scatter around a smooth curve: " << cli::decimal(finished.facts.residual_mv, 2) << " mV rms";
    if (finished.facts.repeat_mv) console.out << "; between repeated gaps: " << cli::decimal(*finished.facts.repeat_mv, 2) << " mV rms";
    console.out << "\nwritten to " << cli::printable(finished.file)
                << "\nto use it, replace the line `curve` in the rig file, under [[sensor]] with label = "
                << cli::printable(files::toml_quoted(finished.facts.origin.sensor))
                << ", by:\n    curve = " << cli::printable(files::toml_quoted(std::filesystem::absolute(finished.file).string())) << "\n";
  }
  console.out.flush();
}

/// Without a rig: one sensor, one table of points, no facts about the hardware.
Result<std::vector<SensorJob>> offline_job(const Arguments& arguments) {
  SensorJob job;
  job.sensor.set_label(arguments.calibrate.sensor);
  DTS_TRY_ASSIGN(job.file, file_for(arguments, job.sensor.label()));
  return std::vector{std::move(job)};
}

core::Status check(const Arguments& arguments) {
  const bool is_offline = !arguments.calibrate.points_file.empty();
  if (arguments.rig.empty() && !is_offline) {
    return core::fail(core::ErrorCode::InvalidArgument, "measuring needs a rig", "give --rig RIG, or read points with --points FILE");
  }
  if (is_offline && arguments.calibrate.sensor == kAll) {
    return core::fail(core::ErrorCode::InvalidArgument, "a file of points is for one sensor, not for all", "give --sensor LABEL");
  }
  const auto& gaps_mm = arguments.calibrate.gaps_mm;
  const std::size_t different = std::set<double>(gaps_mm.begin(), gaps_mm.end()).size();
  if (!is_offline && different < physics::kLeastGaps) {
    return core::fail(
        core::ErrorCode::InvalidArgument,
        "--gaps names " + std::to_string(different) + " different gaps; required: at least " + std::to_string(physics::kLeastGaps),
        "--gaps 12.5,12,11,10,9,8,7,6.5");
  }
  return {};
}

Result<std::optional<RigFacts>> facts_if_any(const Arguments& arguments) {
  if (arguments.rig.empty()) return std::nullopt;
  DTS_TRY_ASSIGN(auto dts, connect(arguments));
  DTS_TRY_ASSIGN(auto facts, ask_rig_facts(dts, arguments.rig));
  return std::optional<RigFacts>(std::move(facts));
}

/// Reads the points from a file, or measures them. Returns false if the person quit.
Result<bool> fill_in(const Arguments& arguments, const std::optional<RigFacts>& facts, std::vector<SensorJob>& jobs,
                     cli::Console& console) {
  if (arguments.calibrate.points_file.empty()) return measure_jobs(arguments, *facts, jobs, console);
  DTS_TRY_ASSIGN(auto readings, read_gap_table(arguments.calibrate.points_file));
  jobs.front().readings = std::move(readings);
  return true;
}

/// Writes the readings of a rejected sensor in the format of --points, so that the measurement is not lost. Returns nothing if this fails.
std::optional<std::string> rescue(const SensorJob& job) {
  const auto file = free_file(job.file + ".readings.csv");
  if (!file) return std::nullopt;
  std::ofstream stream(*file);
  stream << "gap_mm,volts\n";
  for (const physics::GapReading& reading : job.readings) {
    stream << files::toml_number(reading.gap.value) << ',' << files::toml_number(reading.volts.value) << '\n';
  }
  stream.close();
  if (!stream) return std::nullopt;
  return *file;
}

/// Reports why a sensor has no curve; other sensors continue. Returns the exit status.
int refuse(const Arguments& arguments, const SensorJob& job, const client::Error& error, cli::Console& console) {
  if (!arguments.calibrate.points_file.empty()) return cli::fail_with(console, error);
  const int status = cli::fail_with(console, error);
  if (const auto file = rescue(job)) {
    console.talk << "  the readings are saved in " << cli::printable(*file) << "; correct the file, then: dtsctl calibrate sensor --sensor "
                 << cli::printable(job.sensor.label()) << " --points FILE" << std::endl;
  }
  return arguments.calibrate.sensor == kAll ? cli::kFailed : status;
}

}  // namespace

int run_calibrate_sensor(const Arguments& arguments, cli::Console& console) {
  if (auto checked = check(arguments); !checked) return cli::fail_with(console, checked.error());
  const auto facts = facts_if_any(arguments);
  if (!facts) return cli::fail_with(console, facts.error());
  auto jobs = *facts ? choose_sensors(arguments, **facts) : offline_job(arguments);
  if (!jobs) return cli::fail_with(console, jobs.error());
  const auto filled = fill_in(arguments, *facts, *jobs, console);
  if (!filled) return cli::fail_with(console, filled.error());
  if (!*filled) return cli::kInterrupted;
  const RigFacts* const measured = arguments.calibrate.points_file.empty() ? &**facts : nullptr;
  std::vector<Finished> all;
  int status = cli::kOk;
  for (const SensorJob& job : *jobs) {
    auto finished = finish(job, measured, arguments.rig);
    if (!finished) {
      status = refuse(arguments, job, finished.error(), console);
      continue;
    }
    warn_of_range(job, *finished, console);
    all.push_back(std::move(*finished));
  }
  if (all.empty()) return status;
  if (!arguments.is_json) {
    print(console, all);
    return status;
  }
  Json document{{"sensors", Json::array()}};
  for (const Finished& finished : all) document["sensors"].push_back(to_json(finished));
  console.out << cli::document(document) << std::flush;
  return status;
}

}  // namespace dts::ctl
