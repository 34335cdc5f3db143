// SPDX-License-Identifier: Apache-2.0
#include "files/steadiness_model_file.h"

#include <gmock/gmock.h>

#include "files/rig_file.h"
#include "pattern/pattern_model.h"
#include "unit/files/files_fixture.h"

namespace dts::files {
namespace {

pattern::PatternModel told_model() {
  pattern::PatternModel model{.label = "group60",
                              .condition = "condition=ec_firm",
                              .profile = "lp10",
                              .rate_hz = 100.0,
                              .duration_s = 60.0,
                              .discriminant = {.classes = {"60plus", "under60"},
                                               .predictors = {{posturography::Measure::Mvelo, true, 2.0, 0.25, 3.0, 20.0}},
                                               .weights = {{0.7}, {-0.7}},
                                               .offsets = {0.1, 1.0 / 3.0}},
                              .groups = {{}, {}},
                              .verdict = pattern::Verdict::Told};
  model.figures.best_measure = "MVELO";
  return model;
}

class SteadinessModelFile : public FilesTest {
 protected:
  SteadinessModelFile() {
    std::filesystem::copy(kConfig / "sensors", folder_ / "sensors");
    write("rigs/group.json", pattern::model_text(told_model()));
  }
  [[nodiscard]] std::string rig_with(const std::string& tail) const { return write("rigs/floor.toml", shipped_ + tail); }

  const std::string shipped_ = edited(content_of(kConfig / "rigs/floor-sim.toml"), "calibration", "");
};

TEST_F(SteadinessModelFile, Model_IsReadWithItsTrialsAndIsInTheDefinition) {
  const std::string file = rig_with("\n[steadiness]\nmodel = \"group.json\"\ntrials = { eyes = \"closed\" }\n");

  Problems problems;
  const auto rig = read_rig_file(file, problems);
  ASSERT_EQ(text_of(problems), "");
  ASSERT_TRUE(rig.steadiness_model);
  EXPECT_EQ(rig.steadiness_model->model.label, "group60");
  EXPECT_EQ(rig.steadiness_model->text, pattern::model_text(told_model()));
  EXPECT_THAT(rig.steadiness_model->labels, testing::ElementsAre(testing::Pair("eyes", "closed")));

  const auto definition = rig_definition(file);
  ASSERT_TRUE(definition) << core::to_string(definition.error());
  const auto recorded = read_rig_text(*definition, "definition", problems);
  EXPECT_EQ(text_of(problems), "");
  ASSERT_TRUE(recorded.steadiness_model);
  EXPECT_EQ(recorded.steadiness_model->text, rig.steadiness_model->text) << "the hash in the events must be that of this text";
  EXPECT_EQ(recorded.steadiness_model->labels, rig.steadiness_model->labels);
}

TEST_F(SteadinessModelFile, WithoutATable_ThereIsNone) {
  Problems problems;
  EXPECT_FALSE(read_rig_file(rig_with(""), problems).steadiness_model);
  EXPECT_EQ(text_of(problems), "");
}

TEST_F(SteadinessModelFile, ModelOfAllConditions_NeedsNoTrials) {
  pattern::PatternModel model = told_model();
  model.condition.clear();
  write("rigs/all.json", pattern::model_text(model));
  Problems problems;
  EXPECT_TRUE(read_rig_file(rig_with("\n[steadiness]\nmodel = \"all.json\"\n"), problems).steadiness_model);
  EXPECT_EQ(text_of(problems), "");
}

TEST_F(SteadinessModelFile, WrongTable_IsReported) {
  pattern::PatternModel illness = told_model();
  illness.label = "ill";
  illness.verdict = pattern::Verdict::ToldByOther;
  illness.told_by = "age";
  write("rigs/ill.json", pattern::model_text(illness));
  write("rigs/damaged.json", "{\"kind\": 3}");
  for (const auto& [tail, says] : {
           std::pair("[steadiness]\n", "[steadiness] model is missing"),
           {"[steadiness]\nmodel = \"\"\n", "[steadiness] model is empty: name a file, or remove the table"},
           {"[steadiness]\nmodel = \"nowhere.json\"\n", "rigs/nowhere.json: "},
           {"[steadiness]\nmodel = \"damaged.json\"\n", "is not a model of dtslab steadiness train: 'kind' is not a text"},
           {"[steadiness]\nmodel = \"ill.json\"\n", "the model of 'ill' must not be shown: told by age, not by sway"},
           {"[steadiness]\nmodel = \"group.json\"\n", "the model was trained with condition=ec_firm only: name its trials in [steadiness]"},
           {"[steadiness]\nmodel = \"group.json\"\ntrials = {}\n", "the model was trained with condition=ec_firm only"},
           {"[steadiness]\nmodel = \"group.json\"\ntrial = {}\n", "unknown key 'trial' in [steadiness]; did you mean 'trials'?"},
           {"[steadiness]\nmodel = \"group.json\"\ntrials = { eyes = 3 }\n", "eyes must be a text in quotes"},
       }) {
    Problems problems;
    const auto rig = read_rig_file(rig_with("\n" + std::string(tail)), problems);
    EXPECT_FALSE(problems.empty()) << tail;
    EXPECT_THAT(text_of(problems), testing::HasSubstr(says)) << tail;
  }
}

TEST_F(SteadinessModelFile, RigWithoutCop_CannotUseIt) {
  std::string text = shipped_ + "\n[steadiness]\nmodel = \"group.json\"\ntrials = { eyes = \"closed\" }\n";
  text = edited(text, "id = \"cop\"", "id = \"guard\"");
  Problems problems;
  (void)read_rig_file(write("rigs/floor.toml", text), problems);
  EXPECT_THAT(text_of(problems), testing::HasSubstr("there is nothing that its steadiness model could decide"));
}

TEST_F(SteadinessModelFile, RecordedDefinition_OpensNoFile) {
  Problems problems;
  (void)read_rig_text(shipped_ + "\n[steadiness]\nmodel = \"/etc/hostname\"\n", "definition", problems);
  EXPECT_THAT(text_of(problems), testing::HasSubstr("the recorded model is not a model of dtslab steadiness train: it is not JSON"));
}

}  // namespace
}  // namespace dts::files
