// SPDX-License-Identifier: Apache-2.0
#include "core/cell_text.h"

#include <gtest/gtest.h>

namespace dts::core {
namespace {

TEST(CsvCell, TextThatASpreadsheetWouldCompute_GetsAnApostrophe) {
  RecordProperty("requirement", "SEC-7");
  EXPECT_EQ(csv_cell("=1+1"), "'=1+1");
  EXPECT_EQ(csv_cell("=HYPERLINK(\"http://x\",1)"), "\"'=HYPERLINK(\"\"http://x\"\",1)\"");
  EXPECT_EQ(csv_cell("@SUM(A1)"), "'@SUM(A1)");
  EXPECT_EQ(csv_cell("\r=1"), "\"'\r=1\"");
  for (const char* text : {"=1+1", "+1+1", "-1+1", "@x", "\t=1", "-cmd|' /C calc'!A0"}) {
    EXPECT_EQ(as_cell(text), std::string("'") + text);
    EXPECT_EQ(text_of_cell(as_cell(text)), text);
  }
}

TEST(CsvCell, NumbersAndOtherText_StayAsTheyAre) {
  for (const char* text : {"", "-1", "-0.25", "-1e-9", "eyes open", "a=b", "n/a", "'x", "'-1"}) {
    EXPECT_EQ(csv_cell(text), text);
    EXPECT_EQ(text_of_cell(text), text);
  }
}

}  // namespace
}  // namespace dts::core
