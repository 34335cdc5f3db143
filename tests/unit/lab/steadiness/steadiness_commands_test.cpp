// SPDX-License-Identifier: Apache-2.0
#include <random>

#include "lab/sway/sway_table.h"
#include "unit/lab/sway/sway_files.h"

namespace dts::lab::steadiness {
namespace {

using posturography::Measure;
using ::testing::HasSubstr;
using ::testing::Not;

class SteadinessTest : public RunTest {
 protected:
  /// Trials of people with eyes open and closed; closed is `shift` standard deviations larger.
  std::string table(const std::string& name, int people, double shift, bool has_subjects = true) {
    std::mt19937_64 random(11);
    std::normal_distribution<double> normal;
    std::vector<sway::MeasuredTrial> trials;
    for (int row = 0; row < 4 * people; ++row) {
      const bool is_open = row % 2 == 0;
      sway::MeasuredTrial trial{.file = "t" + std::to_string(row) + ".xdf"};
      if (has_subjects) trial.subject = "S" + std::to_string(row / 4);
      trial.labels = {{"eyes", is_open ? "open" : "closed"}};
      trial.analysis = posturography::Analysis{.rate_hz = 100.0, .samples = 3000, .duration_s = 30.0};
      for (const Measure measure : {Measure::Mvelo, Measure::Rdist, Measure::Pea95F}) {
        trial.analysis->measures.set(measure, 8.0 * std::exp(0.2 * (normal(random) + (is_open ? 0.0 : shift))));
      }
      trials.push_back(std::move(trial));
    }
    trials.back().analysis->flags = posturography::sway_flag::kMoved;
    return write(name, sway::table_text(trials));
  }
};

TEST_F(SteadinessTest, SeparableLabels_AreLearntAndToldAgain) {
  const std::string training = table("train.csv", 12, 6.0);

  ASSERT_EQ(run_with({"steadiness", "train", training, "--label", "eyes", "--out", path("eyes.json")}), cli::kOk) << talk();
  EXPECT_THAT(out(), HasSubstr("eyes: told (permutation p = 0.002)"));
  EXPECT_THAT(out(), HasSubstr("TOLD OF PEOPLE LEFT OUT (12 people, 47 trials, leave one out)"));
  EXPECT_THAT(out(), Not(HasSubstr("too few")));
  EXPECT_THAT(talk(), HasSubstr("1 rows left out: the subject stepped off or moved the feet"));

  ASSERT_EQ(run_with({"steadiness", "classify", path("eyes.json"), training, "--out", path("pred.csv")}), cli::kOk) << talk();
  EXPECT_THAT(content("pred.csv"),
              ::testing::StartsWith("file,session,subject,trial,label,p_closed,p_open,outside,outcome\nt0.xdf,,S0,,open,"));
  EXPECT_THAT(content("pred.csv"), HasSubstr(",decided\nt47.xdf,,"));
  EXPECT_THAT(content("pred.csv"), ::testing::EndsWith(",,not valid\n")) << "the last one moved the feet, though a label is computed";
  ASSERT_EQ(run_with({"steadiness", "classify", path("eyes.json"), training, "--json"}), cli::kOk);
  ASSERT_EQ(json().at("predictions").size(), 48U);
  EXPECT_EQ(json().at("predictions").at(1).at("label"), "closed");
  ASSERT_EQ(run_with({"steadiness", "classify", path("eyes.json"), training}), cli::kOk);
  EXPECT_THAT(out(), HasSubstr("PROBABILITY"));
}

TEST_F(SteadinessTest, RandomLabels_AreNotToldAndGiveNoModel) {
  RecordProperty("requirement", "SWAY-9");
  const std::string random = table("random.csv", 12, 0.0);
  const std::vector<std::string> words{"steadiness", "train", random, "--label", "eyes", "--out", path("m.json")};

  EXPECT_EQ(run_with(words), cli::kFailed);

  EXPECT_THAT(out(), HasSubstr("eyes: not told: "));
  EXPECT_THAT(out(), HasSubstr("10 x 10-fold"));
  EXPECT_THAT(talk(), HasSubstr("m.json was not written: eyes is not told\n  try: do not use such a model; to study it, add --research"));
  EXPECT_FALSE(std::filesystem::exists(path("m.json")));

  std::vector<std::string> research = words;
  research.emplace_back("--research");
  EXPECT_EQ(run_with(research), cli::kOk) << talk();
  ASSERT_EQ(run_with({"steadiness", "classify", path("m.json"), random}), cli::kOk);
  EXPECT_THAT(talk(), HasSubstr("this model is for research only: its label is not told in people left out"));

  EXPECT_EQ(run_with({"steadiness", "train", random, "--label", "eyes"}), cli::kOk) << "without --out it is only the test";
}

TEST_F(SteadinessTest, FewPeople_AreNoGroundForAClaim) {
  EXPECT_EQ(run_with({"steadiness", "train", table("few.csv", 6, 6.0), "--label", "eyes"}), cli::kOk) << talk();
  EXPECT_THAT(out(), HasSubstr("eyes: not told: only 6 subjects: too few for any claim about other people"));
}

TEST_F(SteadinessTest, RowsWithoutSubjects_AreSaidToFlatter) {
  const std::string training = table("train.csv", 5, 6.0, false);

  ASSERT_EQ(run_with({"steadiness", "train", training, "--label", "eyes", "--measures", "MVELO"}), cli::kOk) << talk();
  EXPECT_THAT(out(), HasSubstr("the results are too good"));
  ASSERT_EQ(run_with({"steadiness", "train", training, "--label", "eyes", "--json"}), cli::kOk);
  EXPECT_EQ(json().at("rows_without_subject"), 19);
  EXPECT_EQ(json().at("is_of_too_few_subjects"), true);
  EXPECT_EQ(json().at("is_told"), false);
  EXPECT_EQ(json().at("measures").size(), 3U);
}

TEST_F(SteadinessTest, MovedFeet_AreCountedByGroup) {
  ASSERT_EQ(run_with({"steadiness", "train", table("train.csv", 12, 6.0), "--label", "eyes", "--json"}), cli::kOk) << talk();
  EXPECT_EQ(json().at("classes").at(0), "closed");
  EXPECT_EQ(json().at("groups").at(0).at("not_valid"), 1);
  EXPECT_EQ(json().at("groups").at(0).at("trials"), 23);
  EXPECT_EQ(json().at("groups").at(1).at("not_valid"), 0);
}

/// People of two groups, with facts about them: age defines the group, weight shows it, and the place is where they stood.
std::string facts_table(double shift) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::string text = "file,subject,place,group,age,weight,sex,profile,fs_hz,flags,MVELO,RDIST\n";
  for (int person = 0; person < 40; ++person) {
    const bool is_old = person % 2 == 0;
    const double own = normal(random) + (is_old ? shift : 0.0);
    const double weight = 70.0 + 5.0 * normal(random) + (is_old ? 15.0 : 0.0);
    for (int row = 0; row < 4; ++row) {
      text += "f" + std::to_string(row) + ",S" + std::to_string(person) + (row < 3 ? ",firm," : ",foam,") + (is_old ? "old," : "young,") +
              (is_old ? "70," : "30,") + std::to_string(weight) + (person % 4 < 2 ? ",f" : ",m") + ",lp10,100," +
              (row == 3 && is_old ? "moved" : "") + "," + std::to_string(8.0 * std::exp(0.2 * (own + 0.1 * normal(random)))) + "," +
              std::to_string(5.0 * std::exp(0.3 * normal(random))) + "\n";
    }
  }
  return text;
}

std::string with_other(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  return at == std::string::npos ? std::string() : text.replace(at, from.size(), to);
}

TEST_F(SteadinessTest, Where_ChoosesTheRows) {
  const std::string file = write("facts.csv", facts_table(3.0));
  ASSERT_EQ(run_with({"steadiness", "train", file, "--label", "group", "--where", "place=firm", "--out", path("m.json"), "--json"}),
            cli::kOk)
      << talk();
  EXPECT_EQ(json().at("rows"), 120);
  EXPECT_EQ(json().at("condition"), "place=firm");
  EXPECT_EQ(json().at("defined_by"), nlohmann::json::array({"age"})) << "compared without being asked for";
  EXPECT_EQ(json().at("tests").at(0).at("rivals").size(), 1U) << "sex; age defines the group";

  ASSERT_EQ(run_with({"steadiness", "train", file, "--label", "group", "--where", "place=firm,foam", "--against", "none", "--json"}),
            cli::kOk);
  EXPECT_EQ(json().at("rows"), 140);
  EXPECT_EQ(json().at("groups").at(0).at("not_valid"), 20);
  EXPECT_EQ(json().at("tests").at(0).at("rivals").size(), 0U);
}

TEST_F(SteadinessTest, WeightThatTellsBetter_IsNamed) {
  const std::string file = write("facts.csv", facts_table(1.2));
  EXPECT_EQ(run_with({"steadiness", "train", file, "--label", "group", "--against", "weight", "--out", path("m.json")}), cli::kFailed);
  EXPECT_THAT(out(), HasSubstr("group: told by weight, not by sway: the AUC of weight alone is clearly larger"));
  EXPECT_FALSE(std::filesystem::exists(path("m.json")));
}

TEST_F(SteadinessTest, WithoutTheComparisonWithAge_NothingIsTold) {
  RecordProperty("requirement", "SWAY-9");
  const std::string facts = facts_table(3.0);
  const std::string file = write("facts.csv", facts);
  const auto train = [&](const std::string& table, const std::string& against) {
    std::vector<std::string> words{"steadiness", "train", table, "--label", "group", "--out", path("m.json")};
    if (!against.empty()) words.insert(words.end(), {"--against", against});
    return run_with(words);
  };
  EXPECT_EQ(train(file, "none"), cli::kFailed);
  EXPECT_THAT(out(), HasSubstr("group: not told: it was not compared with the people's age: the table needs the column 'age'"));
  EXPECT_EQ(train(file, "sex"), cli::kFailed);
  EXPECT_EQ(train(write("no_age.csv", with_other(facts, ",age,", ",years,")), ""), cli::kFailed);
  EXPECT_THAT(out(), HasSubstr("the table needs the column 'age'"));

  EXPECT_EQ(train(write("hole.csv", with_other(facts, ",old,70,", ",old,,")), ""), cli::kUsage);
  EXPECT_THAT(talk(), HasSubstr("'age' is empty in line 2\n  try: choose other columns with --against, or remove the row"));
  EXPECT_FALSE(std::filesystem::exists(path("m.json")));
  EXPECT_EQ(train(file, "age"), cli::kOk) << talk();
}

TEST_F(SteadinessTest, NoiseOfTheRig_LeavesOutWhatItChangesUnpredictably) {
  const std::string file = write("facts.csv", facts_table(3.0));
  ASSERT_EQ(run_with({"steadiness", "train", file, "--label", "group", "--noise-mm", "0.26", "--out", path("m.json"), "--json"}), cli::kOk)
      << talk();
  EXPECT_EQ(json().at("noise_mm"), 0.26);
  EXPECT_THAT(talk(), HasSubstr("SAMPEN_AP_20HZ"));
  EXPECT_EQ(run_with({"steadiness", "train", file, "--label", "group", "--noise-rate", "1500"}), cli::kUsage);
  EXPECT_THAT(talk(), HasSubstr("--noise-rate needs --noise-mm"));
}

TEST_F(SteadinessTest, RowsOutsideOfTraining_AreMarked) {
  ASSERT_EQ(run_with({"steadiness", "train", table("train.csv", 10, 6.0), "--label", "eyes", "--out", path("m.json")}), cli::kOk) << talk();
  const std::string other = write("other.csv", "file,profile,MVELO,RDIST,PEA95_F\nfar.csv,asis,900,8,8\nholes.csv,lp10,8,,8\n");

  ASSERT_EQ(run_with({"steadiness", "classify", path("m.json"), other, "--json"}), cli::kOk) << talk();

  EXPECT_THAT(json().at("predictions").at(0).at("outside"), ::testing::ElementsAre("MVELO"));
  EXPECT_FALSE(json().at("predictions").at(1).contains("label"));
  EXPECT_THAT(talk(), HasSubstr("1 of 2 rows are outside"));
  EXPECT_THAT(talk(), HasSubstr("1 of 2 rows have no label"));
  EXPECT_THAT(talk(), HasSubstr("another profile than 'lp10'"));
}

TEST_F(SteadinessTest, ShorterTrials_AreNotComparable) {
  ASSERT_EQ(run_with({"steadiness", "train", table("train.csv", 10, 6.0), "--label", "eyes", "--out", path("m.json")}), cli::kOk) << talk();
  EXPECT_THAT(content("m.json"), HasSubstr("\"duration_s\": 30.0"));
  const std::string other = write("other.csv", "file,duration_s,MVELO,RDIST,PEA95_F\na,30.1,8,8,8\nb,20,8,8,8\n");

  ASSERT_EQ(run_with({"steadiness", "classify", path("m.json"), other, "--json"}), cli::kOk) << talk();

  EXPECT_EQ(json().at("predictions").at(0).at("outcome"), "decided");
  EXPECT_EQ(json().at("predictions").at(1).at("outcome"), "not comparable");
  EXPECT_THAT(talk(), HasSubstr("1 of 2 rows are longer or shorter than 30 s, the duration of the trials of the training"));
}

TEST_F(SteadinessTest, FileOfForcePlates_IsAnalysedAtTheRateOfTheTraining) {
  ASSERT_EQ(run_with({"steadiness", "train", table("train.csv", 10, 6.0), "--label", "eyes", "--out", path("m.json")}), cli::kOk) << talk();
  for (const int rate_hz : {200, 130}) {  // every n-th sample is kept: of 130 Hz all
    std::string text = "time,Fz,Mx,My\n";
    for (int k = 0; k < 30 * rate_hz; ++k) {
      const double t_s = static_cast<double>(k) / rate_hz;
      text += std::to_string(t_s) + ",700," + std::to_string(3 * std::sin(t_s)) + "," + std::to_string(4 * std::cos(1.7 * t_s)) + "\n";
    }
    const std::string file = write("plate.csv", text);
    ASSERT_EQ(run_with({"steadiness", "classify", path("m.json"), file, "--ml", "+x", "--ap", "-y"}), cli::kOk) << talk();
    EXPECT_EQ(talk().find("1 of 1 rows were analysed at another rate than 100 Hz") != std::string::npos, rate_hz == 130) << talk();
  }
}

TEST_F(SteadinessTest, PredictionsForNamesOfFormulas_AreText) {
  ASSERT_EQ(run_with({"steadiness", "train", table("train.csv", 10, 6.0), "--label", "eyes", "--out", path("m.json")}), cli::kOk) << talk();
  const std::string other = write("other.csv", "file,subject,MVELO,RDIST,PEA95_F\n=far.csv,@S1,8,8,8\n");

  ASSERT_EQ(run_with({"steadiness", "classify", path("m.json"), other, "--out", path("pred.csv")}), cli::kOk) << talk();

  EXPECT_THAT(content("pred.csv"), HasSubstr("\n'=far.csv,,'@S1,,"));
}

TEST_F(SteadinessTest, BadInput_ExitsWithTwo) {
  const std::string training = table("train.csv", 3, 1.0);
  const std::string bad = write("bad.csv", "eyes,MVELO\nopen,fast\n");
  const std::string model = write("m.json", "{\"kind\": 3}");
  const std::string left_out = "warning: 1 rows left out: the subject stepped off or moved the feet\n";
  const auto train = [](const std::string& from, const std::string& label, const std::string& out, const std::string& measures) {
    return std::vector<std::string>{"steadiness", "train", from, "--label", label, "--out", out, "--measures", measures};
  };
  for (const auto& [words, says] :
       {std::pair(train(training, "eye", path("n.json"), "MVELO"),
                  std::string("train.csv:1:1: column 'eye' is missing; dtslab sway FILES --label eye=... adds it\n")),
        {train(training, "eyes", path("n.json"), "SPEED"),
         left_out + "dtslab: unknown measure 'SPEED'\n  try: write symbols such as MVELO,PEA95_F; dtslab sway --help lists them\n"},
        {train(training, "eyes", path("n.json"), "MFREQ"),
         left_out + "dtslab: MFREQ is missing in line 2\n  try: choose another measure, or remove the row\n"},
        {train(training, "profile", path("n.json"), "MVELO"),
         left_out + "dtslab: the column has fewer than two different labels\n  try: choose another column with --label\n"},
        {{"steadiness", "train", training, "--label", "eyes", "--where", "place"},
         "dtslab: --where 'place' is not COLUMN=VALUE\n  try: write for example --where condition=ec_firm\n"},
        {{"steadiness", "train", training, "--label", "eyes", "--where", "place=here"},
         "dtslab: train.csv has no column 'place'\n  try: choose another column with --where\n"},
        {{"steadiness", "train", training, "--label", "eyes", "--where", "MVELO=3"},
         "train.csv:1:1: 'MVELO' is a column of numbers: give another one\n"},
        {{"steadiness", "train", training, "--label", "eyes", "--against", "shoe"},
         left_out + "dtslab: train.csv has no column 'shoe'\n  try: choose other columns with --against\n"},
        {train(training, "eyes", training, "MVELO"), "dtslab: train.csv is the input file train.csv\n  try: write to another file\n"},
        {train(bad, "eyes", path("n.json"), "MVELO"), "bad.csv:2:6: MVELO: 'fast' is not a finite number\n"},
        {{"steadiness", "classify", model, training},
         "dtslab: m.json is not a model of dtslab steadiness train: 'kind' is not a text\n  try: train a new model: dtslab steadiness "
         "train\n"},
        {{"steadiness", "classify", path("none.json"), training}, "dtslab: none.json cannot be read\n  try: give an existing file\n"}}) {
    EXPECT_EQ(refusal_of(words), says);
  }
  EXPECT_FALSE(std::filesystem::exists(path("n.json")));
}

}  // namespace
}  // namespace dts::lab::steadiness
