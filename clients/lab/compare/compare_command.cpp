// SPDX-License-Identifier: Apache-2.0
#include "lab/compare/compare_command.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "cli/exit_status.h"
#include "lab/base/command.h"
#include "lab/base/problems.h"
#include "lab/compare/compare.h"
#include "lab/compare/compare_view.h"
#include "lab/compare/pair_report.h"
#include "lab/compare/session_pair.h"
#include "record/replace_file.h"
#include "settings/folders.h"

namespace dts::lab::compare {
namespace {

constexpr mode_t kReportMode = 0644;

struct Arguments {
  std::string first{};  ///< Recordings; or a session.
  std::string second{};
  std::string session{};
  std::uint32_t part = 0;
  force::CopChoice cop{};  ///< Of files of force plates.
  std::string plot{};
  std::string report{};
  bool is_json = false;
};

/// The recordings to compare.
struct Pair {
  std::string file_a;
  std::string file_b;
  PairNames names;
};

core::Result<Pair> find_pair(const Arguments& arguments) {
  const bool has_session = !arguments.session.empty();
  if (has_session ? !arguments.first.empty() : arguments.second.empty()) {
    return core::fail(core::ErrorCode::InvalidArgument, "compare needs two recordings, or the session of two rigs",
                      "dtslab compare A B, or dtslab compare --session ID");
  }
  if (!has_session) {
    const auto short_name = [](const std::string& file) { return std::filesystem::path(file).filename().string(); };
    return Pair{.file_a = arguments.first,
                .file_b = arguments.second,
                .names = {.a = short_name(arguments.first), .b = short_name(arguments.second)}};
  }
  DTS_TRY_ASSIGN(const auto found, find_session_pair(settings::state_directory(), arguments.session, arguments.part));
  return Pair{.file_a = found.file_a, .file_b = found.file_b, .names = {.session = arguments.session, .a = found.rig_a, .b = found.rig_b}};
}

core::Status check_outputs(const Arguments& arguments, const Pair& pair) {
  for (const auto& [out, ending] : {std::pair{&arguments.plot, ".svg"}, std::pair{&arguments.report, ".html"}}) {
    if (out->empty()) continue;
    if (!out->ends_with(ending)) {
      return core::fail(core::ErrorCode::InvalidArgument, "cannot write " + *out, std::string("use a name that ends in ") + ending);
    }
    DTS_TRY(check_out(*out, {pair.file_a, pair.file_b}));
  }
  return {};
}

core::Status write_outputs(const Arguments& arguments, const Pair& pair, const Comparison& comparison) {
  if (!arguments.plot.empty()) DTS_TRY(record::replace_file(arguments.plot, pair_pictures_svg(comparison, pair.names), kReportMode));
  if (!arguments.report.empty()) DTS_TRY(record::replace_file(arguments.report, pair_report_html(comparison, pair.names), kReportMode));
  return {};
}

int run_compare(const Arguments& arguments, cli::Console& console) {
  const auto pair = find_pair(arguments);
  if (!pair) return fail_with(console, pair.error());
  if (const auto checked = check_outputs(arguments, *pair); !checked) return fail_with(console, checked.error());
  files::Problems problems;
  const Recording a = read_recording(pair->file_a, arguments.cop, problems);
  const Recording b = read_recording(pair->file_b, arguments.cop, problems);
  if (!problems.empty()) return report_problems(console, problems);
  if (std::error_code none;
      std::filesystem::equivalent(pair->file_a, pair->file_b, none) && force::has_plates(pair->file_a, arguments.cop)) {
    return fail_with(
        console, core::Error{core::ErrorCode::InvalidArgument, "A and B are the same plate: --plate counts for both",
                             "write each plate as CSV and compare these: dtslab force " + pair->file_a + " --plate 2 --csv plate2.csv"});
  }
  const auto comparison = compare(a, b);
  if (!comparison) return fail_with(console, comparison.error());
  if (const auto written = write_outputs(arguments, *pair, *comparison); !written) return fail_with(console, written.error());
  if (arguments.is_json) {
    console.out << cli::document(to_json(*comparison));
  } else {
    print(*comparison, console);
  }
  for (const std::string& warning : warnings_of(*comparison)) warn(console, warning);
  return cli::kOk;
}

}  // namespace

void add_commands(cli::CommandLine& line) {
  const auto [command, arguments] =
      add_command(line, line.app, "compare", "Align two recordings of the centre of pressure and show their difference",
                  "dtslab compare plate.csv force_plate.csv | as thesis Table 4.2\n"
                  "dtslab compare --session 20261121T144525Z-floor-1 --report pair.html | both rigs of one session, as a page\n"
                  "dtslab compare session.xdf force_plate.csv --json | a recording of dtsd, for a program\n"
                  "dtslab compare session.xdf standing.c3d --ml +x --ap -y | beside a force plate in a C3D file\n",
                  run_compare);
  command
      .add_option("A", arguments.first,
                  "XDF recording, file of force plates, or CSV file with t_s,x_mm,y_mm (or ml_mm,ap_mm) and optionally trigger or marker")
      ->option_text(" ");
  command
      .add_option("B", arguments.second,
                  "Second recording, like A; rate and clock may differ. --plate, --ml and --ap count for A and B: if their plates differ, "
                  "write one or both in the axes of the laboratory first: dtslab force FILE --plate N --axes lab --csv OUT.csv")
      ->option_text(" ");
  command.add_option("--session", arguments.session, "Compare the recordings of a session of two rigs; A is that of the leading rig")
      ->option_text("ID");
  command.add_option("--part", arguments.part, "Part of the leading rig, if the session was resumed")->option_text("N");
  force::add_cop_choice(command, arguments.cop);
  command.add_option("--plot", arguments.plot, "Write pictures to this .svg file: both recordings over each other, and Bland-Altman")
      ->option_text("FILE");
  command.add_option("--report", arguments.report, "Write a report to this .html file: alignment, differences, pictures, methods")
      ->option_text("FILE");
  add_json(command, arguments.is_json);
}

}  // namespace dts::lab::compare
