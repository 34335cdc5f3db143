// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/gap_guide.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <sstream>

#include "support/committed_text.h"
#include "unit/ctl/calibrate/scripted_feed.h"

namespace dts::ctl {
namespace {

const std::vector<double> kOpen{0.6, 0.6};
const std::vector<double> kGapsMm{12.0, 11.0, 10.0};

class GapGuideTest : public ::testing::Test {
 protected:
  void TearDown() override { dts::test::expect_committed("unit/ctl/calibrate/said/" + dts::test::case_file(), said_ + asked_.str()); }
  [[nodiscard]] client::Result<std::vector<SteadyReading>> guide(bool is_guided) {
    Measurer measurer(feed_, {.labels = {"w1", "w2"},
                              .unit = "V",
                              .limits = {.window_scans = 100, .drift = 0.005, .noise = 0.05},
                              .patience_scans = 1000,
                              .say = [](const std::string&) {}});
    const Prompt prompt(asked_, [this]() -> std::optional<std::string> {
      if (answers_.empty()) return std::nullopt;
      std::string answer = answers_.front();
      answers_.pop_front();
      return answer;
    });
    return measure_gaps({.gaps_mm = kGapsMm,
                         .measurer = measurer,
                         .prompt = is_guided ? &prompt : nullptr,
                         .say = [this](const std::string& line) { said_ += line + "\n"; },
                         .labels = {"w1", "w2"}});
  }
  static std::vector<double> firsts(const std::vector<SteadyReading>& readings) {
    std::vector<double> volts;
    for (const SteadyReading& reading : readings) volts.push_back(std::round(100.0 * reading.mean[0]) / 100.0);
    return volts;
  }

  ScriptedFeed feed_{0.002};
  std::deque<std::string> answers_;
  std::ostringstream asked_;
  std::string said_;
};

TEST_F(GapGuideTest, Alone_NewLevelsAreTheGapsAndTheOpenSensorIsNone) {
  feed_.rest(kOpen, 30);
  for (const double volts : {0.9, 1.3, 1.8})
    feed_.move(kOpen, {volts, volts}, 2).rest({volts, volts}, 25).move({volts, volts}, kOpen, 2).rest(kOpen, 15);

  const auto readings = guide(false);

  ASSERT_TRUE(readings) << readings.error().what;
  EXPECT_EQ(firsts(*readings), (std::vector<double>{0.9, 1.3, 1.8}));
}

TEST_F(GapGuideTest, Alone_ALevelOfOneSensorOnlyIsNoGap) {
  feed_.rest(kOpen, 16).rest({0.9, 0.6}, 22).rest({0.9, 0.9}, 22).rest({1.3, 1.3}, 22);

  EXPECT_FALSE(guide(false)) << "the third gap never came";
}

TEST_F(GapGuideTest, Alone_ASensorThatStaysIsNamed) {
  feed_.rest(kOpen, 16).rest({0.9, 0.6}, 90);

  EXPECT_FALSE(guide(false));
}

TEST_F(GapGuideTest, Guided_EveryEnterIsAGapAndRedoTakesTheLastBack) {
  answers_ = {"", "", "r", "", ""};
  for (const double volts : {0.9, 9.9, 1.3, 1.8}) feed_.rest({volts, volts}, 13);

  EXPECT_EQ(firsts(guide(true).value()), (std::vector<double>{0.9, 1.3, 1.8}));
}

TEST_F(GapGuideTest, Guided_QuitReturnsFewer) {
  answers_ = {"", "q"};
  feed_.rest({0.9, 0.9}, 13);

  EXPECT_EQ(guide(true).value().size(), 1U);
}

}  // namespace
}  // namespace dts::ctl
