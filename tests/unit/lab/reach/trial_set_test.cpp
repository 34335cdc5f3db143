// SPDX-License-Identifier: Apache-2.0
#include "lab/reach/trial_set.h"

#include <gmock/gmock.h>

#include "unit/lab/reach/trial_folder.h"

namespace dts::lab::reach {
namespace {

/// "file:line: text" of each problem, the file without its folder.
std::vector<std::string> problems_of(const TrialFolder& folder) {
  files::Problems problems;
  (void)read_trial_set(folder.path(), problems);
  std::vector<std::string> texts;
  for (const files::Problem& problem : problems) {
    const auto at = problem.line == 0 ? "" : ":" + std::to_string(problem.line);
    texts.push_back(std::filesystem::path(problem.file).filename().string() + at + ": " + problem.text);
  }
  return texts;
}

TEST(TrialSet, GoodFolder_IsReadWhole) {
  const TrialFolder folder;
  files::Problems problems;

  const TrialSet set = read_trial_set(folder.path(), problems);

  ASSERT_TRUE(problems.empty()) << files::to_string(problems.front());
  ASSERT_EQ(set.subjects.size(), 2U);
  EXPECT_TRUE(set.subjects[0].is_healthy);
  EXPECT_FALSE(set.subjects[1].is_healthy);
  EXPECT_EQ(set.subjects[1].person.max_reach_cm, 115.0);
  ASSERT_EQ(set.trials.size(), 3U);
  EXPECT_EQ(set.trials[1].condition, "80");
  EXPECT_EQ(set.trials[2].subject, 1U);
  EXPECT_EQ(set.trials[2].volts.size(), 600U);
  ASSERT_EQ(set.rig.sensors.size(), 4U);
  EXPECT_NEAR(set.rig.sensors[0].unloaded_gap.value, 8.388, 0.01);
}

TEST(TrialSet, WithoutAFileColumn_TakesTheSubjectsOwn) {
  const TrialFolder folder;
  folder.write("trials.csv", "subject,trial,rate_hz,condition\nP,1,100,150\n");
  files::Problems problems;

  const TrialSet set = read_trial_set(folder.path(), problems);

  ASSERT_EQ(set.trials.size(), 1U);
  EXPECT_EQ(set.trials[0].volts.size(), 600U);
}

TEST(TrialSet, MissingFolderOrFiles_AreNamed) {
  files::Problems problems;
  (void)read_trial_set("/nowhere/at/all", problems);
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_EQ(files::to_string(problems[0]), "/nowhere/at/all: no such folder");

  for (const std::string name : {"subjects.csv", "trials.csv", "sensors.csv", "calibration.csv", "Q.csv"}) {
    const TrialFolder folder;
    folder.remove(name);
    EXPECT_THAT(problems_of(folder), testing::Contains(name + ": no such file"));
  }
}

TEST(TrialSet, WrongRows_AreNamedWithTheirFileAndLine) {
  const std::string subjects = "subject,group,weight_kg,height_cm,arm_cm,max_reach_cm\n";
  const std::string sensors = "channel,x_mm,y_mm,tare_v\n1,140,120,0.6\n2,260,120,";
  const std::string trials = "subject,trial,rate_hz,condition\nP,1,100,150\n";
  struct Wrong {
    std::string file, text;
    std::vector<std::string> problems;
  };
  const std::vector<Wrong> cases{
      {"trials.csv", trials + "P,1,75,\nP,1,100,80\n", {}},
      {"trials.csv", trials + "X,1,100,150\n", {"trials.csv:3: subject 'X' is not in subjects.csv"}},
      {"trials.csv",
       trials + "P,2,100,far\nQ,1,100,-120\n",
       {"trials.csv:3: condition 'far' is not a target: write max, a percentage of the arm length, or nothing",
        "trials.csv:4: condition '-120' is not a target: write max, a percentage of the arm length, or nothing"}},
      {"trials.csv",
       trials + "P,7,100,150\nP,1.5,100,80\n",
       {"trials.csv:3: trial 7 has no rows in P.csv", "trials.csv:4: the trial number must be a whole number"}},
      {"trials.csv", trials + "P,1,74.9,\n", {"trials.csv:3: rate_hz = 74.9 is out of range; allowed: 75 .. 1000000"}},
      {"trials.csv",
       "subject,trial,file,rate_hz,condition\nP,1,../P.csv,100,150\nP,1,..,100,150\n",
       {"trials.csv:2: file '../P.csv' is not a plain file name; the file must be in this folder",
        "trials.csv:3: file '..' is not a plain file name; the file must be in this folder"}},
      {"subjects.csv",
       subjects + "P,healthy,68,175,67,124\nQ,Healthy,52,165,59,115\n",
       {"subjects.csv:3: group 'Healthy' is not known: write healthy or stroke"}},
      {"subjects.csv",
       subjects + "P,healthy,68,175,67,124\nP,stroke,52,165,59,115\n,stroke,52,165,59,115\n",
       {"subjects.csv:3: subject 'P' occurs twice", "subjects.csv:4: a subject without a name"}},
      {"sensors.csv", sensors + "0.6\n", {"sensors.csv: has 2 sensors; the transient requires 4"}},
      {"sensors.csv",
       sensors + "0.6\n4,140,220,0.6\n3,260,220,0.6\n",
       {"sensors.csv:4: channels must be 1, 2, 3, 4 in this order", "sensors.csv:5: channels must be 1, 2, 3, 4 in this order"}},
      {"sensors.csv", sensors + "0.01\n3,140,220,0.6\n4,260,220,0.6\n", {"sensors.csv:3: tare_v is outside the sensor's calibration"}},
      {"calibration.csv",
       "d_mm,v1,v2,v3,v4\n1,4,4,4,4\n2,3,3,3,3\n3,3.5,2,2,2\n9,0.5,0.5,0.5,0.5\n",
       {"calibration.csv:1: sensor curve 'v1', point 2 (3 mm, 3.5 V): the volts must keep rising or keep falling, so that a voltage means "
        "one gap"}},
      {"P.csv", "trial,v1,v2,v3\n1,1,1,1\n", {"P.csv:1: column 'v4' is missing"}},
      {"Q.csv",
       "trial,v1,v2,v3,v4\n1,1,1,1,1\n2,1,1,1,1\n1,1,1,1,1\n",
       {"Q.csv:4: trial must be a whole number, and the rows of a trial must follow each other"}}};
  for (const Wrong& wrong : cases) {
    SCOPED_TRACE(wrong.file + ": " + wrong.text);
    const TrialFolder folder;
    folder.write(wrong.file, wrong.text);
    EXPECT_EQ(problems_of(folder), wrong.problems);
  }
}

TEST(ClassOfCondition, Targets_HaveTheirClass) {
  EXPECT_EQ(class_of_condition("80"), core::TrunkClass::None);
  EXPECT_EQ(class_of_condition("100"), core::TrunkClass::None);
  EXPECT_EQ(class_of_condition("120"), core::TrunkClass::Minor);
  EXPECT_EQ(class_of_condition("150"), core::TrunkClass::Moderate);
  EXPECT_EQ(class_of_condition("max"), core::TrunkClass::Maximum);
  EXPECT_FALSE(class_of_condition("110"));
}

TEST(TargetCm, PartsOfTheArm_AndTheMaximum) {
  const physics::Person person{.arm_length_cm = 70.0, .max_reach_cm = 120.0};

  EXPECT_NEAR(target_cm(person, "150").value(), 105.0, 1e-9);
  EXPECT_EQ(target_cm(person, "max"), 120.0);
  for (const char* nonsense : {"", "far", "150cm", "-20", "0", "nan", "1e9"}) EXPECT_FALSE(target_cm(person, nonsense)) << nonsense;
}

TEST(FindReaches, EachTrial_HasItsOwnOrNone) {
  const TrialFolder folder;
  files::Problems problems;
  const TrialSet set = read_trial_set(folder.path(), problems);
  double done = 0.0;

  const auto reaches = find_reaches(set, [&done](double part) { done = part; });

  ASSERT_EQ(reaches.size(), 3U);
  ASSERT_TRUE(reaches[0]);
  EXPECT_FALSE(reaches[1]);  // sits still
  ASSERT_TRUE(reaches[2]);
  EXPECT_NEAR(reaches[0]->features.d2_mm(), 1.5, 0.1);
  EXPECT_NEAR(static_cast<double>(reaches[0]->p2.scan.value), 167.0, 6.0);
  EXPECT_EQ(reaches[0]->flags, 0);
  EXPECT_EQ(done, 1.0);
}

/// Trials are recordings of their own: their order and their neighbours must not matter.
TEST(FindReaches, OrderOfTrials_DoesNotMatter) {
  const TrialFolder folder;
  files::Problems problems;
  TrialSet set = read_trial_set(folder.path(), problems);
  const auto forward = find_reaches(set, nullptr);
  std::ranges::reverse(set.trials);

  const auto backward = find_reaches(set, nullptr);

  EXPECT_EQ(forward[0]->p3, backward[2]->p3);
  EXPECT_EQ(forward[0]->features.p1_mm, backward[2]->features.p1_mm);
}

}  // namespace
}  // namespace dts::lab::reach
