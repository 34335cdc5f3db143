// SPDX-License-Identifier: Apache-2.0
// An examination of quiet standing through the real programs: what is told live and at the end of each trial, what stands in recording and
// catalogue, what report and laboratory make of it, are the same values.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "daemon_process.h"

namespace dts::test {
namespace {

using nlohmann::json;

/// As short as it can be: time-domain values only.
constexpr const char* kStanding = R"(name = "brief-standing"
sentence = "Eyes open, eyes closed"
rig_kind = "floor"
[trials]
starts_by_itself = true
settle_s = 0.5
duration_s = 4
rest_s = 0.2
[[trials.condition]]
name = "eyes-open"
labels = { eyes = "open", feet = "two" }
[[trials.condition]]
name = "eyes-closed"
labels = { eyes = "closed", feet = "two" }
)";

using Values = std::map<std::string, double>;

Values values_of(const v1::Sway& sway) {
  Values values;
  for (const v1::SwayMeasure& measure : sway.measures()) values[measure.symbol()] = measure.value();
  return values;
}
/// {"MVELO": {"value": 8.1, ...}, ...}, or [{"symbol": "MVELO", "value": ...}, ...].
Values values_of(const json& measures) {
  Values values;
  for (const auto& [key, measure] : measures.items()) {
    values[measure.contains("symbol") ? measure.at("symbol").get<std::string>() : key] = measure.at("value");
  }
  return values;
}

class QuietStanding : public testing::Test {
 protected:
  QuietStanding() {
    const std::filesystem::path folder = daemon_.directory() / "protocols";
    std::filesystem::create_directory(folder);
    std::ofstream(folder / "brief-standing.toml") << kStanding;
    daemon_.signal(SIGTERM);  // it has to see the protocol
    EXPECT_EQ(daemon_.wait(), 0);
    daemon_.restart();
  }
  [[nodiscard]] bool is_finished() const {
    return daemon_.control().status()->rigs(0).session().trial().phase() == v1::TRIAL_PHASE_FINISHED;
  }
  std::string examine() {
    const Finished started = daemon_.ctl({"session", "start", "--rig", "floor", "--protocol", "brief-standing", "--json"});
    EXPECT_EQ(started.status, 0) << started.err;
    EXPECT_EQ(daemon_.ctl({"session", "trial", "next"}).status, 0);
    EXPECT_TRUE(eventually([&] { return is_finished(); }));
    EXPECT_EQ(daemon_.ctl({"session", "stop"}).status, 0);
    return json::parse(started.out).at("session_id");
  }
  void stand_still() {  // until somebody stands there
    client::Subscriber cop = daemon_.subscribe({"floor/sway"});
    EXPECT_TRUE(eventually([&] {
      const auto message = cop.receive(std::chrono::milliseconds(500));
      return message && *message;
    }));
  }

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

/// Final values by trial, and the last preliminary ones of each.
struct Heard {
  std::map<std::uint32_t, v1::Sway> finals;
  std::map<std::uint32_t, v1::Sway> lasts;
};

Heard heard_sway(client::Subscriber& subscriber) {
  Heard all;
  while (true) {
    const auto message = subscriber.receive(kPatience);  // preliminary values go on after the trials
    if (!message || !*message) return all;
    const auto* event = std::get_if<client::Event>(&**message);
    if (event == nullptr || !event->body->has_sway()) continue;
    const v1::Sway& sway = event->body->sway();
    if (sway.is_preliminary()) {
      all.lasts[sway.trial()] = sway;
    } else {
      all.finals[sway.trial()] = sway;
    }
    for (const v1::SwayMeasure& measure : sway.measures()) EXPECT_TRUE(std::isfinite(measure.value())) << measure.symbol();
    if (all.finals.size() == 2 && sway.is_preliminary()) return all;
  }
}

TEST_F(QuietStanding, LiveCataloguedReportedAndInTheLaboratory_AreTheSame) {
  RecordProperty("requirement", "SWAY-3");
  ASSERT_TRUE(daemon_.is_ready()) << daemon_.log();
  stand_still();
  client::Subscriber subscriber = daemon_.subscribe({"floor/sway"});
  ASSERT_TRUE(subscriber.receive(kPatience).value()) << "it hears nothing";
  const std::string id = examine();
  const Heard told = heard_sway(subscriber);
  ASSERT_EQ(told.finals.size(), 2U);
  for (const std::uint32_t trial : {1U, 2U}) {
    ASSERT_TRUE(told.lasts.contains(trial)) << "how many arrive depends on the machine; unit_pipeline tests that two a second are made";
    EXPECT_NEAR(static_cast<double>(told.lasts.at(trial).end_scan()), static_cast<double>(told.finals.at(trial).end_scan()), 2.0)
        << "running values go on to the end of the trial";
    EXPECT_TRUE(told.finals.at(trial).is_valid());
    EXPECT_NEAR(told.finals.at(trial).duration_s(), 4.0, 0.021);
    EXPECT_EQ(told.finals.at(trial).session_id(), id);
    EXPECT_FALSE(told.finals.at(trial).software().empty());
    const Values values = values_of(told.finals.at(trial));
    EXPECT_GT(values.at("MVELO"), 0.0);
    EXPECT_FALSE(values.contains("PF50_AP_MT8")) << "4 s are too short for a spectrum";
  }

  const Finished shown = daemon_.ctl({"session", "show", id, "--json"});
  ASSERT_EQ(shown.status, 0) << shown.err;
  const json session = json::parse(shown.out);
  ASSERT_EQ(session.at("trials").size(), 2U);
  for (const json& trial : session.at("trials")) {
    EXPECT_EQ(values_of(trial.at("sway").at("measures")), values_of(told.finals.at(trial.at("trial").get<std::uint32_t>())));
  }
  const auto has_figure = [&](const std::string& name) {
    return std::ranges::any_of(session.at("results"), [&](const json& figure) { return figure.at("name").get<std::string>() == name; });
  };
  EXPECT_TRUE(has_figure("eyes-closed/MVELO")) << session.at("results");
  EXPECT_TRUE(has_figure("romberg/feet=two/MVELO"));

  const std::string pages = (daemon_.directory() / "pages").string();
  const Finished reported = daemon_.ctl({"report", id, "--out", pages});
  EXPECT_EQ(reported.status, 0) << reported.err;
  EXPECT_GE(std::distance(std::filesystem::directory_iterator(pages), {}), 6) << "a session and two trials, each as HTML and SVG";

  if (!std::filesystem::exists(DTSLAB_PROGRAM)) GTEST_SKIP() << "built without dtslab: what it computes from the recording is not compared";
  const std::string file = session.at("parts").at(0).at("file");
  const Finished offline = run_program({DTSLAB_PROGRAM, "sway", file, "--json"});
  ASSERT_EQ(offline.status, 0) << offline.err;
  const json trials = json::parse(offline.out).at("trials");
  ASSERT_EQ(trials.size(), 2U);
  for (const json& trial : trials) {
    EXPECT_EQ(values_of(trial.at("measures")), values_of(told.finals.at(trial.at("trial").get<std::uint32_t>())));
  }
}

}  // namespace
}  // namespace dts::test
