// SPDX-License-Identifier: Apache-2.0
#include "lab/reach/trial_set.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include "lab/base/csv.h"
#include "lab/reach/volts_file.h"

namespace dts::lab::reach {
namespace {

constexpr std::size_t kSensors = 4;
constexpr std::array<const char*, kSensors> kVoltColumns{"v1", "v2", "v3", "v4"};
constexpr double kMostVolts = 100.0;
constexpr double kSlowestHz = 75.0;  // lowest rate of the stage `reach`

std::string path_of(const std::string& folder, const std::string& name) { return (std::filesystem::path(folder) / name).string(); }

void report(files::Problems& problems, const std::string& file, std::size_t line, const std::string& text) {
  problems.push_back({file, static_cast<std::uint32_t>(line), line == 0 ? 0U : 1U, text});
}

/// Position of a sensor and its voltage with nobody on the seat.
struct SensorRow {
  physics::Point position;
  double tare_v = 0.0;
};

std::vector<SensorRow> read_sensors(const std::string& file, files::Problems& problems) {
  const std::size_t before = problems.size();
  const std::vector<CsvColumn> columns{{.name = "channel", .minimum = 1.0, .maximum = kSensors},
                                       {.name = "x_mm", .minimum = 0.0, .maximum = 2000.0},
                                       {.name = "y_mm", .minimum = 0.0, .maximum = 2000.0},
                                       {.name = "tare_v", .minimum = -kMostVolts, .maximum = kMostVolts}};
  const CsvTable table = CsvTable::read(file, columns, problems);
  if (problems.size() != before) return {};
  if (table.row_count() != kSensors) {
    report(problems, file, 0, "has " + std::to_string(table.row_count()) + " sensors; the transient requires " + std::to_string(kSensors));
    return {};
  }
  std::vector<SensorRow> sensors(kSensors);
  for (std::size_t row = 0; row < kSensors; ++row) {
    if (table.numbers("channel")[row] != static_cast<double>(row + 1)) {
      report(problems, file, CsvTable::line_of_row(row), "channels must be 1, 2, 3, 4 in this order");
    }
    sensors[row] = {.position = {{table.numbers("x_mm")[row]}, {table.numbers("y_mm")[row]}}, .tare_v = table.numbers("tare_v")[row]};
  }
  return sensors;
}

std::vector<CsvColumn> calibration_columns() {
  std::vector<CsvColumn> columns{{.name = "d_mm", .minimum = 0.0, .maximum = 100.0}};
  for (const char* name : kVoltColumns) columns.push_back({.name = name, .minimum = -kMostVolts, .maximum = kMostVolts});
  return columns;
}

/// Returns the seat of reach-model section 4; the extractor uses only positions and curves.
physics::RigModel read_rig(const std::string& folder, files::Problems& problems) {
  physics::RigModel rig{.plate = {.a = {400.0}, .b = {360.0}, .h = {6.0}, .e_pa = 3.3e9, .nu = 0.35},
                        .support = {.kind = physics::SupportKind::Edges},
                        .sensors = {}};
  const std::size_t before = problems.size();
  const auto sensors = read_sensors(path_of(folder, "sensors.csv"), problems);
  const std::string file = path_of(folder, "calibration.csv");
  const CsvTable table = CsvTable::read(file, calibration_columns(), problems);
  if (problems.size() != before) return rig;
  for (std::size_t k = 0; k < kSensors; ++k) {
    std::vector<physics::CurvePoint> points;
    for (std::size_t row = 0; row < table.row_count(); ++row) {
      points.push_back({{table.numbers("d_mm")[row]}, {table.numbers(kVoltColumns[k])[row]}});
    }
    auto curve = physics::SensorCurve::create(kVoltColumns[k], std::move(points));
    if (!curve) {
      report(problems, file, 1, curve.error().what);
      continue;
    }
    const core::Volts tare{sensors[k].tare_v};
    if (!curve->contains(tare)) report(problems, path_of(folder, "sensors.csv"), k + 2, "tare_v is outside the sensor's calibration");
    const core::Millimetres gap = curve->gap(tare);
    rig.sensors.push_back(
        {.label = "w" + std::to_string(k + 1), .position = sensors[k].position, .curve = std::move(*curve), .unloaded_gap = gap});
  }
  return rig;
}

std::vector<Subject> read_subjects(const std::string& file, files::Problems& problems) {
  const std::size_t before = problems.size();
  const std::vector<CsvColumn> columns{{.name = "subject", .is_text = true},
                                       {.name = "group", .is_text = true},
                                       {.name = "weight_kg", .minimum = 5.0, .maximum = 300.0},
                                       {.name = "height_cm", .minimum = 50.0, .maximum = 250.0},
                                       {.name = "arm_cm", .minimum = 10.0, .maximum = 150.0},
                                       {.name = "max_reach_cm", .minimum = 10.0, .maximum = 300.0}};
  const CsvTable table = CsvTable::read(file, columns, problems);
  std::vector<Subject> subjects;
  if (problems.size() != before) return subjects;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    const std::string& name = table.texts("subject")[row];
    if (name.empty() || std::ranges::find(subjects, name, &Subject::name) != subjects.end()) {
      report(problems, file, CsvTable::line_of_row(row), name.empty() ? "a subject without a name" : "subject '" + name + "' occurs twice");
    }
    const std::string& group = table.texts("group")[row];
    if (group != "healthy" && group != "stroke") {
      report(problems, file, CsvTable::line_of_row(row), "group '" + group + "' is not known: write healthy or stroke");
    }
    subjects.push_back({.name = name,
                        .is_healthy = group == "healthy",
                        .person = {.weight_kg = table.numbers("weight_kg")[row],
                                   .height_cm = table.numbers("height_cm")[row],
                                   .arm_length_cm = table.numbers("arm_cm")[row],
                                   .max_reach_cm = table.numbers("max_reach_cm")[row]}});
  }
  return subjects;
}

/// Returns the file with a trial's volts: the named file, else the subject's file for that rate (A_1500.csv), else the subject's file.
std::string volts_file(const std::string& folder, const CsvTable& table, std::size_t row) {
  if (table.has("file") && !table.texts("file")[row].empty()) return table.texts("file")[row];
  const std::string subject = table.texts("subject")[row];
  const std::string with_rate = subject + "_" + std::to_string(std::lround(table.numbers("rate_hz")[row])) + ".csv";
  std::error_code none;
  return std::filesystem::exists(path_of(folder, with_rate), none) ? with_rate : subject + ".csv";
}

/// Returns whether a name stays inside the folder.
bool is_plain_name(const std::string& name) { return std::filesystem::path(name).filename() == name && name != "." && name != ".."; }

class TrialReader {
 public:
  TrialReader(std::string folder, TrialSet& set, files::Problems& problems)
      : folder_(std::move(folder)), file_(path_of(folder_, "trials.csv")), set_(set), problems_(problems) {}

  void read() {
    const std::size_t before = problems_.size();
    const std::vector<CsvColumn> columns{{.name = "subject", .is_text = true},
                                         {.name = "trial", .minimum = 0.0, .maximum = 4294967295.0},
                                         {.name = "condition", .is_text = true},
                                         {.name = "rate_hz", .minimum = kSlowestHz, .maximum = 1e6},
                                         {.name = "file", .is_required = false, .is_text = true}};
    const CsvTable table = CsvTable::read(file_, columns, problems_);
    if (problems_.size() != before) return;
    for (std::size_t row = 0; row < table.row_count(); ++row) add_trial(table, row);
  }

 private:
  void add_trial(const CsvTable& table, std::size_t row) {
    const std::size_t line = CsvTable::line_of_row(row);
    const std::string& subject = table.texts("subject")[row];
    const auto found = std::ranges::find(set_.subjects, subject, &Subject::name);
    if (found == set_.subjects.end()) return report(problems_, file_, line, "subject '" + subject + "' is not in subjects.csv");
    const std::string& condition = table.texts("condition")[row];
    if (!condition.empty() && !target_cm(found->person, condition)) {
      report(problems_, file_, line,
             "condition '" + condition + "' is not a target: write max, a percentage of the arm length, or nothing");
    }
    const double number = table.numbers("trial")[row];
    if (number != std::floor(number)) return report(problems_, file_, line, "the trial number must be a whole number");
    Trial trial{.subject = static_cast<std::size_t>(found - set_.subjects.begin()),
                .number = static_cast<std::uint32_t>(number),
                .condition = condition,
                .rate = {},
                .volts = {}};
    const auto rate = core::Rate::from_hz(table.numbers("rate_hz")[row]);
    if (!rate) return report(problems_, file_, line, rate.error().what);
    trial.rate = *rate;
    const std::string name = volts_file(folder_, table, row);
    if (!is_plain_name(name))
      return report(problems_, file_, line, "file '" + name + "' is not a plain file name; the file must be in this folder");
    const auto* volts = file_of(name).find(trial.number);
    if (volts != nullptr) {
      trial.volts = *volts;
      set_.trials.push_back(std::move(trial));
    } else if (!is_broken_.at(name)) {
      report(problems_, file_, line, "trial " + std::to_string(trial.number) + " has no rows in " + name);
    }
  }

  const VoltsFile& file_of(const std::string& name) {
    const auto known = files_.find(name);
    if (known != files_.end()) return known->second;
    const std::size_t before = problems_.size();
    VoltsFile file = VoltsFile::read(path_of(folder_, name), problems_);
    is_broken_[name] = problems_.size() != before;  // reported once, not for each of its trials
    return files_.emplace(name, std::move(file)).first->second;
  }

  std::string folder_;
  std::string file_;
  TrialSet& set_;
  files::Problems& problems_;
  std::map<std::string, VoltsFile> files_;
  std::map<std::string, bool> is_broken_;
};

}  // namespace

TrialSet read_trial_set(const std::string& folder, files::Problems& problems) {
  TrialSet set;
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) {
    report(problems, folder, 0, "no such folder");
    return set;
  }
  set.rig = read_rig(folder, problems);
  set.subjects = read_subjects(path_of(folder, "subjects.csv"), problems);
  if (problems.empty()) TrialReader(folder, set, problems).read();
  return set;
}

std::optional<core::TrunkClass> class_of_condition(const std::string& condition) {
  if (condition == "80" || condition == "100") return core::TrunkClass::None;
  if (condition == "120") return core::TrunkClass::Minor;
  if (condition == "150") return core::TrunkClass::Moderate;
  if (condition == "max") return core::TrunkClass::Maximum;
  return std::nullopt;
}

std::optional<double> target_cm(const physics::Person& person, const std::string& condition) {
  if (condition == "max") return person.max_reach_cm;
  double percent = 0.0;
  const char* const end = condition.data() + condition.size();
  const auto [stop, error] = std::from_chars(condition.data(), end, percent);
  if (error != std::errc() || stop != end || !(percent > 0.0 && percent <= 1000.0)) return std::nullopt;
  return percent / 100.0 * person.arm_length_cm;
}

}  // namespace dts::lab::reach
