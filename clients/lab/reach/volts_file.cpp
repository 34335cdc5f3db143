// SPDX-License-Identifier: Apache-2.0
#include "lab/reach/volts_file.h"

#include <cmath>

#include "lab/base/csv.h"

namespace dts::lab::reach {

VoltsFile VoltsFile::read(const std::string& file, files::Problems& problems) {
  constexpr double kLargestV = 100.0;
  std::vector<CsvColumn> columns{{.name = "trial", .minimum = 0.0, .maximum = 4294967295.0}};
  for (const char* name : {"v1", "v2", "v3", "v4"}) columns.push_back({.name = name, .minimum = -kLargestV, .maximum = kLargestV});
  const std::size_t before = problems.size();
  const CsvTable table = CsvTable::read(file, columns, problems);
  VoltsFile result;
  if (problems.size() != before) return result;
  const std::vector<double>& numbers = table.numbers("trial");
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    const auto trial = static_cast<std::uint32_t>(numbers[row]);
    const bool is_new = row == 0 || numbers[row] != numbers[row - 1];
    if (numbers[row] != std::floor(numbers[row]) || (is_new && result.trials_.contains(trial))) {
      problems.push_back({file, static_cast<std::uint32_t>(CsvTable::line_of_row(row)), 1,
                          "trial must be a whole number, and the rows of a trial must follow each other"});
      return result;
    }
    result.trials_[trial].push_back(
        {table.numbers("v1")[row], table.numbers("v2")[row], table.numbers("v3")[row], table.numbers("v4")[row]});
  }
  return result;
}

const VoltsFile::Volts* VoltsFile::find(std::uint32_t trial) const {
  const auto found = trials_.find(trial);
  return found == trials_.end() ? nullptr : &found->second;
}

}  // namespace dts::lab::reach
