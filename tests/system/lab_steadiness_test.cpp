// SPDX-License-Identifier: Apache-2.0
// The decision of a rig's steadiness model through the real programs: published when the trial ends, in the recording and the catalogue,
// and the same as `dtslab steadiness classify` says of the table that `dtslab sway` makes of the recording.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "daemon_process.h"
#include "pattern/pattern_model.h"

namespace dts::test {
namespace {

using nlohmann::json;
using posturography::Measure;

constexpr const char* kTwoTrials = R"(name = "two-trials"
sentence = "Eyes open, eyes closed"
rig_kind = "floor"
[trials]
starts_by_itself = true
settle_s = 0.5
duration_s = 4
rest_s = 0.2
[[trials.condition]]
name = "eyes-open"
labels = { eyes = "open" }
[[trials.condition]]
name = "eyes-closed"
labels = { eyes = "closed" }
)";

/// A model by hand. A trial of 4 s has the measures in time only.
pattern::PatternModel model_by_hand() {
  pattern::PatternModel model{.label = "group",
                              .condition = "condition=ec_firm",
                              .profile = "lp10",
                              .rate_hz = 100.0,
                              .duration_s = 4.0,
                              .discriminant = {.classes = {"old", "young"},
                                               .predictors = {{Measure::Mvelo, true, 2.1, 0.4, 0.01, 1000.0},
                                                              {Measure::Rdist, true, 1.4, 0.5, 0.01, 1000.0},
                                                              {Measure::RangeAp, true, 2.7, 0.5, 0.01, 1000.0},
                                                              {Measure::Pea95F, true, 4.9, 0.9, 0.01, 1e5}},
                                               .weights = {{0.31, -0.22, 0.17, 0.05}, {-0.29, 0.21, -0.13, -0.04}},
                                               .offsets = {-0.71, -0.69}},
                              .people = 124,
                              .groups = {{}, {}},
                              .verdict = pattern::Verdict::Told};
  model.figures.best_measure = "MVELO";
  return model;
}

class SteadinessDecisionOfARig : public testing::Test {
 protected:
  SteadinessDecisionOfARig() {
    const std::filesystem::path protocols = daemon_.directory() / "protocols";
    std::filesystem::create_directory(protocols);
    std::ofstream(protocols / "two-trials.toml") << kTwoTrials;
    std::ofstream(model_file()) << pattern::model_text(model_by_hand());
    std::ofstream(daemon_.directory() / "rigs" / "floor.toml", std::ios::app)
        << "\n[steadiness]\nmodel = \"group.json\"\ntrials = { eyes = \"closed\" }\n";
    daemon_.signal(SIGTERM);  // it has to see the model
    EXPECT_EQ(daemon_.wait(), 0);
    daemon_.restart();
  }
  [[nodiscard]] std::filesystem::path model_file() const { return daemon_.directory() / "rigs" / "group.json"; }

  DaemonProcess daemon_{{.device = "sim:floor?seed=7", .stages = R"([[stage]]
id = "guard"
[[stage]]
id = "window_filter"
[[stage]]
id = "linearise"
[[stage]]
id = "cop"
[[stage]]
id = "steadiness"
)"}};
};

TEST_F(SteadinessDecisionOfARig, LiveRecordedAndInTheLaboratory_AreTheSame) {
  RecordProperty("requirement", "SWAY-10");
  ASSERT_TRUE(daemon_.is_ready()) << daemon_.log();
  client::Subscriber subscriber = daemon_.subscribe({"floor/sway", "floor/trial"});
  const Finished started = daemon_.ctl({"session", "start", "--rig", "floor", "--protocol", "two-trials", "--json"});
  ASSERT_EQ(started.status, 0) << started.err;
  ASSERT_EQ(daemon_.ctl({"session", "trial", "next"}).status, 0);

  std::vector<v1::Sway> finals;
  std::chrono::steady_clock::time_point done;
  double latest_s = 0.0;
  while (finals.size() < 2) {
    const auto message = subscriber.receive(kPatience);
    ASSERT_TRUE(message && *message) << "the trials do not end";
    const auto* event = std::get_if<client::Event>(&**message);
    if (event == nullptr) continue;
    if (event->body->has_trial() && event->body->trial().step() == v1::TRIAL_EVENT_KIND_DONE) done = std::chrono::steady_clock::now();
    if (!event->body->has_sway() || event->body->sway().is_preliminary()) continue;
    latest_s = std::max(latest_s, std::chrono::duration<double>(std::chrono::steady_clock::now() - done).count());
    finals.push_back(event->body->sway());
  }
  RecordProperty("decision_after_trial_ms", std::to_string(1e3 * latest_s));
  std::printf("decision %.0f ms after the end of the trial\n", 1e3 * latest_s);

  EXPECT_FALSE(finals[0].has_decision()) << "the model decides trials with closed eyes only";
  ASSERT_TRUE(finals[1].has_decision());
  const v1::SteadinessDecision& decision = finals[1].decision();
  EXPECT_EQ(decision.outcome(), v1::DECISION_OUTCOME_DECIDED);
  ASSERT_EQ(decision.probabilities_size(), 2);
  EXPECT_EQ(decision.people(), 124U);

  ASSERT_EQ(daemon_.ctl({"session", "stop"}).status, 0);
  const std::string id = json::parse(started.out).at("session_id");
  ASSERT_TRUE(eventually([&] { return daemon_.control().status()->rigs(0).session().state() == v1::SESSION_STATE_IDLE; }));
  const Finished shown = daemon_.ctl({"session", "show", id, "--json"});
  ASSERT_EQ(shown.status, 0) << shown.err;
  const json session = json::parse(shown.out);
  const json& recorded = session.at("trials").at(1).at("sway").at("decision");
  EXPECT_EQ(recorded.at("group"), decision.group());
  EXPECT_EQ(recorded.at("probabilities").at(0).at("probability"), decision.probabilities(0).probability()) << "every bit";
  EXPECT_THAT(daemon_.ctl({"session", "show", id}).out, testing::HasSubstr("like " + decision.group() + ", p "));

  const std::string table = daemon_.directory() / "sway.csv";
  const std::string file = session.at("parts").at(0).at("file");
  const Finished measured = run_program({DTSLAB_PROGRAM, "sway", file, "--table", table});
  ASSERT_EQ(measured.status, 0) << measured.err;
  const Finished classified = run_program({DTSLAB_PROGRAM, "steadiness", "classify", model_file(), table, "--json"});
  ASSERT_EQ(classified.status, 0) << classified.err;
  const json prediction = json::parse(classified.out).at("predictions").at(1);
  EXPECT_EQ(prediction.at("outcome"), "decided");
  for (const v1::GroupProbability& group : decision.probabilities())
    EXPECT_NEAR(prediction.at("probabilities").at(group.group()).get<double>(), group.probability(), 1e-9);
}

}  // namespace
}  // namespace dts::test
