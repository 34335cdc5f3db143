// SPDX-License-Identifier: Apache-2.0
// `dtslab cop estimate`: a calibration applied to the deflections in a file.
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli/exit_status.h"
#include "cli/table.h"
#include "files/cop_calibration_file.h"
#include "files/whole_file.h"
#include "lab/base/command.h"
#include "lab/base/csv.h"
#include "lab/base/problems.h"
#include "lab/cop/cop_command.h"
#include "lab/cop/cop_points.h"

namespace dts::lab::cop {
namespace {

struct EstimateArguments {
  std::string calibration;
  std::string points;
  std::string out;
};

using physics::CopCalibration;
using physics::CopEstimate;

/// One person on two feet: the rows of the file, and what is known of the stance.
struct Person {
  std::string name;
  std::vector<std::size_t> rows{};
  std::optional<double> width_mm{};
  std::optional<double> weight_n{};
  double mean_load_n = 0.0;

  [[nodiscard]] bool is_doubtful() const noexcept { return weight_n && physics::is_load_doubtful(mean_load_n, *weight_n); }
};

std::optional<double> cell(const CsvTable& table, const char* column, std::size_t row) {
  const std::vector<double>& numbers = table.numbers(column);
  return numbers.empty() || std::isnan(numbers[row]) ? std::nullopt : std::optional(numbers[row]);
}

/// Returns the people in the file. A row that names no person and states neither width nor weight is a load in one point.
std::vector<Person> people_of(const CsvTable& table) {
  std::vector<Person> people;
  std::map<std::string, std::size_t> known;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    const std::string name = table.texts(kPersonColumn).empty() ? "" : table.texts(kPersonColumn)[row];
    const auto width_mm = cell(table, kWidthColumn, row);
    const auto weight_n = cell(table, kWeightColumn, row);
    if (name.empty() && !width_mm && !weight_n) continue;
    const auto found = known.find(name);
    const std::size_t index = name.empty() || found == known.end() ? people.size() : found->second;
    if (index == people.size()) {
      people.push_back({.name = name});
      if (!name.empty()) known.emplace(name, index);
    }
    Person& person = people[index];
    person.rows.push_back(row);
    if (!person.width_mm) person.width_mm = width_mm;
    if (!person.weight_n) person.weight_n = weight_n;
  }
  return people;
}

/// Corrects the estimates of a person's rows, and checks the load with the stated weight.
void correct(Person& person, const physics::TwoFeetCorrection& two_feet, const CopPoints& points, std::vector<CopEstimate>& estimates) {
  double sum_n = 0.0;
  double count = 0.0;
  for (const std::size_t row : person.rows) {
    estimates[row] = two_feet.apply(estimates[row], points.samples[row].deflection_mm, person.width_mm);
    if (!std::isfinite(estimates[row].load_n)) continue;
    sum_n += estimates[row].load_n;
    count += 1.0;
  }
  if (count == 0.0) return;
  person.mean_load_n = sum_n / count;
  if (!person.is_doubtful()) return;
  for (const std::size_t row : person.rows) {
    estimates[row].flags = static_cast<std::uint8_t>(estimates[row].flags | physics::cop_flag::kDoubtful);
  }
}

std::string estimates_text(const CsvTable& table, const std::vector<CopEstimate>& estimates) {
  std::string text = table.header();
  for (const char* name : kEstimateColumns) text += "," + std::string(name);
  text += '\n';
  for (std::size_t row = 0; row < estimates.size(); ++row) {
    const CopEstimate& estimate = estimates[row];
    text += table.lines()[row];
    add_csv_number(text, estimate.x_mm);
    add_csv_number(text, estimate.y_mm);
    add_csv_number(text, estimate.load_n);
    text += "," + physics::cop_flags_text(estimate.flags) + "\n";
  }
  return text;
}

void warn_of_doubts(const std::vector<Person>& people, const std::vector<CopEstimate>& estimates,
                    const physics::TwoFeetCorrection& two_feet, cli::Console& console) {
  std::size_t beyond = 0;
  for (const CopEstimate& estimate : estimates) beyond += (estimate.flags & physics::cop_flag::kOutsideTravel) != 0 ? 1 : 0;
  if (beyond > 0) {
    warn(console, std::to_string(beyond) + " rows have a deflection above " + cli::decimal(two_feet.form().travel_mm, 1) +
                      " mm: the sensors do not measure that far; use a stiffer plate for such a load");
  }
  for (const Person& person : people) {
    if (!person.is_doubtful()) continue;
    const std::string who =
        person.name.empty() ? "row " + std::to_string(person.rows.front() + 1) : "'" + cli::printable(person.name) + "'";
    warn(console, "person " + who + ": stated width or weight is doubtful; the load is " + cli::decimal(person.mean_load_n, 0) +
                      " N, the stated weight " + cli::decimal(*person.weight_n, 0) + " N");
  }
}

int run_cop_estimate(const EstimateArguments& arguments, cli::Console& console) {
  const auto apart = check_out(arguments.out, {arguments.points, arguments.calibration});
  if (!apart) return fail_with(console, apart.error());
  files::Problems problems;
  const auto calibration = files::read_cop_calibration(arguments.calibration, problems);
  if (!calibration) return report_problems(console, problems);
  const CopPoints points = read_cop_points(arguments.points, calibration->estimator.sensor_count(), false, std::nullopt, problems);
  if (!problems.empty()) return report_problems(console, problems);
  std::vector<CopEstimate> estimates;
  for (const physics::CopSample& sample : points.samples) estimates.push_back(calibration->estimator.estimate(sample.deflection_mm));
  std::vector<Person> people;
  if (calibration->two_feet) people = people_of(points.table);
  for (Person& person : people) correct(person, *calibration->two_feet, points, estimates);
  const auto written = files::write_whole_file(arguments.out, estimates_text(points.table, estimates));
  if (!written) return fail_with(console, written.error());
  if (calibration->two_feet) warn_of_doubts(people, estimates, *calibration->two_feet, console);
  const std::string corrected = people.empty() ? "" : ", " + std::to_string(people.size()) + " people on two feet";
  cli::print_hint(console, std::to_string(estimates.size()) + " estimates in " + arguments.out + corrected);
  return cli::kOk;
}

}  // namespace

void add_estimate(cli::CommandLine& line, CLI::App& cop) {
  const auto [command, arguments] = add_command(
      line, cop, "estimate",
      "Apply a calibration to deflections. A calibration of `cop two-feet` also corrects the rows of people: rows with the same "
      "text in column person are one stance; columns stated_width_mm and stated_weight_n may be empty. Other rows are loads in "
      "one point.",
      "dtslab cop estimate cal.toml points.csv --out est.csv | adds est_x_mm,est_y_mm,est_p_n,flags\n", run_cop_estimate);
  command.add_option("CAL.toml", arguments.calibration, "Calibration file of dtslab cop fit or dtslab cop two-feet")
      ->required()
      ->option_text(" ");
  command.add_option("POINTS.csv", arguments.points, "CSV file with columns w1_mm,w2_mm,...; other columns are copied")
      ->required()
      ->option_text(" ");
  command.add_option("--out", arguments.out, "File to write")->option_text("EST.csv")->required();
}

}  // namespace dts::lab::cop
