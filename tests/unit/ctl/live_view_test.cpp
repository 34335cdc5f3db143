// SPDX-License-Identifier: Apache-2.0
// The two ways of watching that are made for people.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <sstream>

#include "ctl/live_table.h"
#include "ctl/reading.h"
#include "ctl/text_lines.h"
#include "support/committed_text.h"
#include "unit/ctl/block_builder.h"

namespace dts::ctl {
namespace {

using namespace std::chrono_literals;

class LiveViewTest : public ::testing::Test {
 protected:
  std::string take() {
    std::string text = out_.str();
    out_.str({});
    all_ += dts::test::replaced(text, "\x1b", "^") + "----\n";
    return text;
  }
  /// All that was drawn, up to each look at it.
  void TearDown() override {
    take();
    dts::test::expect_committed("unit/ctl/said/" + dts::test::case_file(), all_ + talk_.str());
  }
  std::ostringstream out_;
  std::ostringstream talk_;
  cli::Console console_{.out = out_, .talk = talk_};
  std::string all_;
  const WatchSink::Time start_{100s};
};

TEST_F(LiveViewTest, TextLines_AtMostTenPerSecondAndNoLossUnsaid) {
  TextLines lines(console_);
  CopBlock cop({1.0F, 2.0F});

  lines.show(cop.block, 1, start_);
  take();
  cop.block.lost_scans = 7;
  lines.show(cop.block, 1, start_ + 50ms);
  EXPECT_EQ(take(), "");
  cop.block.lost_scans = 0;
  lines.show(cop.block, 1, start_ + 100ms);
  take();
  EXPECT_EQ(std::ranges::count(talk_.str(), '\n'), 1);
}

TEST_F(LiveViewTest, Table_StreamsThatComeTogetherAreAllUpToDateWhenDrawn) {
  LiveTable table(console_);
  CopBlock cop({1.0F, 2.0F});
  CopBlock raw({5.0F, 6.0F});
  raw.block.topic = "floor/raw";
  table.show(cop.block, 1, start_);
  table.refresh(start_);
  table.show(raw.block, 1, start_);
  table.refresh(start_);
  take();

  cop.values[0] = 1.5F;
  raw.values[0] = 5.5F;
  table.show(raw.block, 1, start_ + 100ms);
  table.refresh(start_ + 100ms);
  table.show(cop.block, 1, start_ + 101ms);
  table.refresh(start_ + 101ms);
  table.show(raw.block, 1, start_ + 200ms);
  table.refresh(start_ + 200ms);

  take();
}

TEST_F(LiveViewTest, Table_IsRedrawnInPlaceTenTimesPerSecond) {
  LiveTable table(console_);
  const CopBlock cop({1.0F, 2.0F});
  table.show(cop.block, 1, start_);
  table.refresh(start_);
  take();

  table.refresh(start_ + 99ms);
  EXPECT_EQ(take(), "");
  table.refresh(start_ + 100ms);
  take();
}

TEST_F(LiveViewTest, Table_CountsTheRateOverASecondWithoutTheFirstBlock) {
  LiveTable table(console_);
  const CopBlock cop({1.0F, 2.0F, 3.0F, 4.0F});
  for (int block = 0; block <= 50; ++block) table.show(cop.block, 2, start_ + 20ms * block);

  table.refresh(start_ + 1s);

  take();
}

TEST_F(LiveViewTest, Table_FrozenStreamDoesNotLookAlive) {
  RecordProperty("requirement", "UI-1");
  LiveTable table(console_);
  CopBlock cop({1.0F, 2.0F});
  cop.block.age_ns = 1'500'000;
  table.show(cop.block, 1, start_);
  table.refresh(start_ + 100ms);
  take();

  table.refresh(start_ + 5s);
  take();
}

TEST_F(LiveViewTest, Table_EventsScrollAboveIt) {
  LiveTable table(console_);
  const CopBlock cop({1.0F, 2.0F});
  v1::Event marker;
  marker.mutable_marker()->set_text("eyes closed");
  table.show(cop.block, 1, start_);
  table.refresh(start_);
  take();

  table.show(client::Event{.topic = "floor/marker", .rig = "floor", .kind = "marker", .body = &marker});
  table.refresh(start_ + 1ms);

  const std::string text = take();
  EXPECT_LT(text.find("marker: eyes closed"), text.find("floor/cop"));
}

TEST_F(LiveViewTest, Table_LongLinesAndManyStreamsStayOnTheScreen) {
  LiveTable table(console_);
  console_.columns = 40;
  console_.lines = 5;
  std::vector<std::string> topics;
  for (int rig = 0; rig < 6; ++rig) topics.push_back("rig" + std::to_string(rig) + "/cop");
  CopBlock cop({1.0F, 2.0F});
  for (const std::string& topic : topics) {
    cop.block.topic = topic;
    table.show(cop.block, 1, start_);
  }

  table.refresh(start_);

  std::istringstream lines(take());
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) EXPECT_LE(line.size(), 40U) << line;
  EXPECT_EQ(count, 4) << "headline, one stream in two lines, how many more";
}

TEST_F(LiveViewTest, Table_ValuesThatDoNotFitStandInTheNextLine) {
  LiveTable table(console_);
  console_.columns = 60;
  const CopBlock cop({1.0F, 2.0F});
  table.show(cop.block, 1, start_);
  table.refresh(start_);
  take();

  table.refresh(start_ + 100ms);
  take();
}

TEST_F(LiveViewTest, Table_ResizedTerminalIsErasedWhole) {
  LiveTable table(console_);
  const CopBlock cop({1.0F, 2.0F});
  table.show(cop.block, 1, start_);
  table.refresh(start_);
  take();
  console_.measure = [](cli::Console& console) { console.columns = 60; };

  table.refresh(start_ + 100ms);

  take();
}

TEST_F(LiveViewTest, Table_RunningValuesOfSwayStandBelowAndFinalOnesScroll) {
  LiveTable table(console_);
  CopBlock cop({1.0F, 2.0F});
  table.show(cop.block, 1, start_);
  table.refresh(start_);
  take();
  v1::Event event;
  event.mutable_sway()->set_is_preliminary(true);
  event.mutable_sway()->set_duration_s(3.5);
  const client::Event told{.topic = "floor/sway", .rig = "floor", .kind = "sway", .body = &event};

  table.show(told);
  EXPECT_EQ(take(), "");
  table.refresh(start_ + 100ms);
  take();
  table.refresh(start_ + 200ms);
  take();

  event.mutable_sway()->set_is_preliminary(false);
  table.show(told);
  take();
  table.refresh(start_ + 10s);
  take();
}

}  // namespace
}  // namespace dts::ctl
