// SPDX-License-Identifier: Apache-2.0
#include "lab/training/model_training.h"

#include <gtest/gtest.h>

#include "files/trunk_model_file.h"
#include "lab/training/network_training.h"
#include "unit/lab/training/made_reaches.h"

namespace dts::lab::training {
namespace {

using classifier::ModelKind;
using core::TrunkClass;

const ModelOptions kFew{.networks = 3};

double accuracy_on(const classifier::TrunkModel& model, const TrainingSet& set) {
  double right = 0.0;
  double all = 0.0;
  for (const TrainingReach& reach : set.reaches) {
    if (reach.wanted < TrunkClass::Minor) continue;
    const auto movement = model.best_guess(reach.features, reach.flags);
    right += movement.trunk_class == reach.wanted ? 1.0 : 0.0;
    ++all;
  }
  return right / all;
}

TEST(TrainModel, Recommended_RightOfPeopleItNeverSaw) {
  const auto model = train_model(made_reaches(6, 1), kFew, {});

  ASSERT_TRUE(model) << core::to_string(model.error());
  EXPECT_GT(accuracy_on(*model, made_reaches(6, 2)), 0.95);
  EXPECT_GT(model->form().figures.left_out_accuracy, 0.95);
  EXPECT_LT(model->form().figures.left_out_angle_rms_deg, 6.0);
}

TEST(TrainModel, Raw5_Has75WeightsAndTheThesisInputs) {
  RecordProperty("requirement", "CLS-1");
  const auto model = train_model(made_reaches(3, 1), {.kind = ModelKind::Raw5}, {});

  ASSERT_TRUE(model) << core::to_string(model.error());
  ASSERT_EQ(model->form().general.networks.size(), 1U);
  EXPECT_EQ(model->form().general.networks.front().weights().size(), 75U);
  EXPECT_FALSE(model->form().angle);
}

TEST(TrainModel, SameSeed_SameModelToTheLastDigit) {
  const auto set = made_reaches(4, 1);

  const auto once = train_model(set, kFew, {});
  const auto again = train_model(set, kFew, {});
  auto options = kFew;
  options.seed = 2;
  const auto other = train_model(set, options, {});

  ASSERT_TRUE(once && again && other);
  EXPECT_EQ(files::trunk_model_text(*once), files::trunk_model_text(*again));
  EXPECT_NE(files::trunk_model_text(*once), files::trunk_model_text(*other));
}

TEST(TrainModel, LabelsShuffled_Refused) {
  RecordProperty("requirement", "CLS-6");
  for (const ModelKind kind : {ModelKind::Raw5, ModelKind::Recommended}) {
    auto set = made_reaches(4, 1);
    const auto order = Random(3).shuffled(set.reaches.size());
    const auto original = set.reaches;
    for (std::size_t k = 0; k < order.size(); ++k) set.reaches[k].wanted = original[order[k]].wanted;

    EXPECT_FALSE(train_model(set, {.kind = kind, .networks = 3}, {}));
  }
}

TEST(TrainNetwork, LabelsShuffled_TestAccuracyIsThatOfChance) {
  Random random(4);
  Batch batch{.input_count = 3, .inputs = {}, .classes = {}};
  for (int row = 0; row < 900; ++row) {
    for (int k = 0; k < 3; ++k) batch.inputs.push_back(random.uniform(-1.0, 1.0));
    batch.classes.push_back(random.index(3));
  }

  const auto trained = train_network(batch, {}, 1);

  ASSERT_TRUE(trained);
  EXPECT_NEAR(trained->test_accuracy, 1.0 / 3.0, 0.12);  // of 135
}

TEST(TrainModel, OneClassOnly_Refused) {
  auto set = made_reaches(4, 1);
  std::erase_if(set.reaches, [](const TrainingReach& reach) { return reach.wanted != TrunkClass::None; });

  EXPECT_FALSE(train_model(set, kFew, {}));
  EXPECT_FALSE(train_model({}, kFew, {}));
}

TEST(TrainModel, ReachesThatAreUnfit_DoNotTeach) {
  auto set = made_reaches(4, 1);
  const auto clean = train_model(set, kFew, {});
  TrainingReach bad = set.reaches[4];
  bad.flags = core::reach_flag::kSaturated;
  bad.features.p3_mm = 90.0;
  set.reaches.push_back(bad);
  bad.flags = 0;
  bad.features.p1_mm = core::ReachFeatures::kUnknown;
  set.reaches.push_back(bad);

  const auto model = train_model(set, kFew, {});

  ASSERT_TRUE(clean && model);
  EXPECT_EQ(model->form().general, clean->form().general);
}

TEST(ClassifyLeftOut, EachReach_JudgedOnceByAModelWithoutItsSubject) {
  auto set = made_reaches(4, 1);
  // A subject whose small reaches look like moderate ones: a model that had seen it would not be sure of those.
  for (std::size_t k = 0; k < set.reaches.size(); ++k) {
    if (set.reaches[k].subject == 3 && set.reaches[k].wanted == TrunkClass::Minor) set.reaches[k].features = set.reaches[k + 1].features;
  }

  const auto classified = classify_left_out(set, kFew, {});

  ASSERT_TRUE(classified) << core::to_string(classified.error());
  EXPECT_EQ(classified->size(), set.reaches.size());
  for (const LeftOutReach& one : *classified) {
    const TrainingReach& reach = set.reaches[one.reach];
    if (reach.subject == 3 && reach.wanted == TrunkClass::Minor) {
      EXPECT_EQ(one.general.trunk_class, TrunkClass::Moderate);
    }
  }
}

TEST(Folds, RecordedAlone_SimulatedInEightGroups) {
  TrainingSet set;
  for (int k = 0; k < 3; ++k) set.subjects.push_back({.name = "P"});
  for (int k = 0; k < 20; ++k) set.subjects.push_back({.name = "S", .is_simulated = true});

  const auto folds = folds_of(set);

  ASSERT_EQ(folds.size(), 11U);
  EXPECT_EQ(folds[0], std::vector<std::size_t>{0});
  EXPECT_EQ(folds[3], (std::vector<std::size_t>{3, 11, 19}));
}

}  // namespace
}  // namespace dts::lab::training
