// SPDX-License-Identifier: Apache-2.0
#include "lab/replay/replay_command.h"

#include <cmath>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/progress.h"
#include "cli/table.h"
#include "files/rig_file.h"
#include "lab/base/command.h"
#include "lab/base/problems.h"
#include "lab/base/rig.h"
#include "lab/replay/replay.h"

namespace dts::lab::replay {
namespace {

struct Arguments {
  std::string file;
  std::string speed = "max";
  std::string rig;  ///< Rig file; empty: the rig in the recording.
  bool is_json = false;
};

using cli::decimal;

cli::Json to_json(const ComparedStream& stream) {
  cli::Json json{{"stream", stream.name}, {"scans", stream.scans}};
  if (stream.difference || stream.scans > 0) json["is_identical"] = !stream.difference;
  if (!stream.difference) return json;
  json["first_difference"] = {{"segment", stream.difference->segment},
                              {"scan", stream.difference->scan},
                              {"channel", stream.difference->channel},
                              {"recorded", stream.difference->recorded},
                              {"computed", stream.difference->computed}};
  return json;
}

cli::Json to_json(const ReplayReport& report, const std::string& file, const std::string& damage) {
  cli::Json json{{"file", file},
                 {"scans", report.scans},
                 {"segments", report.segments},
                 {"is_state_restored", report.is_restored},
                 {"replay_s", report.duration_s},
                 {"scans_per_s", report.scans_per_s()},
                 {"streams", cli::Json::array()}};
  if (const auto is_identical = report.is_identical()) json["is_identical"] = *is_identical;
  for (const ComparedStream& stream : report.streams) json["streams"].push_back(to_json(stream));
  cli::Json last = cli::Json::object();
  cli::Json mean = cli::Json::object();
  for (const ChannelSummary& channel : report.cop) {
    cli::set_number(last, channel.name, channel.last);
    cli::set_number(mean, channel.name, channel.mean);
  }
  if (!report.cop.empty()) json["cop"] = {{"last", last}, {"mean", mean}};
  if (!report.notes.empty()) json["notes"] = report.notes;
  if (!damage.empty()) json["damage"] = damage;
  return json;
}

std::string comparison(const ComparedStream& stream) {
  if (!stream.difference) return stream.scans > 0 ? "identical" : "nothing to compare";
  const Difference& at = *stream.difference;
  return "differs at segment " + std::to_string(at.segment) + ", scan " + std::to_string(at.scan) +
         (at.channel.empty() ? "" : ", " + at.channel) + ": recorded " + at.recorded + ", computed " + at.computed;
}

void print(const ReplayReport& report, cli::Console& console) {
  cli::Table table({"STREAM", ">SCANS", "COMPARED WITH THE RECORDING"});
  for (const ComparedStream& stream : report.streams) {
    const auto style = stream.difference ? cli::Style::Bad : cli::Style::Good;
    table.add({{cli::printable(stream.name)}, {std::to_string(stream.scans)}, {cli::printable(comparison(stream)), style}});
  }
  table.print(console);
  for (const ChannelSummary& channel : report.cop) {
    console.out << channel.name << ": mean " << decimal(channel.mean, 3) << ", last " << decimal(channel.last, 3) << '\n';
  }
  console.out << report.scans << " scans in " << report.segments << (report.segments == 1 ? " segment, " : " segments, ")
              << decimal(report.scans_per_s(), 0) << " scans per second\n";
}

/// Returns whether the recording is sound up to its end; one that was cut short on purpose or repaired is.
bool is_sound(const std::string& damage) {
  return damage.empty() || damage.starts_with("incomplete: ") || damage.starts_with("recovered, ");
}

int run_replay(const Arguments& arguments, cli::Console& console) {
  const std::string& file = arguments.file;
  auto recording = record::Recording::open(file);
  if (!recording) return fail_with(console, recording.error());
  files::Problems problems;
  auto config = arguments.rig.empty() ? rig_of(**recording, file) : files::read_rig_file(arguments.rig, problems);
  if (!problems.empty()) return report_problems(console, problems);
  if (!config) return fail_with(console, config.error());
  if (config->name.empty()) config->name = "rig";
  const core::SystemClock clock;
  core::Result<ReplayReport> report;
  {
    cli::Progress progress(console, "replaying");
    report = replay(**recording, std::move(*config), file, clock, [&progress](double done) { progress.report(done); });
  }
  if (!report) return fail_with(console, report.error());
  const std::string& damage = (*recording)->damage();
  if (arguments.is_json) {
    console.out << cli::document(to_json(*report, file, damage));
  } else {
    print(*report, console);
  }
  for (const std::string& note : report->notes) warn(console, note);
  if (!damage.empty()) warn(console, file + ": " + damage);
  if (!report->is_identical().value_or(true)) return cli::kFailed;
  return is_sound(damage) ? cli::kOk : cli::exit_status(core::ErrorCode::DataDamaged);
}

}  // namespace

void add_commands(cli::CommandLine& line) {
  const auto [command, arguments] =
      add_command(line, line.app, "replay", "Recompute a recording and compare every derived stream bit by bit",
                  "dtslab replay session.xdf | with the rig that the file describes\n"
                  "dtslab replay session.xdf --json | with scans per second, for a program\n"
                  "dtslab replay session.xdf --rig rig.toml | with another rig: show the first difference\n",
                  run_replay);
  command.add_option("FILE.xdf", arguments.file, "Recording of dtsd")->required()->option_text(" ");
  command.add_option("--speed", arguments.speed, "max: as fast as possible. Default: max")
      ->option_text("max")
      ->check(CLI::IsMember({"max"}));
  add_rig(command, arguments.rig, "Rig file; default: the rig that the recording describes");
  add_json(command, arguments.is_json);
}

}  // namespace dts::lab::replay
