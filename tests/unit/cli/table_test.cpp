// SPDX-License-Identifier: Apache-2.0
#include "cli/table.h"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>
#include <string>
#include <vector>

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

TEST_F(TableTest, TextBeyondAscii_IsAlignedByCharacters) {
  Table table({"A", "B"});
  table.add({{"µm"}, {"x"}});
  table.add({{"mmm"}, {"y"}});

  table.print(console_);

  EXPECT_EQ(out_.str(), "A    B\nµm   x\nmmm  y\n");
}

TEST_F(TableTest, NarrowTerminal_LastColumnsStandBelow) {
  Table table({"NAME", ">COUNT", "NOTE"});
  table.add({{"a"}, {"1"}, {"the first"}});
  table.add({{"longer"}, {"12345"}, {""}});
  console_.is_out_terminal = true;
  console_.columns = 20;

  table.print(console_);

  EXPECT_EQ(out_.str(),
            "NAME    COUNT\n"
            "  NOTE\n"
            "a           1\n"
            "  the first\n"
            "longer  12345\n");
}

TEST_F(TableTest, NarrowTerminal_DropsColumnsThatAreEmptyInAllRowsFirst) {
  Table table({"ID", "STARTED", "SUBJECT", "LABEL"});
  table.add({{"floor-1"}, {"2026-11-21"}, {"-"}, {""}});
  table.add({{"floor-2"}, {"2026-11-22"}, {""}, {""}});
  table.may_drop({"STARTED", "LABEL"});
  console_.is_out_terminal = true;
  const auto printed = [&](std::size_t columns) {
    out_.str({});
    console_.columns = columns;
    table.print(console_);
    return out_.str();
  };

  EXPECT_EQ(printed(60), "ID       STARTED     SUBJECT  LABEL\nfloor-1  2026-11-21  -\nfloor-2  2026-11-22\n");
  EXPECT_EQ(printed(30), "ID       STARTED     SUBJECT\nfloor-1  2026-11-21  -\nfloor-2  2026-11-22\n");
  EXPECT_EQ(printed(20), "ID       STARTED\nfloor-1  2026-11-21\nfloor-2  2026-11-22\n");
  EXPECT_EQ(printed(10), "ID\nfloor-1\nfloor-2\n");
}

TEST_F(TableTest, NarrowTerminal_DropsTheLeastImportantColumnsAndCutsNothing) {
  Table table({"ID", ">COUNT", "NOTE", "STATE"});
  table.add({{"20261121T144525Z-floor-1"}, {"1"}, {"the first"}, {"complete"}});
  table.may_drop({"NOTE", "COUNT", "no such column"});
  console_.is_out_terminal = true;
  const auto printed = [&](std::size_t columns) {
    out_.str({});
    console_.columns = columns;
    table.print(console_);
    return out_.str();
  };

  EXPECT_EQ(printed(60),
            "ID                        COUNT  NOTE       STATE\n"
            "20261121T144525Z-floor-1      1  the first  complete\n");
  EXPECT_EQ(printed(45),
            "ID                        COUNT  STATE\n"
            "20261121T144525Z-floor-1      1  complete\n");
  EXPECT_EQ(printed(35),
            "ID                        STATE\n"
            "20261121T144525Z-floor-1  complete\n");
  EXPECT_EQ(printed(20),
            "ID\n  STATE\n"
            "20261121T144525Z-floor-1\n  complete\n")
      << "wrapped by the terminal, but whole";
  console_.is_out_terminal = false;
  EXPECT_EQ(printed(20),
            "ID                        COUNT  NOTE       STATE\n"
            "20261121T144525Z-floor-1      1  the first  complete\n");
}

TEST_F(TableTest, WideEnoughTerminalOrNone_OneLineARow) {
  Table table({"NAME", "NOTE"});
  table.add({{"a"}, {"the first"}});
  console_.columns = 15;

  table.print(console_);
  EXPECT_EQ(out_.str(), "NAME  NOTE\na     the first\n");
  console_.is_out_terminal = true;
  table.print(console_);
  EXPECT_EQ(out_.str(), "NAME  NOTE\na     the first\nNAME  NOTE\na     the first\n");
}

TEST(Filled, PiecesStayTogetherAndTooWideOnesAreSplit) {
  using Lines = std::vector<std::string>;
  EXPECT_EQ(filled({"a 1", "b 2", "c 3"}, "  ", 8, "  "), (Lines{"a 1  b 2", "  c 3"}));
  EXPECT_EQ(filled({"abcdefghij"}, " ", 4, "  "), (Lines{"abcd", "  ef", "  gh", "  ij"}));
  EXPECT_EQ(filled({"µµµµ"}, " ", 3, ""), (Lines{"µµµ", "µ"}));
  EXPECT_EQ(filled({"ab"}, " ", 0, "  ").size(), 1U) << "no room at all: three columns are taken";
  EXPECT_EQ(wrapped("as  it  is", 10, "  "), (Lines{"as  it  is"}));
  EXPECT_EQ(wrapped("one two three", 8, "  "), (Lines{"one two", "  three"}));
  EXPECT_EQ(wrapped("one two  three", 8, "  "), (Lines{"one two", "  three"}));
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

TEST(WrappedAt, OnATerminal_WordsStayWholeAndLinesGoOnAtTheColumn) {
  std::ostringstream out;
  Console console{.out = out, .talk = out, .columns = 30};
  const std::string text = "is the machine overloaded? see dtsctl status";
  EXPECT_EQ(wrapped_at(console, 7, text), text);
  console.is_out_terminal = true;
  EXPECT_EQ(wrapped_at(console, 7, text), "is the machine\n       overloaded? see dtsctl\n       status");
  console.columns = 26;
  EXPECT_EQ(wrapped_at(console, 7, text), text) << "too narrow";
}

TEST(Duration, Seconds_InTheTwoLargestUnits) {
  const std::vector<std::pair<double, std::string>> rows{{0.0, "0.0 s"},
                                                         {59.94, "59.9 s"},
                                                         {59.95, "1 min 0 s"},
                                                         {59.99, "1 min 0 s"},
                                                         {1e12, "11574074 d 1 h"},
                                                         {60.0, "1 min 0 s"},
                                                         {3599.4, "59 min 59 s"},
                                                         {3600.0, "1 h 0 min"},
                                                         {3661.0, "1 h 1 min"},
                                                         {86399.0, "23 h 59 min"},
                                                         {86400.0, "1 d 0 h"},
                                                         {90000.0, "1 d 1 h"},
                                                         {1.001e12, "-"},
                                                         {-1.0, "-"},
                                                         {std::numeric_limits<double>::quiet_NaN(), "-"},
                                                         {std::numeric_limits<double>::infinity(), "-"}};
  for (const auto& [seconds, text] : rows) EXPECT_EQ(duration(seconds), text) << seconds;
}

}  // namespace
}  // namespace dts::cli
