// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>

#include "support/made_c3d.h"
#include "unit/lab/run_fixture.h"

namespace dts::lab::force {

using test::MadeC3d;
using test::MadeEncoding;

inline constexpr double kEmpty = std::numeric_limits<double>::quiet_NaN();

/// Runs `dtslab force` and reads what it writes.
class ForceTest : public RunTest {
 public:
  using Row = std::map<std::string, double>;  ///< NaN: an empty cell.

 protected:
  /// The rows of a CSV file, by the names of its columns.
  [[nodiscard]] std::vector<Row> rows(const std::string& name) const {
    std::istringstream lines(content(name));
    std::string line;
    std::getline(lines, line);
    const std::vector<std::string> names = cells(line);
    std::vector<Row> found;
    while (std::getline(lines, line)) {
      const std::vector<std::string> values = cells(line);
      EXPECT_EQ(values.size(), names.size()) << line;
      Row& row = found.emplace_back();
      for (std::size_t k = 0; k < names.size(); ++k) row[names[k]] = values[k].empty() ? kEmpty : std::stod(values[k]);
    }
    return found;
  }
  static std::vector<std::string> cells(const std::string& line) {
    std::vector<std::string> found{""};
    for (const char letter : line) {
      if (letter == ',') {
        found.emplace_back();
      } else {
        found.back() += letter;
      }
    }
    return found;
  }
  /// Writes the file, runs `dtslab force FILE --csv out.csv --json` with more options, and returns the rows.
  std::vector<Row> force(const std::string& name, const std::string& bytes, std::vector<std::string> options = {}) {
    std::vector<std::string> words{"force", write(name, bytes), "--csv", path("out.csv"), "--json"};
    words.insert(words.end(), options.begin(), options.end());
    EXPECT_EQ(run_with(words), cli::kOk) << talk();
    return rows("out.csv");
  }
  /// The one line that a file which cannot be read causes, without the folder.
  std::string rejection(const std::string& name, const std::string& bytes, std::vector<std::string> options = {}) {
    std::vector<std::string> words{"force", write(name, bytes)};
    words.insert(words.end(), options.begin(), options.end());
    EXPECT_EQ(run_with(words), cli::kFailed) << talk();
    EXPECT_EQ(out(), "");
    const std::string text = talk();
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
    return text;
  }
  static void expect_row(const Row& row, const Row& expected, double relative = 1e-6) {
    for (const auto& [name, value] : expected) {
      ASSERT_TRUE(row.contains(name)) << name;
      if (std::isnan(value)) {
        EXPECT_TRUE(std::isnan(row.at(name))) << name << " = " << row.at(name);
      } else {
        EXPECT_NEAR(row.at(name), value, relative * std::max(1.0, std::abs(value))) << name;
      }
    }
  }
};

}  // namespace dts::lab::force
