// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/cop_command.h"

#include <algorithm>
#include <set>

#include "cli/exit_status.h"
#include "cli/table.h"
#include "cli/try.h"
#include "ctl/calibrate/cop_guide.h"
#include "ctl/calibrate/cop_report.h"
#include "ctl/calibrate/interrupt_note.h"
#include "ctl/calibrate/rig_facts.h"
#include "ctl/commands.h"
#include "files/cop_calibration_file.h"

namespace dts::ctl {
namespace {

using cli::Json;
using client::ErrorCode;
using client::Result;
using physics::CopMethod;

/// A deflection with any of these quality bits is not used for a point.
constexpr std::uint8_t kRefusedDeflectionQuality =
    v1::QUALITY_RAIL | v1::QUALITY_STUCK | v1::QUALITY_OUT_OF_RANGE | v1::QUALITY_ROTATION | v1::QUALITY_UNTARED;
constexpr double kDriftMm = 0.01;       // changes the estimate by about 0.1 mm at 490 N
constexpr double kNoiseMm = 0.1;        // as for the tare: more noise means movement
constexpr double kThesisLoadN = 490.0;  // thesis 4.5: 50 kgf
constexpr double kLeastRatio = 2.0;     // between the loads: poly3 needs it to fit how its coefficients depend on the load
constexpr std::size_t kGoodGrid = 6;    // plate-model 5.2: 6 x 6 places are ten times better than 5 x 5

/// All settings that are fixed before the first measurement.
struct Job {
  RigFacts facts;
  CopMethod method = CopMethod::Poly3;
  PlateView plate;
  std::vector<double> loads_n;
  std::size_t grid = 7;
  std::size_t verify = kVerificationPoints;
  std::vector<PlannedPoint> points;  ///< First the points to calibrate, then those to verify.
  std::size_t fit_count = 0;         ///< Number of points for the fit.
  double rate_hz = 0.0;
  std::string file;
};

bool is_guided(const Arguments& arguments) { return !arguments.calibrate.is_auto && is_input_terminal(); }

Result<std::filesystem::path> progress_path(const std::string& rig) {
  DTS_TRY_ASSIGN(const auto folder, state_folder());
  return folder / ("calibrate-cop-" + rig + ".jsonl");
}

/// Fills in missing options for --resume from the interrupted calibration. Numbers of a damaged file count as missing: the file is rejected
/// later, because it differs.
Result<CalibrateArguments> completed(const Arguments& arguments) {
  CalibrateArguments wishes = arguments.calibrate;
  if (!wishes.is_resumed) return wishes;
  DTS_TRY_ASSIGN(const auto file, progress_path(arguments.rig));
  DTS_TRY_ASSIGN(const auto then, ProgressFile::calibration_in(file));
  const auto text = then.value("estimator", Json());
  if (!wishes.estimator && text.is_string()) wishes.estimator = text.get<std::string>();
  if (text != wishes.estimator.value_or("poly3")) return wishes;
  const auto count = [&](const char* key, std::size_t largest, std::optional<std::size_t>& wish) {
    const auto value = then.value(key, Json());
    if (!wish && value.is_number_unsigned() && value.get<std::size_t>() <= largest) wish = value.get<std::size_t>();
  };
  count("grid", 15, wishes.grid);
  count("verify", kVerificationPoints, wishes.verify);
  const auto loads = then.value("loads_n", Json());
  if (!wishes.loads_n.empty() || !loads.is_array()) return wishes;
  for (const Json& load : loads) {
    if (load.is_number() && wishes.loads_n.size() < 20) wishes.loads_n.push_back(load.get<double>());
  }
  return wishes;
}

Result<void> check_loads(CopMethod method, const std::vector<double>& loads_n) {
  if (std::set<double>(loads_n.begin(), loads_n.end()).size() < loads_n.size()) {
    return client::fail(ErrorCode::InvalidArgument, "--loads has the same load twice", "give each load once");
  }
  if (method == CopMethod::Thesis && loads_n.size() != 1) {
    return client::fail(ErrorCode::InvalidArgument, "the estimator thesis needs exactly one load, not " + std::to_string(loads_n.size()),
                        "--loads 490");
  }
  return {};
}

/// Warns about settings with poor results before the first measurement.
void warn(const Job& job, cli::Console& console) {
  if (job.method != CopMethod::Poly3) return;
  const auto [least, most] = std::ranges::minmax(job.loads_n);
  if (most < kLeastRatio * least) {
    console.talk << "warning: poly3 needs loads that differ by a factor of " << cli::decimal(kLeastRatio, 0)
                 << " or more to correct for the load; these are " << cli::decimal(least, 0) << " .. " << cli::decimal(most, 0) << " N"
                 << std::endl;
  }
  if (job.grid < kGoodGrid) {
    console.talk << "warning: 6 x 6 positions give errors about ten times smaller than " << job.grid << " x " << job.grid
                 << ": use --grid 6" << std::endl;
  }
}

/// Returns the cause of a quality bit of a deflection, and what to do at the plate.
std::string deflection_advice(const std::string& label, std::uint8_t quality) {
  if ((quality & v1::QUALITY_UNTARED) != 0) return "the plate has lost its tare; quit, then continue with --resume";
  if ((quality & v1::QUALITY_RAIL) != 0)
    return "the voltage is at the limit of the input range; use a lighter weight or a wider input range";
  if ((quality & v1::QUALITY_OUT_OF_RANGE) != 0) {
    return "the curve of " + label +
           " ends before this deflection; measure it at smaller gaps (dtsctl calibrate sensor) or use a lighter weight";
  }
  if ((quality & v1::QUALITY_STUCK) != 0) return "the voltage of " + label + " does not change; check its cable and supply";
  return "the channels may be in the wrong order; check the marker channel: dtsctl doctor";
}

Result<Job> plan(const Arguments& arguments, const CalibrateArguments& wishes, client::ControlClient& dts) {
  DTS_TRY_ASSIGN(auto facts, ask_rig_facts(dts, arguments.rig));
  DTS_TRY(facts.check_idle());
  const std::string estimator = wishes.estimator.value_or("poly3");
  const auto method = physics::parse_cop_method(estimator);
  if (!method) return as_client_error(method.error());
  Job job{.facts = std::move(facts), .method = *method};
  job.grid = wishes.grid.value_or(job.grid);
  job.verify = wishes.verify.value_or(job.verify);
  job.plate = plate_view(job.facts.rig);
  if (job.plate.labels.size() != physics::kFloorSensors) {
    return client::fail(ErrorCode::Unsupported,
                        "rig '" + arguments.rig + "' has " + std::to_string(job.plate.labels.size()) + " sensors; " + estimator +
                            " is only for floor platforms with four sensors",
                        "for more sensors, use the plate model: estimator = \"moment\" in the rig file");
  }
  DTS_TRY_ASSIGN(job.rate_hz, job.facts.rate_hz("deflection"));
  job.loads_n = wishes.loads_n;
  if (job.loads_n.empty()) job.loads_n = job.method == CopMethod::Thesis ? std::vector{kThesisLoadN} : std::vector{240.0, 600.0};
  DTS_TRY(check_loads(job.method, job.loads_n));
  job.points = plan_points(job.plate, job.method, job.loads_n, job.grid);
  job.fit_count = job.points.size();
  for (const PlannedPoint& point : verification_points(job.plate, job.loads_n.back(), job.verify)) job.points.push_back(point);
  DTS_TRY_ASSIGN(job.file, free_file(wishes.out.empty() ? arguments.rig + "-cop-" + utc_now().substr(0, 10) + ".toml" : wishes.out));
  return job;
}

/// Returns the properties that must be equal, so that points of two runs can be combined.
Json identity(const Job& job) {
  Json points = Json::array();
  for (const PlannedPoint& point : job.points) points.push_back({point.x_mm, point.y_mm, point.load_n});
  return {{"format", 2},
          {"rig", job.facts.rig.name()},
          {"sensors", job.plate.labels},
          {"daq_model", job.facts.daq_model},
          {"daq_serial", job.facts.daq_serial},
          {"estimator", std::string(physics::to_string(job.method))},
          {"loads_n", job.loads_n},
          {"grid", job.grid},
          {"verify", job.verify},
          {"points_to_fit", job.fit_count},
          {"points", points}};
}

Result<ProgressFile> open_progress(const CalibrateArguments& wishes, const Job& job) {
  DTS_TRY_ASSIGN(const auto file, progress_path(job.facts.rig.name()));
  if (wishes.is_resumed) return ProgressFile::resume(file, identity(job), job.points.size(), job.plate.labels.size());
  std::error_code error;
  if (!wishes.is_fresh && std::filesystem::exists(file, error)) {
    return client::fail(ErrorCode::WrongState,
                        "a calibration of rig '" + job.facts.rig.name() + "' was interrupted; its points are in " + file.string(),
                        "continue with --resume, or start again with --fresh");
  }
  return ProgressFile::create(file, identity(job));
}

/// Tares the empty plate. Returns false if the person quit.
Result<bool> tare(client::ControlClient& dts, const std::string& rig, const Prompt* prompt, cli::Console& console) {
  while (true) {
    console.talk << "Clear the plate: no weight and no person may be on it." << std::endl;
    if (prompt != nullptr && prompt->ask("  Is the plate empty?", Prompt::kPlain) == Answer::Quit) return false;
    const auto tared = dts.tare(rig);
    if (tared) return true;
    if (prompt == nullptr || tared.error().code != ErrorCode::WrongState) return tl::make_unexpected(tared.error());
    cli::print_error(console, tared.error().what, tared.error().hint);
  }
}

std::vector<physics::CopSample> samples(const Job& job, const ProgressFile& progress) {
  std::vector<physics::CopSample> list;
  for (std::size_t k = 0; k < job.fit_count; ++k) {
    if (!progress.points()[k]) continue;  // skipped
    const PlannedPoint& point = job.points[k];
    list.push_back({.load_position = {{point.x_mm}, {point.y_mm}}, .load = {point.load_n}, .deflection_mm = progress.points()[k]->mean});
  }
  return list;
}

Result<physics::CopCalibration> fit_and_write(const Job& job, const ProgressFile& progress) {
  auto calibration = physics::calibrate_cop(
      job.method, samples(job, progress),
      {.created_utc = utc_now(), .rig = job.facts.rig.name(), .daq_model = job.facts.daq_model, .daq_serial = job.facts.daq_serial});
  if (!calibration) {
    core::Error error = calibration.error();
    error.hint +=
        std::string(error.hint.empty() ? "" : "; ") + "the points are kept: continue with --resume, or measure again with --fresh";
    return as_client_error(error);
  }
  if (auto written = files::write_cop_calibration(job.file, *calibration); !written) return as_client_error(written.error());
  return std::move(*calibration);
}

int finish(const Job& job, ProgressFile& progress, const physics::CopCalibration& calibration, bool is_json, cli::Console& console) {
  CopReport report{.calibration = calibration, .file = job.file, .verification = {}};
  for (std::size_t k = job.fit_count; k < job.points.size(); ++k) {
    if (!progress.points()[k]) continue;
    report.verification.push_back(verify(calibration, job.points[k], progress.points()[k]->mean));
  }
  progress.finish();
  if (is_json) {
    console.out << cli::document(to_json(report)) << std::flush;
  } else {
    print(console, report);
  }
  return cli::kOk;
}

int say_kept(const ProgressFile& progress, const Job& job, cli::Console& console) {
  const auto measured = std::ranges::count(progress.points(), true, &std::optional<SteadyReading>::has_value);
  console.talk << measured << " of " << job.points.size() << " points are kept in " << progress.path().string()
               << "; continue with --resume" << std::endl;
  return cli::kInterrupted;
}

MeasureOptions deflections(const Job& job, std::size_t scans, const std::function<void(const std::string&)>& say,
                           const std::function<bool()>& is_stopped) {
  return {.labels = job.plate.labels,
          .unit = "mm",
          .limits = {.window_scans = scans, .drift = kDriftMm, .noise = kNoiseMm},
          .refused_quality = kRefusedDeflectionQuality,
          .patience_scans = static_cast<std::size_t>(kPatienceS * job.rate_hz) + scans,
          .say = say,
          .sees = load_text,
          .advise = deflection_advice,
          .is_stopped = is_stopped};
}

/// Returns the daemon's estimate of the load on the plate, from its present calibration or the plate's model; nothing if none arrives.
std::optional<double> ask_load(LiveFeed& feed) {
  constexpr int kLooks = 5;
  if (!feed.discard()) return std::nullopt;
  for (int look = 0; look < kLooks; ++look) {
    const auto block = feed.next();
    if (!block) return std::nullopt;
    if (*block) return (*block)->columns.front().back();
  }
  return std::nullopt;
}

/// Runs the whole measurement at the plate.
int work(const Arguments& arguments, client::ControlClient& dts, const Job& job, ProgressFile& progress, Feed& feed,
         std::optional<LiveFeed> loads, std::size_t scans, cli::Console& console) {
  const bool guided = is_guided(arguments);
  const Prompt prompt(console.talk, standard_input(), has_standard_input);
  const Prompt* const asks = guided ? &prompt : nullptr;
  const auto say = [&console](const std::string& line) { console.talk << line << std::endl; };
  std::optional<Answer> typed;
  const bool accepts_keys = is_input_terminal();  // also with --auto: s skips, q quits
  const auto is_stopped = [&] {
    if (accepts_keys) typed = prompt.poll();
    return typed.has_value();
  };
  if (progress.next() < job.points.size()) {
    const auto tared = tare(dts, arguments.rig, asks, console);
    if (!tared) return cli::fail_with(console, tared.error());
    if (!*tared) return say_kept(progress, job, console);
  }
  if (auto fresh = feed.discard(); !fresh) return cli::fail_with(console, fresh.error());
  Measurer measurer(feed, deflections(job, scans, say, is_stopped));
  CopGuide guide({.plate = job.plate,
                  .points = job.points,
                  .measurer = measurer,
                  .progress = progress,
                  .typed = &typed,
                  .prompt = asks,
                  .draws = guided || console.is_talk_terminal,
                  .say = say,
                  .estimated_load_n = [&loads] { return loads ? ask_load(*loads) : std::nullopt; }});
  const auto measured = guide.measure_until(job.fit_count);
  if (!measured) return cli::fail_with(console, measured.error());
  if (!*measured) return say_kept(progress, job, console);
  const auto calibration = fit_and_write(job, progress);
  if (!calibration) return cli::fail_with(console, calibration.error());
  if (progress.next() < job.points.size()) say("The calibration is written. The next points only verify it.");
  const auto verified = guide.measure_until(job.points.size());  // the calibration exists even if the person quits here
  if (!verified) cli::print_error(console, verified.error().what, "the calibration is written; only its verification is incomplete");
  return finish(job, progress, *calibration, arguments.is_json, console);
}

}  // namespace

int run_calibrate_cop(const Arguments& arguments, cli::Console& console) {
  auto dts = connect(arguments);
  if (!dts) return cli::fail_with(console, dts.error());
  const auto where = target(arguments);
  if (!where) return cli::fail_with(console, where.error());
  const auto wishes = completed(arguments);
  if (!wishes) return cli::fail_with(console, wishes.error());
  const auto job = plan(arguments, *wishes, *dts);
  if (!job) return cli::fail_with(console, job.error());
  const auto scans = hold_scans(arguments.calibrate.hold_s, job->rate_hz);
  if (!scans) return cli::fail_with(console, scans.error());
  std::vector<std::string> channels;
  for (const std::string& label : job->plate.labels) channels.push_back(label + "_mm");
  auto feed = LiveFeed::open(*where, arguments.rig, "deflection", channels);
  if (!feed) return cli::fail_with(console, feed.error());
  auto progress = open_progress(arguments.calibrate, *job);
  if (!progress) return cli::fail_with(console, progress.error());
  warn(*job, console);
  const InterruptNote note("Interrupted. The measured points are kept in " + cli::printable(progress->path().string()) +
                           "; continue: dtsctl calibrate cop --rig " + cli::printable(arguments.rig) + " --resume");
  std::optional<LiveFeed> loads;  // only with a person: a script can change the load before the estimate arrives
  if (is_guided(arguments) && job->facts.rate_hz("cop")) {
    if (auto opened = LiveFeed::open(*where, arguments.rig, "cop", {"load_n"})) loads = std::move(*opened);
  }
  return work(arguments, *dts, *job, *progress, *feed, std::move(loads), *scans, console);
}

}  // namespace dts::ctl
