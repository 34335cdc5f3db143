// SPDX-License-Identifier: Apache-2.0
#include "lab/compare/compare_command.h"

#include <string>

#include "cli/exit_status.h"
#include "lab/base/command.h"
#include "lab/base/problems.h"
#include "lab/compare/compare.h"
#include "lab/compare/compare_view.h"

namespace dts::lab::compare {
namespace {

struct Arguments {
  std::string first;  ///< Recordings.
  std::string second;
  force::CopChoice cop;  ///< Of files of force plates.
  bool is_json = false;
};

int run_compare(const Arguments& arguments, cli::Console& console) {
  files::Problems problems;
  const Recording a = read_recording(arguments.first, arguments.cop, problems);
  const Recording b = read_recording(arguments.second, arguments.cop, problems);
  if (!problems.empty()) return report_problems(console, problems);
  const auto comparison = compare(a, b);
  if (!comparison) return fail_with(console, comparison.error());
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
                  "dtslab compare session.xdf force_plate.csv --json | a recording of dtsd, for a program\n"
                  "dtslab compare session.xdf standing.c3d --ml +x --ap -y | beside a force plate in a C3D file\n",
                  run_compare);
  command
      .add_option("A", arguments.first,
                  "XDF recording, file of force plates, or CSV file with t_s,x_mm,y_mm (or ml_mm,ap_mm) and optionally trigger or marker")
      ->required()
      ->option_text(" ");
  command.add_option("B", arguments.second, "Second recording, like A; rate and clock may differ")->required()->option_text(" ");
  force::add_cop_choice(command, arguments.cop);
  add_json(command, arguments.is_json);
}

}  // namespace dts::lab::compare
