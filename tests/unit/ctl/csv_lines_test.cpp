// SPDX-License-Identifier: Apache-2.0
#include "ctl/csv_lines.h"

#include <gtest/gtest.h>

#include <sstream>

#include "unit/ctl/block_builder.h"

namespace dts::ctl {
namespace {

TEST(CsvLines, NameThatASpreadsheetWouldCompute_IsText) {
  std::ostringstream out;
  std::ostringstream talk;
  cli::Console console{.out = out, .talk = talk};
  CopBlock cop({-1.5F, 700.0F});
  cop.format.channels[0].name = "=cmd";
  cop.format.channels[1].name = "Fz, heel";

  CsvLines(console).show(cop.block, 1, {});

  EXPECT_EQ(out.str(), "segment,scan,'=cmd,\"Fz, heel\"\n3,40,-1.5,700\n");
}

}  // namespace
}  // namespace dts::ctl
