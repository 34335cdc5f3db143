// SPDX-License-Identifier: Apache-2.0
#include "ctl/csv_lines.h"

#include <gtest/gtest.h>

#include <sstream>

#include "unit/ctl/block_builder.h"

namespace dts::ctl {
namespace {

TEST(CsvLines, NameThatASpreadsheetWouldCompute_IsTextAndOtherStreamsAreLeftOut) {
  std::ostringstream out;
  std::ostringstream talk;
  cli::Console console{.out = out, .talk = talk};
  CopBlock cop({-1.5F, 700.0F});
  cop.format.channels[0].name = "=cmd";
  cop.format.channels[1].name = "Fz, heel";

  CopBlock raw({5.0F, 6.0F});
  raw.block.topic = "floor/raw";
  CsvLines lines(console);
  lines.show(cop.block, 1, {});
  for (int time = 0; time < 2; ++time) lines.show(raw.block, 1, {});

  EXPECT_EQ(out.str(), "segment,scan,'=cmd,\"Fz, heel\"\n3,40,-1.5,700\n");
  EXPECT_EQ(talk.str(), ": floor/raw is left out: CSV is of one stream\n  try: name that stream only\n") << "once";
}

}  // namespace
}  // namespace dts::ctl
