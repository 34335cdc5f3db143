// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stage_registry.h"

#include <gmock/gmock.h>

#include <limits>

#include "unit/pipeline/floor_rig.h"

namespace dts::pipeline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string all_stages() {
  std::string text;
  for (const StageEntry& entry : stage_registry()) (text += text.empty() ? "" : ", ") += entry.describe().id;
  return text;
}

TEST(CheckStage, GoodOptions_HaveNoProblems) {
  EXPECT_THAT(check_stage({.id = "window_filter", .options = {}}), IsEmpty());
  EXPECT_THAT(check_stage({.id = "window_filter", .options = {{"window_scans", 1.0}, {"shift_scans", 4096.0}}}), IsEmpty());
  EXPECT_THAT(check_stage({.id = "cop", .options = {{"estimator", "thesis"}}}), IsEmpty());
}

TEST(CheckStage, OneProblem_IsOneSentence) {
  const auto number = [](double value) { return StageConfig{.id = "window_filter", .options = {{"window_scans", value}}}; };
  const std::vector<std::pair<StageConfig, std::string>> rows{
      {{.id = "window_filtr", .options = {}}, "unknown stage 'window_filtr'; did you mean 'window_filter'?"},
      {{.id = "xyz", .options = {}}, "unknown stage 'xyz'; known: " + all_stages()},
      {{.id = "window_filter", .options = {{"window_scan", 3.0}}},
       "unknown option 'window_scan' of stage window_filter; did you mean 'window_scans'?"},
      {{.id = "window_filter", .options = {{"window_scans", "three"}}},
       "option 'window_scans' of stage window_filter must be a number, not the word 'three'"},
      {{.id = "cop", .options = {{"estimator", 3.0}}},
       "option 'estimator' of stage cop must be a word (poly3, thesis, thesis_per_pair, moment, model), not a number"},
      {{.id = "cop", .options = {{"estimator", "poly"}}}, "option 'estimator' of stage cop cannot be 'poly'; did you mean 'poly3'?"},
      {number(0.0), "option 'window_scans' of stage window_filter is 0; the range is 1 to 4096"},
      {number(4097.0), "option 'window_scans' of stage window_filter is 4097; the range is 1 to 4096"},
      {number(std::numeric_limits<double>::quiet_NaN()), "option 'window_scans' of stage window_filter is nan; the range is 1 to 4096"},
      {number(2.5), "option 'window_scans' of stage window_filter is 2.5; it must be a whole number from 1 to 4096"}};
  for (const auto& [config, sentence] : rows) EXPECT_THAT(check_stage(config), ElementsAre(sentence));
}

TEST(CheckStage, SeveralProblems_AreAllReported) {
  EXPECT_THAT(check_stage({.id = "guard", .options = {{"rail_codes", -1.0}, {"stuck_s", 1.0}, {"marker_v", "ground"}}}),
              ElementsAre(HasSubstr("marker_v"), HasSubstr("rail_codes"), HasSubstr("did you mean 'stuck_ms'?")));
}

TEST(CreateStage, BadOptions_FailWithAllSentences) {
  StageSurroundings surroundings;

  const auto stage = create_stage({.id = "guard", .options = {{"rail_codes", -1.0}, {"marker_v", 11.0}}}, surroundings.context());

  ASSERT_FALSE(stage);
  EXPECT_EQ(stage.error().code, core::ErrorCode::InvalidArgument);
  EXPECT_THAT(stage.error().what, HasSubstr("'rail_codes'"));
  EXPECT_THAT(stage.error().what, HasSubstr("'marker_v'"));
}

TEST(StageOptions, NameThatTheStageDoesNotDescribe_Throws) {
  const StageOptions options({{"window_scans", 3.0}});

  EXPECT_EQ(options.number("window_scans"), 3.0);
  EXPECT_ANY_THROW(static_cast<void>(options.number("window_ms")));
  EXPECT_ANY_THROW(static_cast<void>(options.word("window_scans")));
}

}  // namespace
}  // namespace dts::pipeline
