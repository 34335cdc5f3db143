// SPDX-License-Identifier: Apache-2.0
#include "lab/results/recorded_reaches_command.h"

#include <cmath>

#include "classifier/trunk_model.h"
#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/progress.h"
#include "cli/table.h"
#include "core/special_numbers.h"
#include "lab/base/command.h"
#include "lab/base/figure_json.h"
#include "lab/base/problems.h"
#include "lab/base/rig.h"
#include "record/recording.h"
#include "session/recorded_reaches.h"

namespace dts::lab::results {
namespace {

struct Arguments {
  std::string file;
  bool is_json = false;
};

using cli::decimal;
using core::kNaN;
using core::TrunkClass;

int number(TrunkClass trunk_class) { return static_cast<int>(trunk_class); }

cli::Json to_json(const session::ReachTrialResult& result) {
  cli::Json json{{"trial", result.trial}, {"attempt", result.attempt}, {"condition", result.condition}};
  cli::set_number(json, "target_cm", result.target_cm.value_or(kNaN));
  json["segment"] = result.segment;
  json["go_scan"] = result.go.value;
  json["has_gap"] = result.has_gap;
  if (result.expected) json["expected_class"] = number(*result.expected);
  if (result.reach) {
    cli::Json& reach = json["reach"];
    reach = {{"number", result.reach->number}, {"p1_scan", result.reach->p1.scan.value}, {"p3_scan", result.reach->p3.scan.value}};
    cli::set_number(reach, "d1_mm", result.reach->features.d1_mm());
    cli::set_number(reach, "d2_mm", result.reach->features.d2_mm());
    cli::set_number(reach, "p1_mm", result.reach->features.p1_mm);
    cli::set_number(reach, "smoothness", result.reach->features.smoothness);
    reach["flags"] = result.reach->flags;
  }
  if (!result.movement) return json;
  cli::Json& movement = json["movement"];
  movement = {{"class", number(result.movement->trunk_class)}, {"probability", result.movement->probability}};
  cli::set_number(movement, "trunk_deg", result.movement->trunk_deg);
  cli::set_number(movement, "trunk_lo_deg", result.movement->trunk_lo_deg);
  cli::set_number(movement, "trunk_hi_deg", result.movement->trunk_hi_deg);
  movement["reasons"] = result.movement->reasons;
  return json;
}

cli::Json to_json(const session::RecordedReaches& recorded, const std::string& file, const std::string& damage) {
  cli::Json json{{"file", file},
                 {"reaches", recorded.reaches},
                 {"recorded_results", recorded.live_results},
                 {"differing_results", recorded.differing},
                 {"trials", cli::Json::array()},
                 {"summary", cli::Json::array()}};
  for (const session::ReachTrialResult& result : recorded.trials) json["trials"].push_back(to_json(result));
  for (const session::SessionFigure& result : recorded.summary) json["summary"].push_back(figure_json(result));
  if (!damage.empty()) json["damage"] = damage;
  return json;
}

std::string class_word(const std::optional<TrunkClass>& trunk_class) {
  if (!trunk_class) return "-";
  switch (*trunk_class) {
    case TrunkClass::Rejected: return "rejected";
    case TrunkClass::None: return "none";
    case TrunkClass::Minor: return "minor";
    case TrunkClass::Moderate: return "moderate";
    case TrunkClass::Maximum: return "maximum";
  }
  return "?";
}

std::vector<cli::Cell> row_of(const session::ReachTrialResult& result) {
  const auto& movement = result.movement;
  const auto seen = movement ? std::optional(movement->trunk_class) : std::nullopt;
  const std::string words = result.has_gap ? "gap" : result.reach ? class_word(seen) : "no reach";
  const bool agrees = seen && result.expected && *seen == *result.expected;
  const bool is_window = movement && std::isfinite(movement->trunk_lo_deg);
  return {{std::to_string(result.trial)},
          {cli::printable(result.condition)},
          {decimal(result.target_cm.value_or(kNaN), 1)},
          {decimal(result.reach ? result.reach->features.d2_mm() : kNaN, 3)},
          {words, agrees ? cli::Style::Good : cli::Style::Plain},
          {class_word(result.expected)},
          {decimal(movement ? movement->trunk_deg : kNaN, 1)},
          {is_window ? decimal(movement->trunk_lo_deg, 1) + " .. " + decimal(movement->trunk_hi_deg, 1) : "-"}};
}

void print(const session::RecordedReaches& recorded, cli::Console& console) {
  cli::Table trials({">TRIAL", "TARGET", ">AT (cm)", ">D2 (mm)", "CLASS", "EXPECTED", ">TRUNK (deg)", ">90 %"});
  for (const session::ReachTrialResult& result : recorded.trials) trials.add(row_of(result));
  trials.print(console);
  if (!recorded.trials.empty()) console.out << '\n';
  cli::Table summary({"SUMMARY", ">VALUE", "UNIT"});
  for (const session::SessionFigure& result : recorded.summary) {
    summary.add({{result.name}, {decimal(result.value, 3)}, {result.unit == "1" ? "" : result.unit}});
  }
  summary.print(console);
  console.out << recorded.reaches << " reaches, " << recorded.trials.size() << " trials\n";
  if (recorded.live_results == 0) return;
  const std::string comparison = recorded.differing == 0 ? "live and recomputed values match"
                                                         : std::to_string(recorded.differing) + " differ from the recomputed values";
  console.out << recorded.live_results << " live results in the recording: "
              << cli::styled(console, recorded.differing == 0 ? cli::Style::Good : cli::Style::Bad, comparison) << '\n';
}

int run_reach_results(const Arguments& arguments, cli::Console& console) {
  const std::string& file = arguments.file;
  auto recording = record::Recording::open(file);
  if (!recording) return fail_with(console, recording.error());
  const auto config = rig_of(**recording, file);
  const classifier::TrunkModel* model = config && config->trunk_model ? &*config->trunk_model : nullptr;
  core::Result<session::RecordedReaches> recorded;
  {
    cli::Progress progress(console, "reading");
    recorded = session::read_recorded_reaches(**recording, model, [&progress](double done) { progress.report(done); });
  }
  if (!recorded) return fail_with(console, recorded.error());
  const std::string& damage = (*recording)->damage();
  if (arguments.is_json) {
    console.out << cli::document(to_json(*recorded, file, damage));
  } else {
    print(*recorded, console);
  }
  if (!recorded->person)
    warn(console, file + ": the session does not contain the body measures of the subject: no expected classes, no personal scale");
  if (model == nullptr) warn(console, file + ": no trunk model in the recording: the recorded classes are shown");
  if (!damage.empty()) warn(console, file + ": " + damage);
  return recorded->differing == 0 ? cli::kOk : cli::kFailed;
}

}  // namespace

void add_commands(cli::CommandLine& line, CLI::App& reach) {
  const auto [command, arguments] =
      add_command(line, reach, "results", "Show the results of the reaching trials in a recording: per trial and per session",
                  "dtslab reach results session.xdf | class and trunk angle of each trial\n"
                  "dtslab reach results session.xdf --json | all values, for a program\n",
                  run_reach_results);
  command.add_option("FILE.xdf", arguments.file, "Recording of dtsd")->required()->option_text(" ");
  add_json(command, arguments.is_json);
}

}  // namespace dts::lab::results
