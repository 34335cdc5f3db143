// SPDX-License-Identifier: Apache-2.0
#include "lab/csv.h"

#include <cmath>

#include "unit/lab/run_fixture.h"

namespace dts::lab {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

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
  /// "line:column: text" of the only problem.
  std::string only_problem() {
    EXPECT_EQ(problems_.size(), 1U);
    if (problems_.empty()) return {};
    return std::to_string(problems_[0].line) + ":" + std::to_string(problems_[0].column) + ": " + problems_[0].text;
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

TEST_F(CsvTest, WrongCells_AreReportedWithLineColumnAndRange) {
  (void)read("t_s,x_mm\n0,1\n1,nan\n");
  EXPECT_EQ(only_problem(), "3:3: x_mm: 'nan' is not a finite number");
  (void)read("t_s,x_mm\n0,1e999\n");
  EXPECT_EQ(only_problem(), "2:3: x_mm: '1e999' is not a finite number");
  (void)read("t_s,x_mm\n0,100.5\n");
  EXPECT_EQ(only_problem(), "2:3: x_mm = 100.5 is out of range; allowed: -100 .. 100");
  (void)read("t_s,x_mm\n,1\n");
  EXPECT_EQ(only_problem(), "2:1: t_s is empty");
  (void)read("t_s,x_mm\n0,1;2\n");
  EXPECT_EQ(only_problem(), "2:3: x_mm: '1;2' is not a finite number");
}

TEST_F(CsvTest, WrongShape_IsReported) {
  (void)read("t_s,x_mm\n0,1\n1\n2,3,4\n");
  ASSERT_EQ(problems_.size(), 2U);
  EXPECT_EQ(problems_[0].line, 3U);
  EXPECT_EQ(problems_[1].text, "3 cells, the header has 2");
  (void)read("t_s,x_mmm\n0,1\n");
  EXPECT_EQ(only_problem(), "1:1: column 'x_mm' is missing; is it 'x_mmm'?");
  (void)read("t_s,x_mm,t_s\n0,1,0\n");
  EXPECT_EQ(only_problem(), "1:10: column 't_s' stands twice");
  (void)read("");
  EXPECT_EQ(only_problem(), "0:0: is empty");
  (void)read("t_s,x_mm\n");
  EXPECT_EQ(only_problem(), "0:0: has no rows");
  (void)read("t_s,x_mm\n0,1\n\n1,2\n");
  EXPECT_EQ(only_problem(), "3:1: empty line between rows");
}

TEST_F(CsvTest, OpenQuotes_AreReportedWhereTheyBegin) {
  (void)read("t_s,x_mm,marker\n0,1,\"a\n1,2,b\n");
  EXPECT_EQ(only_problem(), "2:5: this quote is not closed on its line");
  (void)read("t_s,\"x_mm\n0,1\n");
  EXPECT_EQ(only_problem(), "1:5: this quote is not closed on its line");
}

TEST_F(CsvTest, Suggestions_NameNoColumnThatIsInItsPlace) {
  files::Problems problems;
  (void)CsvTable::read(write("x.csv", "x_mm,w1_mm\n0,1\n"), {{.name = "x_mm"}, {.name = "y_mm"}}, problems);

  ASSERT_EQ(problems.size(), 1U);
  EXPECT_EQ(problems[0].text, "column 'y_mm' is missing");
}

TEST_F(CsvTest, EndlessLinesAndProblems_AreGivenUp) {
  (void)read("t_s,x_mm\n0," + std::string(10'000, '1') + "\n0,x\n");
  EXPECT_THAT(only_problem(), HasSubstr("longer than 4096 characters"));

  std::string rows;
  for (int k = 0; k < 1000; ++k) rows += "a,b\n";
  (void)read("t_s,x_mm\n" + rows);
  EXPECT_LE(problems_.size(), 101U);
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
