// SPDX-License-Identifier: Apache-2.0
#include "lab/base/csv.h"

#include <cmath>

#include "unit/lab/run_fixture.h"

namespace dts::lab {
namespace {

using ::testing::ElementsAre;

class CsvTest : public RunTest {
 protected:
  CsvTable read(const std::string& text) {
    problems_.clear();
    return CsvTable::read(write("x.csv", text),
                          {{.name = "t_s"},
                           {.name = "x_mm", .may_be_empty = true, .minimum = -100.0, .maximum = 100.0},
                           {.name = "marker", .is_required = false, .is_text = true}},
                          problems_);
  }
  /// "line:column: text" of each problem.
  [[nodiscard]] std::string told() const {
    std::string all;
    for (const auto& [file, line, column, text] : problems_) {
      all += (all.empty() ? "" : "\n") + std::to_string(line) + ":" + std::to_string(column) + ": " + text;
    }
    return all;
  }

  files::Problems problems_;
};

TEST_F(CsvTest, Columns_InAnyOrderWithOthersLeftAlone) {
  const CsvTable table = read("x_mm,other,t_s\n1.5,what?,0\n-2,,1e-2\n");

  EXPECT_TRUE(problems_.empty());
  EXPECT_THAT(table.numbers("t_s"), ElementsAre(0.0, 0.01));
  EXPECT_THAT(table.numbers("x_mm"), ElementsAre(1.5, -2.0));
  EXPECT_FALSE(table.has("marker"));
  EXPECT_THAT(table.lines(), ElementsAre("1.5,what?,0", "-2,,1e-2"));
}

TEST_F(CsvTest, SpreadsheetHabits_AreUnderstood) {
  const CsvTable table = read("\xEF\xBB\xBFt_s,x_mm,marker\r\n 0 ,,\"eyes, \"\"closed\"\"\"\r\n1,2,\r\n\r\n");

  EXPECT_TRUE(problems_.empty());
  EXPECT_TRUE(std::isnan(table.numbers("x_mm")[0]));
  EXPECT_THAT(table.texts("marker"), ElementsAre("eyes, \"closed\"", ""));
}

TEST_F(CsvTest, WrongCellsAndShapes_AreReportedWithLineColumnAndRange) {
  const std::string head = "t_s,x_mm\n";
  const std::vector<std::pair<std::string, std::string>> cases{
      {head + "0,1\n1,nan\n", "3:3: x_mm: 'nan' is not a finite number"},
      {head + "0,1e999\n", "2:3: x_mm: '1e999' is not a finite number"},
      {head + "0,1;2\n", "2:3: x_mm: '1;2' is not a finite number"},
      {head + "0," + std::string(41, 'x') + "\n", "2:3: x_mm: '" + std::string(40, 'x') + "' is not a finite number"},
      {head + "0,100\n1,-100\n", ""},
      {head + "0,100.5\n", "2:3: x_mm = 100.5 is out of range; allowed: -100 .. 100"},
      {head + "0,-100.5\n", "2:3: x_mm = -100.5 is out of range; allowed: -100 .. 100"},
      {head + ",1\n", "2:1: t_s is empty"},
      {head + "0,1\n1\n", "3:1: 1 cells, the header has 2"},
      {head + "0,1\n2,3,4\n", "3:1: 3 cells, the header has 2"},
      {head + "0,1\n\n1,2\n", "3:1: empty line between rows"},
      {head, "0:0: has no rows"},
      {"", "0:0: is empty"},
      {"t_s,x_mmm\n0,1\n", "1:1: column 'x_mm' is missing; did you mean 'x_mmm'?"},
      {"t_s,x_mm,t_s\n0,1,0\n", "1:10: column 't_s' occurs twice"},
      {"t_s,x_mm,marker\n0,1,\"a\n1,2,b\n", "2:5: the quote is not closed on this line"},
      {"t_s,\"x_mm\n0,1\n", "1:5: the quote is not closed on this line"},
      {head + "0," + std::string(4094, ' ') + "\n", ""},
      {head + "0," + std::string(4095, ' ') + "\n0,x\n", "2:4096: longer than 4096 characters"}};
  for (const auto& [text, problem] : cases) {
    (void)read(text);
    EXPECT_EQ(told(), problem) << text;
  }
}

TEST_F(CsvTest, Suggestions_NameNoColumnThatIsInItsPlace) {
  files::Problems problems;
  (void)CsvTable::read(write("x.csv", "x_mm,w1_mm\n0,1\n"), {{.name = "x_mm"}, {.name = "y_mm"}}, problems);

  ASSERT_EQ(problems.size(), 1U);
  EXPECT_EQ(problems[0].text, "column 'y_mm' is missing");
}

TEST_F(CsvTest, AfterAHundredProblems_TheRestIsNotRead) {
  std::string text = "t_s,x_mm\n";
  for (int k = 0; k < 1000; ++k) text += "1,b\n";
  (void)read(text);
  EXPECT_EQ(problems_.size(), 100U);
}

TEST_F(CsvTest, NoFile_IsAProblem) {
  files::Problems problems;
  (void)CsvTable::read(path("none.csv"), {}, problems);
  (void)CsvTable::read(directory_.string(), {}, problems);

  ASSERT_EQ(problems.size(), 2U);
  EXPECT_EQ(problems[1].text, "no such file");
}

}  // namespace
}  // namespace dts::lab
