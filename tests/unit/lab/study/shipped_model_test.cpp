// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "files/trunk_model_file.h"
#include "lab/study/left_out.h"

namespace dts::lab::study {
namespace {

/// The model of config/rigs/chair-sim.toml on people it never saw: made of simulated people of seed 1, these are of another.
TEST(ShippedModel, PeopleItNeverSaw_GetRightAnswersOrNone) {
  files::Problems problems;
  const auto model = files::load_trunk_model(std::string(DTS_SOURCE_DIR) + "/config/models/trunk-movement.toml", problems);
  ASSERT_TRUE(model.has_value());
  EXPECT_GT(model->form().facts.simulated_subjects, 0U);
  EXPECT_TRUE(model->form().facts.subjects.empty());  // nobody's data are in it

  const auto people = natural_reaches(teachers(), Targets::All, 4242, [](double) {});
  ASSERT_TRUE(people) << people.error().what;
  const RecommendedResult result = judge_by_model(*model, {&*people});

  // Measured over five draws of thirteen people: kept 0.90 to 0.97 and 0.99 to 1.00 of these right. Three people vary more.
  EXPECT_GE(result.general.kept.of_trunk().kept_share(), 0.75);
  EXPECT_GE(result.general.kept.of_trunk().kept_accuracy(), 0.95);
  EXPECT_GE(result.own.kept.of_trunk().kept_accuracy(), 0.95);
  EXPECT_LE(result.own.angle_rms_deg, 6.0);
  EXPECT_EQ(result.general.kept.total(), 225U);  // nobody's reach is lost
}

}  // namespace
}  // namespace dts::lab::study
