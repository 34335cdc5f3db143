// SPDX-License-Identifier: Apache-2.0
#include "session/standing_load.h"

#include <gmock/gmock.h>

#include <cmath>

namespace dts::session {
namespace {

SwayTrialResult trial(std::optional<double> load_n, const std::string& feet = "two", std::uint32_t flags = 0) {
  SwayTrialResult result{.labels = {{"feet", feet}}, .analysis = posturography::Analysis{}, .mean_load_n = load_n};
  result.analysis->flags = flags;
  return result;
}

TEST(StandingLoad, IsTheMeanOverTheValidTrialsOnTwoFeet) {
  const auto load = standing_load({trial(600.0), trial(640.0), trial(900.0, "one"), trial(std::nullopt),
                                   trial(100.0, "two", posturography::sway_flag::kSteppedOff), SwayTrialResult{.mean_load_n = 5.0}},
                                  {{"stance_width_mm", "180"}, {"weight_kg", "63"}});

  ASSERT_TRUE(load);
  EXPECT_EQ(load->mean_n, 620.0);
  EXPECT_EQ(load->trials, 2U);
  EXPECT_FALSE(load->is_doubtful());
  EXPECT_EQ(load->sentence(), "63.3 kg, corrected for two feet with the stated stance width of 180 mm");
}

TEST(StandingLoad, WithoutTheWidth_IsAbout) {
  const auto load = standing_load({trial(627.0)}, {});

  ASSERT_TRUE(load);
  EXPECT_EQ(load->sentence(), "about 64 kg, corrected for two feet without a stance width");
}

TEST(StandingLoad, FarFromTheStatedWeight_IsDoubtful) {
  RecordProperty("requirement", "COP-13");
  const auto with_width = standing_load({trial(627.0)}, {{"stance_width_mm", "180"}, {"weight_kg", "70"}});
  EXPECT_TRUE(with_width->is_doubtful());
  EXPECT_THAT(with_width->sentence(), testing::EndsWith("; stated width or weight is doubtful: 70 kg"));

  const auto without = standing_load({trial(627.0)}, {{"weight_kg", "70"}});
  EXPECT_THAT(without->sentence(), testing::EndsWith("; stated weight is doubtful: 70 kg"));
}

TEST(StandingLoad, WithoutATrialWithLoad_IsNone) {
  EXPECT_FALSE(standing_load({}, {{"weight_kg", "70"}}));
  EXPECT_FALSE(standing_load({trial(900.0, "one")}, {}));
}

TEST(StandingLoad, Result_HasTheSentence) {
  const SessionFigure figure = to_figure({.mean_n = 627.2, .trials = 4, .stance_width_mm = 180.0, .stated_kg = 80.0});

  EXPECT_EQ(figure.name, "load_n");
  EXPECT_EQ(figure.value, 627.2);
  EXPECT_EQ(figure.unit, "N");
  EXPECT_EQ(figure.details,
            R"({"trials":4,"stance_width_mm":180,"stated_weight_kg":80,"note":"64 kg, corrected for two feet with the stated stance width )"
            R"(of 180 mm; stated width or weight is doubtful: 80 kg"})");
}

TEST(MeanLoad, SkipsMissingSamples) {
  EXPECT_EQ(mean_load_n({.load_n = {600.0, std::nan(""), 610.0}}), 605.0);
  EXPECT_FALSE(mean_load_n({.load_n = {std::nan("")}}));
  EXPECT_FALSE(mean_load_n({}));
}

}  // namespace
}  // namespace dts::session
