// SPDX-License-Identifier: Apache-2.0
#include "lab/thesis/thesis_command.h"

#include <string>
#include <string_view>
#include <vector>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/progress.h"
#include "cli/table.h"
#include "lab/base/command.h"
#include "lab/base/gnuplot.h"
#include "lab/base/problems.h"
#include "lab/thesis/thesis.h"

namespace dts::lab::thesis {
namespace {

constexpr std::string_view kTableWithFigures = "4.2";

struct Arguments {
  std::string table;
  std::string plot;  ///< Output file for the figures; empty: none.
  bool is_json = false;
};

cli::Json to_json(const Figures& figures) {
  cli::Json json = cli::Json::object();
  for (const Figure& figure : figures) cli::set_number(json, figure.name, figure.value);
  return json;
}

cli::Json to_json(const ThesisTable& table) {
  cli::Json json{{"table", table.name}, {"title", table.title}, {"rows", cli::Json::array()}};
  for (const ThesisRow& row : table.rows) {
    json["rows"].push_back(
        {{"label", row.label}, {"printed", to_json(row.printed)}, {"ours", to_json(row.ours)}, {"deviation", to_json(row.deviation)}});
  }
  json["summary"] = to_json(table.summary);
  json["notes"] = table.notes;
  return json;
}

void add_headers(const Figures& figures, const std::string& group, std::vector<std::string>& headers) {
  for (const Figure& figure : figures) {
    if (figure.is_in_table) headers.push_back(">" + group + " " + figure.name);
  }
}

void add_cells(const Figures& figures, int decimals, std::vector<cli::Cell>& cells) {
  for (const Figure& figure : figures) {
    if (figure.is_in_table) cells.push_back({cli::decimal(figure.value, decimals)});
  }
}

void print(const ThesisTable& table, cli::Console& console) {
  console.out << cli::styled(console, cli::Style::Bold, "Table " + table.name + ": " + table.title) << "\n\n";
  std::vector<std::string> headers{"ROW"};
  add_headers(table.rows.front().printed, "printed", headers);
  add_headers(table.rows.front().ours, "ours", headers);
  add_headers(table.rows.front().deviation, "off by", headers);
  cli::Table rows(headers);
  for (const ThesisRow& row : table.rows) {
    std::vector<cli::Cell> cells{{row.label}};
    add_cells(row.printed, table.decimals, cells);
    add_cells(row.ours, table.decimals, cells);
    add_cells(row.deviation, 3, cells);
    rows.add(std::move(cells));
  }
  rows.print(console);
  console.out << '\n';
  cli::Table summary({"SUMMARY", ">VALUE"});
  for (const Figure& figure : table.summary) summary.add({{figure.name}, {cli::decimal(figure.value, 3)}});
  summary.print(console);
  console.out << '\n';
  for (const std::string& note : table.notes) console.out << "- " << note << '\n';
}

core::Result<std::vector<ThesisTable>> compute(const std::vector<std::string>& names, cli::Console& console) {
  cli::Progress progress(console, "computing");
  progress.tick_by_itself();
  std::vector<ThesisTable> tables;
  for (const std::string& name : names) {
    DTS_TRY_ASSIGN(auto table, thesis_table(name, [&](double done) {
                     progress.report((static_cast<double>(tables.size()) + done) / static_cast<double>(names.size()));
                   }));
    tables.push_back(std::move(table));
  }
  return tables;
}

core::Status draw_figures(const Arguments& arguments, const std::vector<ThesisTable>& tables) {
  if (arguments.plot.empty()) return {};
  return draw(tables.front().figures, arguments.plot);
}

/// Only table 4.2 has figures.
core::Status check_plot(const Arguments& arguments) {
  if (arguments.plot.empty()) return {};
  if (arguments.table == kTableWithFigures) return check_plot_name(arguments.plot);
  return core::fail(core::ErrorCode::InvalidArgument, "table " + arguments.table + " has no figures to draw",
                    "dtslab thesis " + std::string(kTableWithFigures) + " --plot " + arguments.plot);
}

int run_thesis(const Arguments& arguments, cli::Console& console) {
  if (const auto plot = check_plot(arguments); !plot) return fail_with(console, plot.error());  // fail now, not after minutes
  std::vector<std::string> names{arguments.table};
  if (arguments.table == "all") names.assign(thesis_table_names().begin(), thesis_table_names().end());
  const auto computed = compute(names, console);
  if (!computed) return fail_with(console, computed.error());
  const std::vector<ThesisTable>& tables = *computed;
  if (const auto drawn = draw_figures(arguments, tables); !drawn) return fail_with(console, drawn.error());
  if (arguments.is_json) {
    cli::Json all = cli::Json::array();
    for (const ThesisTable& table : tables) all.push_back(to_json(table));
    console.out << cli::document(arguments.table == "all" ? cli::Json{{"tables", std::move(all)}} : all.front());
    return cli::kOk;
  }
  for (const ThesisTable& table : tables) {
    if (&table != &tables.front()) console.out << "\n\n";
    print(table, console);
  }
  return cli::kOk;
}

}  // namespace

void add_commands(cli::CommandLine& line) {
  const auto [command, arguments] =
      add_command(line, line.app, "thesis", "Compute a table of the thesis again and show it beside the printed values",
                  "dtslab thesis 3.2 | deflections of the acrylic plate\n"
                  "dtslab thesis 4.1 | estimated positions of fifteen loads\n"
                  "dtslab thesis 4.2 --plot loci.svg | floor platform on a force plate, simulated; also draw figures 4.11 to 4.13\n"
                  "dtslab thesis 6.2 | ten healthy volunteers, two networks, simulated people\n"
                  "dtslab thesis all --json | all tables, for a program\n",
                  run_thesis);
  command.add_option("TABLE", arguments.table, "3.2, 3.3, 3.4, 3.5, 3.6, 4.1, 4.2, 5.2, 6.2, 6.3, 6.4 or all")
      ->required()
      ->option_text(" ");
  add_plot(command, arguments.plot, "Draw figures 4.11 to 4.13 (only table 4.2)");
  add_json(command, arguments.is_json);
}

}  // namespace dts::lab::thesis
