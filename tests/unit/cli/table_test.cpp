// SPDX-License-Identifier: Apache-2.0
#include "cli/table.h"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>

namespace dts::cli {
namespace {

class TableTest : public ::testing::Test {
 protected:
  std::ostringstream out_;
  std::ostringstream talk_;
  Console console_{.out = out_, .talk = talk_};
};

TEST_F(TableTest, NoRows_PrintsNothing) {
  const Table table({"NAME"});

  table.print(console_);

  EXPECT_EQ(out_.str(), "");
}

TEST_F(TableTest, Rows_AreAlignedLeftAndRight) {
  Table table({"NAME", ">COUNT", "NOTE"});
  table.add({{"a"}, {"1"}, {"first"}});
  table.add({{"longer"}, {"12345"}, {""}});

  table.print(console_);

  EXPECT_EQ(out_.str(),
            "NAME    COUNT  NOTE\n"
            "a           1  first\n"
            "longer  12345\n");
}

TEST_F(TableTest, Folded_ContinuesBelowWithTheFirstColumnAgain) {
  Table table({"NAME", ">ONE", ">TWO", ">THREE"});
  table.add({{"a"}, {"1"}, {"2"}, {"3"}});

  table.print_folded(console_, 14);

  EXPECT_EQ(out_.str(),
            "NAME  ONE  TWO\n"
            "a       1    2\n"
            "\n"
            "NAME  THREE\n"
            "a         3\n");
}

TEST_F(TableTest, FoldedWhereEverythingFits_IsAsPrinted) {
  Table table({"NAME", ">ONE"});
  table.add({{"a"}, {"1"}});

  table.print_folded(console_, 9);
  EXPECT_EQ(out_.str(), "NAME  ONE\na       1\n");
}

TEST_F(TableTest, FoldedToNothing_HasOneColumnATable) {
  Table table({"NAME", ">ONE", ">TWO"});
  table.add({{"a"}, {"1"}, {"2"}});

  table.print_folded(console_, 1);
  EXPECT_EQ(out_.str(), "NAME  ONE\na       1\n\nNAME  TWO\na       2\n");
}

TEST_F(TableTest, TextBeyondAscii_IsAlignedByCharacters) {
  Table table({"A", "B"});
  table.add({{"µm"}, {"x"}});
  table.add({{"mmm"}, {"y"}});

  table.print(console_);

  EXPECT_EQ(out_.str(), "A    B\nµm   x\nmmm  y\n");
}

TEST_F(TableTest, MissingCells_AreEmpty) {
  Table table({"A", "B"});
  table.add({{"x"}});

  table.print(console_);

  EXPECT_EQ(out_.str(), "A  B\nx\n");
}

TEST_F(TableTest, Colours_OnlyWhenTheConsoleHasThem) {
  Table table({"A"});
  table.add({{"x", Style::Bad}});
  table.print(console_);
  EXPECT_EQ(out_.str().find('\x1b'), std::string::npos);

  console_.has_colours = true;
  table.print(console_);
  EXPECT_NE(out_.str().find("\x1b[31mx\x1b[0m"), std::string::npos);
}

TEST(Decimal, Numbers_FixedPlacesAndADashForTheUndefined) {
  EXPECT_EQ(decimal(1.0 / 3.0, 2), "0.33");
  EXPECT_EQ(decimal(-0.5, 0), "0");
  EXPECT_EQ(decimal(-0.5, 1), "-0.5");
  EXPECT_EQ(decimal(std::numeric_limits<double>::quiet_NaN(), 2), "-");
  EXPECT_EQ(decimal(std::numeric_limits<double>::infinity(), 2), "-");
  EXPECT_EQ(decimal(std::numeric_limits<double>::max(), 3).size(), 313U);
}

TEST(Duration, Seconds_InTheTwoLargestUnits) {
  EXPECT_EQ(duration(0.0), "0.0 s");
  EXPECT_EQ(duration(59.94), "59.9 s");
  EXPECT_EQ(duration(60.0), "1 min 0 s");
  EXPECT_EQ(duration(3661.0), "1 h 1 min");
  EXPECT_EQ(duration(90000.0), "1 d 1 h");
  EXPECT_EQ(duration(-1.0), "-");
  EXPECT_EQ(duration(std::numeric_limits<double>::quiet_NaN()), "-");
}

}  // namespace
}  // namespace dts::cli
