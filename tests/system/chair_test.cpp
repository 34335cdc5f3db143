// SPDX-License-Identifier: Apache-2.0
// An examination on the simulated chair through the real programs: what is told live, what stands in the recording, what a replay gives
// again and what the laboratory makes of it are the same.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "daemon_process.h"
#include "record/recording.h"

namespace dts::test {
namespace {

using nlohmann::json;

/// Four reaches as far as possible, one to half of the arm's length beyond it, one within reach: short, at a brisk pace.
constexpr const char* kExamination = R"(name = "examination"
sentence = "Six brisk reaches"
[[field]]
name = "weight_kg"
label = "Body weight"
minimum = 10
maximum = 250
[[field]]
name = "height_cm"
label = "Body height"
minimum = 60
maximum = 230
[[field]]
name = "arm_length_cm"
label = "Arm length"
minimum = 20
maximum = 120
required = true
[[field]]
name = "max_reach_cm"
label = "Maximum reach"
minimum = 10
maximum = 250
required = true
[trials]
trials_per_block = 6
starts_by_itself = true
cue_delay_min_s = 1.0
duration_s = 3.6
rest_s = 0.4
[[trials.condition]]
name = "max-1"
maximum_reach = true
[[trials.condition]]
name = "max-2"
maximum_reach = true
[[trials.condition]]
name = "max-3"
maximum_reach = true
[[trials.condition]]
name = "150"
target_percent = 150
[[trials.condition]]
name = "80"
target_percent = 80
[[trials.condition]]
name = "max-4"
maximum_reach = true
)";

/// The same person sits on the chair and is asked for by the protocol.
constexpr const char* kChair =
    "sim:chair?seed=11&reaches=cued&sit_down_s=1.5&pace_s=0.7&weight_kg=68&height_cm=175&arm_length_cm=67&max_reach_cm=124";

class ChairExamination : public testing::Test {
 protected:
  ChairExamination() {
    const std::filesystem::path folder = daemon_.directory() / "protocols";
    std::filesystem::create_directory(folder);
    std::ofstream(folder / "examination.toml") << kExamination;
    daemon_.signal(SIGTERM);  // it has to see the protocol
    EXPECT_EQ(daemon_.wait(), 0);
    daemon_.restart();
  }

  /// Runs all trials and returns the session's id.
  std::string examine() {
    const Finished started =
        daemon_.ctl({"session", "start", "--rig", "chair", "--protocol", "examination", "--json", "--field", "weight_kg=68", "--field",
                     "height_cm=175", "--field", "arm_length_cm=67", "--field", "max_reach_cm=124"});
    EXPECT_EQ(started.status, 0) << started.err;
    EXPECT_TRUE(eventually([&] { return daemon_.ctl({"session", "trial", "next", "--rig", "chair"}).status == 0; }));
    for (int patience = 0; patience < 3 && !is_finished(); ++patience) static_cast<void>(eventually([&] { return is_finished(); }));
    EXPECT_TRUE(is_finished());
    EXPECT_EQ(daemon_.ctl({"session", "stop", "--rig", "chair"}).status, 0);
    return json::parse(started.out).at("session_id");
  }
  [[nodiscard]] bool is_finished() const {
    const auto status = daemon_.control().status();
    for (const auto& rig : status->rigs()) {
      if (rig.rig().name() == "chair") return rig.session().trial().phase() == v1::TRIAL_PHASE_FINISHED;
    }
    return false;
  }
  [[nodiscard]] json shown(const std::string& id) const {
    const Finished shown = daemon_.ctl({"session", "show", id, "--json"});
    EXPECT_EQ(shown.status, 0) << shown.err;
    return json::parse(shown.out);
  }

  DaemonProcess daemon_{{.further_rigs = {{.name = "chair", .device = kChair, .acquire = "rate_hz = 500.0\n", .file = "chair-sim.toml"}}}};
};

std::string content_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The report has the classes that the daemon recorded, and its PDF is the same a second time.
void check_report(const DaemonProcess& daemon, const std::string& id, const json& session) {
  const std::filesystem::path folder = daemon.directory() / "report";
  const Finished pages = daemon.ctl({"report", id, "--format", "html", "--out", folder, "--json"});
  ASSERT_EQ(pages.status, 0) << pages.err;
  EXPECT_EQ(json::parse(pages.out).at("pages").size(), 1U + session.at("trials").size());
  EXPECT_THAT(content_of(folder / "session.html"), testing::HasSubstr("Live and recomputed values match in 6 trials."));
  for (const json& trial : session.at("trials")) {
    const std::string page = content_of(folder / ("trial-0" + trial.at("trial").dump() + ".html"));
    EXPECT_THAT(page, testing::HasSubstr("Live and recomputed values match."));
    EXPECT_EQ(page.find(">P3<") != std::string::npos, trial.at("result").contains("reach"));
  }
  std::vector<std::string> documents;
  for (int k = 0; k < 2; ++k) {  // the second time, the program recognises its own document and replaces it
    const Finished pdf = daemon.ctl({"report", id, "--format", "pdf", "--out", folder});
    if (pdf.err.find("rsvg-convert is not installed") != std::string::npos) return;  // unit_report tests what is printed then
    ASSERT_EQ(pdf.status, 0) << pdf.err;
    documents.push_back(content_of(folder / "report.pdf"));
  }
  EXPECT_TRUE(documents[0].starts_with("%PDF-"));
  EXPECT_EQ(documents[0], documents[1]);
}

/// "reach 3 at 1234", "class 2 of 3 at 1234": finals and classes in their order.
std::string told(const v1::Event& event) {
  const std::string at = " at " + std::to_string(event.segment()) + ":" + std::to_string(event.scan());
  if (event.has_reach() && event.reach().step() == v1::REACH_STEP_FINAL) return "reach " + std::to_string(event.reach().number()) + at;
  if (!event.has_movement()) return {};
  return "class " + std::to_string(event.movement().trunk_class()) + " of " + std::to_string(event.movement().number()) + at;
}

/// Appends what has come until now.
void append_events(client::Subscriber& subscriber, std::vector<std::string>& events) {
  while (true) {
    const auto message = subscriber.receive(std::chrono::milliseconds(200));
    if (!message || !*message) return;
    const auto* event = std::get_if<client::Event>(&**message);
    if (event != nullptr && !told(*event->body).empty()) events.push_back(told(*event->body));
  }
}

/// The same of a recording.
std::vector<std::string> recorded(const std::string& file) {
  std::vector<std::string> events;
  const auto recording = record::Recording::open(file).value();
  while (true) {
    const auto item = recording->next().value();
    if (!item) return events;
    const auto* timed = std::get_if<record::TimedEvent>(&*item);
    if (timed == nullptr) continue;
    if (!told(timed->event).empty()) events.push_back(told(timed->event));
  }
}

TEST_F(ChairExamination, LiveRecordedReplayedAndInTheLaboratory_AreTheSame) {
  RecordProperty("requirement", "REACH-5");
  ASSERT_TRUE(daemon_.is_ready()) << daemon_.log();
  // The daemon handles subscriptions in their order, and sends the state of the device to every newcomer.
  client::Subscriber subscriber = daemon_.subscribe({"chair/reach", "chair/class", "chair/device"});
  ASSERT_TRUE(subscriber.receive(kPatience).value()) << "it receives nothing";
  const std::string id = examine();
  const json session = shown(id);
  EXPECT_EQ(session.at("fields").at("weight_kg"), "68");
  const std::string file = session.at("parts").at(0).at("file");

  // Every trial has its reach; the four farthest bend the trunk most, the nearest does not.
  ASSERT_EQ(session.at("trials").size(), 6U);
  for (const json& trial : session.at("trials")) {
    SCOPED_TRACE(trial.dump());
    ASSERT_TRUE(trial.contains("result"));
    const bool is_near = trial.at("condition") == "80";
    ASSERT_TRUE(is_near || trial.at("result").contains("movement"));
    if (!trial.at("result").contains("movement")) continue;
    const int trunk_class = trial.at("result").at("movement").at("trunk_class");
    const int takes = trial.at("result").at("expected_class");
    EXPECT_THAT(trunk_class, testing::AnyOf(takes, is_near ? 1 : -1));
  }
  EXPECT_FALSE(session.at("results").empty());
  check_report(daemon_, id, session);

  const auto in_file = recorded(file);
  EXPECT_GE(in_file.size(), 10U);
  // In the same order, each class right after its reach; the subscriber came before the session began.
  std::vector<std::string> live;
  EXPECT_TRUE(eventually([&] {
    append_events(subscriber, live);
    return !std::ranges::search(live, in_file).empty();
  })) << testing::PrintToString(live)
      << testing::PrintToString(in_file);

  if (!std::filesystem::exists(DTSLAB_PROGRAM)) GTEST_SKIP() << "built without dtslab: what it computes from the recording is not compared";
  const Finished replayed = run_program({DTSLAB_PROGRAM, "replay", file, "--json"});
  ASSERT_EQ(replayed.status, 0) << replayed.out << replayed.err;
  EXPECT_THAT(replayed.out, testing::HasSubstr("reaches and classes"));

  const Finished offline = run_program({DTSLAB_PROGRAM, "reach", "results", file, "--json"});
  ASSERT_EQ(offline.status, 0) << offline.err;
  const json results = json::parse(offline.out);
  EXPECT_EQ(results.at("differing_results"), 0);
  EXPECT_EQ(results.at("recorded_results"), 12) << "when each trial was decided, and when the session ended";
  ASSERT_EQ(results.at("trials").size(), 6U);
  for (std::size_t k = 0; k < 6; ++k) {
    const json& live_result = session.at("trials").at(k).at("result");
    const json& own = results.at("trials").at(k);
    ASSERT_EQ(live_result.contains("movement"), own.contains("movement"));
    if (!own.contains("movement")) continue;
    EXPECT_EQ(live_result.at("movement").at("trunk_class"), own.at("movement").at("class"));
    EXPECT_EQ(live_result.at("movement").at("trunk_deg"), own.at("movement").at("trunk_deg"));
  }
  for (const json& figure : session.at("results")) {
    EXPECT_THAT(results.at("summary"),
                testing::Contains(testing::AllOf(testing::ResultOf([](const json& own) { return own.at("name"); }, figure.at("name")),
                                                 testing::ResultOf([](const json& own) { return own.at("value"); }, figure.at("value")))));
  }
}

}  // namespace
}  // namespace dts::test
