// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/cop_guide.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <deque>
#include <limits>
#include <sstream>

#include "dts/v1/stream.pb.h"
#include "support/committed_text.h"
#include "unit/ctl/calibrate/scripted_feed.h"

namespace dts::ctl {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::vector<double> kEmpty{0.0, 0.0};
constexpr int kLong = 13;  // blocks: the hold of 100 scans and its lead-in of 25

/// A plate with two sensors and three points, a feed and answers that a test writes down.
class CopGuideTest : public ::testing::Test {
 protected:
  CopGuideTest() {
    std::string pattern = ::testing::TempDir() + "dts-guide-XXXXXX";
    folder_ = ::mkdtemp(pattern.data());
    progress_ = ProgressFile::create(folder_ / "p.jsonl", {{"points", {1, 2, 3}}}).value();
  }
  ~CopGuideTest() override { std::filesystem::remove_all(folder_); }
  void TearDown() override { dts::test::expect_committed("unit/ctl/calibrate/said/" + dts::test::case_file(), said_ + asked_.str()); }

  [[nodiscard]] client::Result<bool> guide(bool is_guided, std::size_t end = 3) {
    std::optional<Answer> typed;
    const Prompt prompt(
        asked_,
        [this]() -> std::optional<std::string> {
          if (answers_.empty()) return std::nullopt;
          std::string answer = answers_.front();
          answers_.pop_front();
          return answer;
        },
        [this] { return is_typing_ && !answers_.empty(); });
    Measurer measurer(feed_, {.labels = plate_.labels,
                              .unit = "mm",
                              .limits = {.window_scans = 100, .drift = 0.01, .noise = 0.1},
                              .refused_quality = v1::QUALITY_RAIL | v1::QUALITY_STUCK,
                              .patience_scans = 300,
                              .say = [this](const std::string& line) { said_ += line + "\n"; },
                              .sees = load_text,
                              .advise = [](const std::string&, std::uint8_t) { return "lighter"; },
                              .is_stopped =
                                  [&] {
                                    typed = prompt.poll();
                                    return typed.has_value();
                                  }});
    CopGuide guide({.plate = plate_,
                    .points = points_,
                    .measurer = measurer,
                    .progress = *progress_,
                    .typed = &typed,
                    .prompt = is_guided ? &prompt : nullptr,
                    .draws = draws_,
                    .say = [this](const std::string& line) { said_ += line + "\n"; },
                    .estimated_load_n = [this] { return estimated_load_n_; }});
    return guide.measure_until(end);
  }
  [[nodiscard]] double read(std::size_t index) const { return progress_->points()[index]->mean[0]; }
  ScriptedFeed& lift_and_put(double w_mm) { return feed_.rest(kEmpty, 1).rest({w_mm, w_mm}, kLong); }

  PlateView plate_{.a_mm = 430.0, .b_mm = 430.0, .labels = {"w1", "w2"}, .sensor_x_mm = {86.0, 344.0}, .sensor_y_mm = {86.0, 344.0}};
  std::vector<PlannedPoint> points_{{86.0, 215.0, 490.0}, {215.0, 215.0, 490.0}, {344.0, 215.0, 240.0}};
  std::filesystem::path folder_;
  std::optional<ProgressFile> progress_;
  ScriptedFeed feed_;
  std::optional<double> estimated_load_n_;
  std::deque<std::string> answers_;
  bool draws_ = false;
  bool is_typing_ = false;  ///< Answers come while nobody asks, too.
  std::ostringstream asked_;
  std::string said_;
};

TEST_F(CopGuideTest, Alone_EveryLoadAfterALiftOffIsTheNextPoint) {
  draws_ = true;
  lift_and_put(1.0);
  lift_and_put(2.0);
  lift_and_put(3.0);

  const auto measured = guide(false);

  ASSERT_TRUE(measured) << measured.error().what;
  EXPECT_TRUE(*measured);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(read(k), 1.0 + static_cast<double>(k), 0.001);
}

TEST_F(CopGuideTest, Alone_SkipTypedMeanwhileLeavesThePointOut) {
  is_typing_ = true;
  answers_ = {"s"};
  feed_.rest(kEmpty, 1);
  for (const double w_mm : {2.0, 3.0}) lift_and_put(w_mm);

  ASSERT_TRUE(guide(false));

  EXPECT_FALSE(progress_->points()[0]);
  EXPECT_NEAR(read(1), 2.0, 0.001);
}

TEST_F(CopGuideTest, WeightThatTheDaemonTakesForAnother_IsDoubtedOncePerLoad) {
  for (const double estimated_n : {490.0 / 1.5, 490.0 * 1.5, 686.0 / 9.81}) {
    feed_ = ScriptedFeed();
    progress_.reset();
    progress_ = ProgressFile::create(folder_ / "p.jsonl", {{"points", {1, 2, 3}}}).value();
    said_.clear();
    estimated_load_n_ = estimated_n;
    for (const double w_mm : {1.0, 2.0}) lift_and_put(w_mm);

    ASSERT_TRUE(guide(false, 2));

    const bool is_doubted = estimated_n < 100.0;
    EXPECT_EQ(said_.find("shows 70 N for this weight of 490 N") != std::string::npos, is_doubted) << estimated_n;
    EXPECT_EQ(said_.find("warning"), said_.rfind("warning")) << "once for 490 N";
  }
}

TEST_F(CopGuideTest, Alone_ALoadThatStaysIsNotMeasuredTwice) {
  feed_.rest(kEmpty, 1).rest({1.0, 1.0}, 100);

  EXPECT_FALSE(guide(false));  // the script ends: the second point never came
  EXPECT_EQ(progress_->next(), 1U);
}

TEST_F(CopGuideTest, Alone_ABadBlockUnderARestingLoadIsNoLiftOff) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  feed_.rest(kEmpty, 1).rest({1.0, 1.0}, kLong);
  feed_.rest({nan, nan}, 2).rest({0.0, 0.0}, 2, v1::QUALITY_RAIL).rest({0.0, 0.0}, 1, 0, true).rest({1.0, 1.0}, 2 * kLong);

  EXPECT_FALSE(guide(false));  // the script ends: the second point never came
  EXPECT_EQ(progress_->next(), 1U);
}

TEST_F(CopGuideTest, DoubtfulFromTheStart_SaysTheDoubtInsteadOfHanging) {
  answers_ = {""};
  feed_.rest({1.0, 1.0}, 40, v1::QUALITY_STUCK);

  EXPECT_FALSE(guide(true));
}

TEST_F(CopGuideTest, NothingPutThere_SaysWhatItSees) {
  answers_ = {""};
  feed_.rest(kEmpty, 40);

  EXPECT_FALSE(guide(true));
}

TEST_F(CopGuideTest, Skipped_IsLeftOutAndTheOthersAreMeasured) {
  answers_ = {"", "s", ""};
  for (const double w_mm : {1.0, 3.0}) feed_.rest({w_mm, w_mm}, kLong);

  ASSERT_TRUE(guide(true).value());

  EXPECT_FALSE(progress_->points()[1]);
  EXPECT_NEAR(read(2), 3.0, 0.001);
}

TEST_F(CopGuideTest, Redo_MeasuresTheLastPointOrThatOfTheNumberAgain) {
  answers_ = {"", "", "r", "", "r 1", "r 9", "", ""};
  for (const double w_mm : {9.0, 8.0, 2.0, 1.0, 3.0}) feed_.rest({w_mm, w_mm}, kLong);

  ASSERT_TRUE(guide(true).value());

  EXPECT_NEAR(read(0), 1.0, 0.001);
  EXPECT_NEAR(read(1), 2.0, 0.001);
}

TEST_F(CopGuideTest, QuitTypedWhileMeasuring_IsHonoured) {
  answers_ = {"", "q"};
  is_typing_ = true;
  feed_.rest(kEmpty, 5);

  const auto measured = guide(true);

  ASSERT_TRUE(measured) << measured.error().what;
  EXPECT_FALSE(*measured);
}

TEST_F(CopGuideTest, LiftedTooEarly_TheSamePointAgain) {
  feed_.rest(kEmpty, 1).rest({1.0, 1.0}, 5);  // half a hold
  lift_and_put(2.0);

  ASSERT_TRUE(guide(false, 1));

  EXPECT_NEAR(read(0), 2.0, 0.001);
}

TEST_F(CopGuideTest, LossInTheMiddleOfAHold_BeginsItAnew) {
  feed_.rest(kEmpty, 1).rest({1.0, 1.0}, 9).rest({2.0, 2.0}, kLong, 0, true);

  ASSERT_TRUE(guide(false, 1));

  EXPECT_NEAR(read(0), 2.0, 0.001);
  EXPECT_TRUE(feed_.is_used_up()) << "the hold before the loss must not count";
}

TEST_F(CopGuideTest, DoubtfulQuality_IsNeverRecorded) {
  feed_.rest(kEmpty, 1).rest({1.0, 1.0}, 5).rest({9.0, 9.0}, 30, v1::QUALITY_RAIL).rest({2.0, 2.0}, kLong);

  ASSERT_TRUE(guide(false, 1));

  EXPECT_NEAR(read(0), 2.0, 0.001);
}

TEST_F(CopGuideTest, NoRest_SaysWhatMovesAndWaits) {
  feed_.rest(kEmpty, 1).move({1.0, 1.0}, {9.0, 1.0}, 60).rest({9.0, 1.0}, kLong);

  ASSERT_TRUE(guide(false, 1));
}

TEST_F(CopGuideTest, Guided_MeasuresAtEnterWithoutALiftOff) {
  answers_ = {"", "", ""};
  for (const double w_mm : {1.0, 2.0, 3.0}) feed_.rest({w_mm, w_mm}, kLong);

  const auto measured = guide(true);

  ASSERT_TRUE(measured) << measured.error().what;
  EXPECT_TRUE(*measured);
  EXPECT_NEAR(read(2), 3.0, 0.001);
  EXPECT_EQ(feed_.discarded, 3) << "what came before Enter must not count";
}

TEST_F(CopGuideTest, RedoWithoutAnything_IsSaid) {
  answers_ = {"r", "q"};

  ASSERT_TRUE(guide(true));
}

TEST_F(CopGuideTest, Quit_KeepsWhatWasMeasured) {
  answers_ = {"", "q"};
  feed_.rest({1.0, 1.0}, kLong);

  const auto measured = guide(true);

  ASSERT_TRUE(measured);
  EXPECT_FALSE(*measured);
  EXPECT_EQ(progress_->next(), 1U);
}

TEST_F(CopGuideTest, EndOfInput_Quits) {
  ASSERT_TRUE(guide(true));
  EXPECT_EQ(progress_->next(), 0U);
}

TEST_F(CopGuideTest, NonsenseAnswer_AsksAgain) {
  answers_ = {"yes", "q"};

  ASSERT_TRUE(guide(true));
}

TEST(HoldScans, TooFew_RefusedWithTheLeastTime) {
  EXPECT_EQ(hold_scans(0.1, 100.0).value(), 10U);
  EXPECT_EQ(hold_scans(0.08, 100.0).value(), 8U);
  const auto refused = hold_scans(0.07, 100.0);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr("0.070 s has 7 scans at 100.0 Hz; required: at least 8"));
}

TEST_F(CopGuideTest, WeightOnTheOtherSide_IsNotRecorded) {
  feed_.rest(kEmpty, 1).rest({1.0, 3.0}, kLong);  // the first point is at the left, beside w1
  feed_.rest(kEmpty, 1).rest({3.0, 1.0}, kLong);

  ASSERT_TRUE(guide(false, 1));

  EXPECT_NEAR(read(0), 3.0, 0.001);
}

}  // namespace
}  // namespace dts::ctl
