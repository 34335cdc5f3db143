// SPDX-License-Identifier: Apache-2.0
// Sessions over several rigs.
#include <algorithm>
#include <fstream>
#include <iterator>

#include "record/catalogue/trial_collector.h"
#include "record/export/export.h"
#include "record/recording.h"
#include "supervisor_fixture.h"

namespace dts::session {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// A floor and a plate, each on a device that the test feeds. The floor leads.
class CompanionsTest : public SupervisorTest {
 protected:
  void open_both(std::vector<Protocol> protocols = {Protocol{}}) {
    open(std::move(protocols));
    pipeline::RigConfig config = config_;
    config.name = "plate";
    auto device = std::make_unique<HandFedDevice>(config.sensor_channels.size());
    plate_device_ = device.get();
    plate_device_->is_absent = is_plate_absent_;
    ASSERT_TRUE(supervisor_->add(Rig::create(config, std::move(device), clock_, bell_).value()));
  }
  void start_both(std::vector<Protocol> protocols = {Protocol{}}) {
    open_both(std::move(protocols));
    run();
    feed_both(kBlock);
  }
  /// Whole blocks for every rig that streams.
  void feed_both(std::size_t scans) {
    for (std::size_t fed = 0; fed < scans; fed += kBlock) {
      const HandFedDevice::Given given{.scans = kBlock, .host_ns = clock_.now_ns()};
      std::vector<std::pair<Rig*, std::uint64_t>> fed_rigs;
      for (Rig* one : supervisor_->rigs()) {
        HandFedDevice* const device = one->config().name == "plate" ? plate_device_ : device_;
        if (device->is_absent) continue;
        fed_rigs.emplace_back(one, one->acquisition().scans_total);
        device->give(given);
      }
      clock_.advance_s(0.01);
      for (const auto& [one, before] : fed_rigs) {
        while (!has_processed(*one, before)) std::this_thread::yield();
      }
    }
  }
  [[nodiscard]] static bool has_processed(Rig& rig, std::uint64_t before) {
    const AcquisitionReport& acquired = rig.acquisition();
    const PipelineReport& done = rig.pipeline_report();
    return acquired.scans_total > before && done.end.segment == acquired.segment && done.next_scan.value == acquired.next_scan &&
           rig.tap().waiting() <= rig.tap().capacity() / 2;
  }
  void pass_both(double s) {
    for (double passed = 0.0; passed < s - 1e-9; passed += 0.05) {
      feed_both(75);
      supervisor_->tick();
    }
  }
  [[nodiscard]] bool eventually_both(const std::function<bool()>& condition) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (std::chrono::steady_clock::now() < deadline) {
      supervisor_->tick();
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      feed_both(kBlock);
    }
    return false;
  }
  [[nodiscard]] RigState of(const std::string& rig) {
    const auto states = supervisor_->states();
    return *std::ranges::find_if(states, [&](const RigState& state) { return state.rig.config().name == rig; });
  }
  [[nodiscard]] bool are_in(SessionState wanted) {
    return eventually_both([&] { return of("floor").session.state == wanted && of("plate").session.state == wanted; });
  }
  [[nodiscard]] std::string begin_both(const SessionRequest& request = {}) {
    const auto started = supervisor_->start_session("floor", request, {"plate"});
    EXPECT_TRUE(started) << started.error().what;
    EXPECT_TRUE(are_in(SessionState::Running));
    return started ? started->id : "";
  }
  [[nodiscard]] bool stop_both() { return supervisor_->stop_session("").has_value() && are_in(SessionState::Idle); }
  void lose(HandFedDevice& device, Rig& lost) {
    device.is_absent = true;
    device.give({.outcome = device::ReadOutcome::Gone});
    while (lost.acquisition().device == device::DeviceState::Streaming) std::this_thread::yield();
  }
  [[nodiscard]] Rig& plate() { return *supervisor_->rigs().at(1); }
  [[nodiscard]] std::vector<std::string> files() {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "sessions")) names.push_back(entry.path().filename());
    return names;
  }
  /// Returns "1 floor 1 complete": number, rig, leading part, state.
  [[nodiscard]] std::vector<std::string> parts(const std::string& id) {
    std::vector<std::string> texts;
    for (const record::PartRow& part : row(id).parts) {
      texts.push_back(std::to_string(part.part) + " " + part.rig + " " + std::to_string(part.leading_part) + " " +
                      std::string(record::name(part.state)));
    }
    return texts;
  }
  [[nodiscard]] record::TrialCollector collected(const std::string& file) {
    const auto recording = record::Recording::open(file).value();
    record::TrialCollector events(recording->find_stream("raw"));
    while (const auto item = recording->next().value()) events.add(*item);
    return events;
  }

  HandFedDevice* plate_device_ = nullptr;
  bool is_plate_absent_ = false;
};

TEST_F(CompanionsTest, Session_BeginsAndEndsOnAllItsRigsTogether) {
  RecordProperty("requirement", "SES-6");
  start_both();
  const std::string id = begin_both({.subject = "P017"});
  EXPECT_EQ(of("plate").session.id, id);
  EXPECT_THAT(of("plate").session.rigs, ElementsAre("floor", "plate"));
  EXPECT_THAT(why_refused(supervisor_->tare("plate")), HasSubstr("rig 'plate' has a session"));
  EXPECT_THAT(why_refused(supervisor_->start_session("plate", {})), HasSubstr("rig 'plate' already has session " + id));
  feed_both(300);

  const auto stopped = supervisor_->stop_session("plate");  // any of its rigs

  ASSERT_TRUE(stopped);
  EXPECT_EQ(stopped->first, "floor");
  ASSERT_TRUE(are_in(SessionState::Idle));
  const record::SessionRow session = row(id);
  EXPECT_EQ(session.rig + " " + session.state + " " + session.message, "floor complete ");
  EXPECT_THAT(parts(id), ElementsAre("1 floor 1 complete", "2 plate 1 complete"));
  EXPECT_EQ(session.parts[0].started_utc_ns, session.parts[1].started_utc_ns);
  EXPECT_EQ(session.parts[0].scans, session.parts[1].scans);
  const auto facts = record::read_session_facts(session.parts[1].file).value();
  EXPECT_THAT(facts.rigs, ElementsAre("floor", "plate"));
  EXPECT_EQ(facts.rig + " " + facts.subject + " " + std::to_string(facts.part) + " " + std::to_string(facts.leading_part),
            "plate P017 2 1");
  EXPECT_EQ(recordings_->catalogue().sessions({.rig = "plate"})->size(), 1U);
}

TEST_F(CompanionsTest, Trials_AreInBothRecordingsAndOnceInTheCatalogue) {
  start_both({standing()});
  const std::string id = begin_both({.protocol = "standing"});
  feed_both(kBlock);
  ASSERT_TRUE(supervisor_->trial("plate", TrialAction::Next));  // any of its rigs
  pass_both(13.0);
  EXPECT_EQ(of("plate").trial->trial, 1U);
  ASSERT_TRUE(stop_both());

  const record::SessionRow session = row(id);
  ASSERT_EQ(session.trials.size(), 1U);
  EXPECT_EQ(session.trials[0].part, 1U);
  EXPECT_THAT(session.trials[0].result, HasSubstr("\"sway\":{"));
  EXPECT_EQ(session.parts[1].valid_trials, 0U);
  const auto trials = collected(session.parts[1].file).rows();
  ASSERT_EQ(trials.size(), 1U);
  EXPECT_EQ(trials[0].outcome, "done");
  EXPECT_EQ(trials[0].last_scan - trials[0].first_scan, 16'500U);
  EXPECT_THAT(trials[0].result, IsEmpty());
}

TEST_F(CompanionsTest, RigThatCannotStart_LeavesNothingBehind) {
  is_plate_absent_ = true;
  open_both();
  run();
  feed_both(kBlock);
  while (plate().acquisition().text().empty()) std::this_thread::yield();

  EXPECT_THAT(why_refused(supervisor_->start_session("floor", {}, {"plate"})), HasSubstr("rig 'plate' delivers nothing: "));
  EXPECT_THAT(why_refused(supervisor_->start_session("floor", {}, {"floor"}), core::ErrorCode::InvalidArgument),
              HasSubstr("rig 'floor' is given twice"));
  EXPECT_THAT(why_refused(supervisor_->start_session("floor", {}, {"plat"}), core::ErrorCode::NotFound), HasSubstr("no rig named 'plat'"));

  EXPECT_THAT(files(), IsEmpty());
  EXPECT_THAT(recordings_->catalogue().sessions({}).value(), IsEmpty());
  EXPECT_EQ(of("floor").session.state, SessionState::Idle);
}

TEST_F(CompanionsTest, FileThatCannotBeCreated_LeavesNothingBehind) {
  start_both();
  record::SessionFacts floor{.session_id = "s1", .rig = "floor", .rigs = {"floor", "plate"}, .protocol = "free"};
  record::SessionFacts second = floor;
  second.rig = "plate";  // of the same part: its file exists already

  EXPECT_FALSE(recordings_->begin({{.rig = rig(), .facts = floor}, {.rig = plate(), .facts = second}}));

  EXPECT_THAT(files(), IsEmpty());
  EXPECT_THAT(recordings_->catalogue().sessions({}).value(), IsEmpty());
  EXPECT_FALSE(recordings_->view("floor").is_recording);
}

TEST_F(CompanionsTest, CompanionWhoseDeviceIsLost_IsReported_AndTheSessionContinues) {
  start_both({standing()});
  const std::string id = begin_both({.protocol = "standing"});
  feed_both(kBlock);

  lose(*plate_device_, plate());
  pass_both(0.1);
  EXPECT_THAT(of("floor").session.message, HasSubstr("rig 'plate' delivers nothing: "));
  EXPECT_THAT(taken_events(v1::Event::kSession).back().session().message(), HasSubstr("rig 'plate' delivers nothing: "));
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));
  pass_both(13.0);
  ASSERT_TRUE(stop_both());

  EXPECT_EQ(row(id).trials.at(0).outcome, "done");
  EXPECT_EQ(row(id).state, "incomplete");
  EXPECT_THAT(row(id).message, HasSubstr("rig 'plate': the device delivered nothing when the session ended"));
  EXPECT_THAT(parts(id), ElementsAre("1 floor 1 complete", "2 plate 1 incomplete"));
}

TEST_F(CompanionsTest, DeviceThatReturns_IsNotReportedAnyMore) {
  start_both();
  const std::string id = begin_both();
  lose(*plate_device_, plate());
  pass_both(0.1);
  ASSERT_FALSE(of("floor").session.message.empty());

  plate_device_->is_absent = false;
  while (plate().acquisition().device != device::DeviceState::Streaming) {
    std::this_thread::yield();
    clock_.advance_s(0.001);
  }
  ASSERT_TRUE(eventually_both([&] { return of("floor").session.message.empty(); }));
  feed_both(10 * kBlock);
  ASSERT_TRUE(stop_both());

  EXPECT_THAT(parts(id), ElementsAre("1 floor 1 complete", "2 plate 1 complete"));
  EXPECT_GT(row(id).parts[1].losses->total().gaps, 0U);
  EXPECT_EQ(row(id).message, "rig plate delivered nothing for a time; the gaps show when");
}

TEST_F(CompanionsTest, TrialsContinue_WhileTheDeviceOfTheLeadingRigIsLost) {
  start_both({standing()});
  const std::string id = begin_both({.protocol = "standing"});
  feed_both(kBlock);
  lose(*device_, rig());
  pass_both(0.1);
  EXPECT_THAT(of("floor").session.message, HasSubstr("rig 'floor' delivers nothing: "));

  ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));
  pass_both(13.0);
  ASSERT_TRUE(stop_both());

  const auto trials = collected(row(id).parts[1].file).rows();
  ASSERT_EQ(trials.size(), 1U);
  EXPECT_EQ(trials[0].outcome, "done");
  EXPECT_EQ(trials[0].last_scan - trials[0].first_scan, 16'500U);
  EXPECT_EQ(row(id).parts[1].state, record::PartState::Complete);
  EXPECT_EQ(row(id).parts[0].valid_trials, 0U) << "the leading rig has no values of it";
}

TEST_F(CompanionsTest, CompanionWhoseRecordingBreaks_LeavesTheSession) {
  start_both();
  const std::string id = begin_both();
  std::filesystem::rename(folder_ / "sessions" / (id + ".2.xdf.part"), folder_ / "elsewhere");

  ASSERT_TRUE(eventually_both([&] { return of("plate").session.state == SessionState::Failed; }));
  EXPECT_EQ(of("floor").session.state, SessionState::Running);
  pass_both(0.1);
  EXPECT_THAT(of("floor").session.message, AllOf(HasSubstr("rig 'plate': "), HasSubstr("was deleted or moved")));
  ASSERT_TRUE(supervisor_->stop_session(""));
  ASSERT_TRUE(eventually_both([&] { return of("floor").session.state == SessionState::Idle; }));

  EXPECT_EQ(row(id).state, "incomplete");
  EXPECT_THAT(row(id).message, HasSubstr("rig 'plate': "));
  EXPECT_EQ(row(id).parts[0].state, record::PartState::Complete);
}

TEST_F(CompanionsTest, RecordingOfTheLeadingRigThatBreaks_EndsTheSession) {
  start_both();
  const std::string id = begin_both();
  std::filesystem::rename(folder_ / "sessions" / (id + ".xdf.part"), folder_ / "elsewhere");

  ASSERT_TRUE(eventually_both([&] { return of("floor").session.state == SessionState::Failed; }));

  EXPECT_EQ(of("plate").session.state, SessionState::Idle);
  EXPECT_EQ(row(id).state, "incomplete");
  EXPECT_THAT(row(id).message, HasSubstr("rig 'floor': "));
  EXPECT_EQ(row(id).parts[1].state, record::PartState::Complete);
}

TEST_F(CompanionsTest, Markers_AreInAllRecordings_AndOnceInTheCatalogue) {
  start_both();
  const std::string id = begin_both();
  const auto marks = supervisor_->mark("plate", "coughs");
  ASSERT_TRUE(marks);
  EXPECT_EQ(marks->size(), 2U);
  ASSERT_TRUE(supervisor_->mark("", "laughs"));
  ASSERT_TRUE(stop_both());

  EXPECT_EQ(recordings_->catalogue().session(id)->markers.size(), 2U);
  for (const record::PartRow& part : row(id).parts) {
    const auto markers = collected(part.file).markers();
    ASSERT_EQ(markers.size(), 2U) << part.rig;
    EXPECT_EQ(markers[0].text + " " + markers[1].text, "coughs laughs") << part.rig;
  }
}

TEST_F(CompanionsTest, MarkerFromBeforeTheSession_IsPublishedForBothRigs_AndInNoRecording) {
  start_both();
  const std::int64_t before_ns = clock_.now_ns() - 1;
  const std::string id = begin_both();
  static_cast<void>(supervisor_->take_notices());

  const auto early = supervisor_->mark("floor", "too early", before_ns).value();
  const auto late = supervisor_->mark("floor", "in time", before_ns + 1).value();

  std::size_t published = 0;
  for (const Notice& notice : supervisor_->take_notices()) published += notice.event.marker().text() == "too early" ? 1 : 0;
  EXPECT_EQ(published, 2U);
  ASSERT_TRUE(stop_both());
  EXPECT_THAT(early, testing::ElementsAre(testing::Field(&PlacedMark::is_before_session, true),
                                          testing::Field(&PlacedMark::is_before_session, true)));
  EXPECT_THAT(late, testing::ElementsAre(testing::Field(&PlacedMark::is_before_session, false),
                                         testing::Field(&PlacedMark::is_before_session, false)));
  EXPECT_EQ(recordings_->catalogue().session(id)->markers.size(), 1U);
  for (const record::PartRow& part : row(id).parts) {
    const auto markers = collected(part.file).markers();
    ASSERT_EQ(markers.size(), 1U) << part.rig;
    EXPECT_EQ(markers[0].text, "in time") << part.rig;
  }
}

TEST_F(CompanionsTest, RemovedTextOfAMarker_IsInNoExport) {
  start_both();
  const std::string id = begin_both();
  ASSERT_TRUE(supervisor_->mark("", "coughs"));
  ASSERT_TRUE(stop_both());

  ASSERT_TRUE(supervisor_->correct_session({.session_id = id, .marker = 1, .marker_text = "", .reason = "a name"}, "local"));

  for (const record::PartRow& part : row(id).parts) {
    auto recording = record::Recording::open(part.file).value();
    const auto corrections = record::corrections_beside(part.file, *recording->session()).value();
    const std::string folder = (folder_ / part.rig).string();
    ASSERT_TRUE(record::export_csv(*recording, folder, {}, corrections));
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      std::ifstream file(entry.path());
      EXPECT_THAT(std::string(std::istreambuf_iterator<char>(file), {}), Not(HasSubstr("coughs"))) << entry.path();
    }
  }
}

TEST_F(CompanionsTest, Abort_IsInTheCatalogueAndInAllRecordings) {
  start_both();
  const std::string id = begin_both();
  feed_both(kBlock);
  ASSERT_TRUE(supervisor_->stop_session("", true, "felt dizzy"));
  ASSERT_TRUE(are_in(SessionState::Idle));

  EXPECT_EQ(row(id).state + ": " + row(id).message, "aborted: felt dizzy");
  for (const record::PartRow& part : row(id).parts) {
    EXPECT_EQ(record::read_recording(part.file)->session_state, "aborted") << part.rig;
  }
}

TEST_F(CompanionsTest, SessionThatACrashInterrupted_IsResumedAsOne) {
  storage_.resume_within_min = 10.0;
  start_both({standing()});
  const std::string id = begin_both({.protocol = "standing"});
  feed_both(kBlock);
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));
  pass_both(13.0);
  ASSERT_TRUE(eventually_both([&] { return row(id).trials.size() == 1; }));
  ASSERT_TRUE(eventually_both([&] { return recordings_->view("floor").lag_s < 1.0 && recordings_->view("plate").lag_s < 1.0; }));
  leave();

  start_both({standing()});
  supervisor_->resume_interrupted();
  ASSERT_TRUE(are_in(SessionState::Running));
  EXPECT_EQ(of("floor").session.id + " " + of("plate").session.id, id + " " + id);
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));
  EXPECT_EQ(of("floor").trial->trial, 2U);
  pass_both(13.0);
  ASSERT_TRUE(eventually_both([&] { return row(id).parts.at(1).state == record::PartState::Recovered; }));
  ASSERT_TRUE(stop_both());

  EXPECT_THAT(parts(id), ElementsAre("1 floor 1 recovered", "2 plate 1 recovered", "3 floor 3 complete", "4 plate 3 complete"));
  EXPECT_EQ(record::state_of(row(id)), "recovered");
  EXPECT_EQ(row(id).trials.size(), 2U);
}

TEST_F(CompanionsTest, SessionWhoseSecondRecordingWasNeverCreated_IsResumedOnBothRigs) {
  start_both();
  const std::string id = begin_both();
  feed_both(kBlock);
  leave();
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    if (entry.path().filename().string().starts_with("catalogue")) std::filesystem::remove(entry.path());
  }
  for (const char* ending : {".2.xdf.part", ".2.xdf.idx"}) std::filesystem::remove(folder_ / "sessions" / (id + ending));

  start_both();
  ASSERT_TRUE(supervisor_->resume_session(id));
  ASSERT_TRUE(are_in(SessionState::Running));
  feed_both(kBlock);
  ASSERT_TRUE(stop_both());

  EXPECT_EQ(parts(id).size(), 3U);
  EXPECT_EQ(parts(id)[1] + ", " + parts(id)[2], "2 floor 2 complete, 3 plate 2 complete");
}

TEST_F(CompanionsTest, SessionIsNotResumed_WhileOneOfItsRigsIsMissing) {
  start_both();
  const std::string id = begin_both();
  feed_both(kBlock);
  leave();

  is_plate_absent_ = true;
  open_both();
  run();
  feed_both(kBlock);
  while (plate().acquisition().text().empty()) std::this_thread::yield();

  EXPECT_THAT(why_refused(supervisor_->resume_session(id)), HasSubstr("rig 'plate' delivers nothing: "));
  EXPECT_EQ(row(id).parts.size(), 2U);
}

TEST_F(CompanionsTest, CatalogueRebuiltFromTheRecordings_IsTheSame) {
  start_both({standing()});
  const std::string id = begin_both({.protocol = "standing"});
  feed_both(kBlock);
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));
  pass_both(13.0);
  ASSERT_TRUE(supervisor_->mark("", "coughs"));
  ASSERT_TRUE(stop_both());
  record::SessionRow before = recordings_->catalogue().session(id).value();
  const auto results = recordings_->catalogue().results(id).value();
  end();
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    if (entry.path().filename().string().starts_with("catalogue")) std::filesystem::remove(entry.path());
  }

  open_both({standing()});

  record::SessionRow after = recordings_->catalogue().session(id).value();
  before.ended_utc_ns = after.ended_utc_ns = 0;  // the end of the data, and the moment when the files were closed
  EXPECT_EQ(after, before);
  EXPECT_EQ(recordings_->catalogue().results(id).value(), results);
}

}  // namespace
}  // namespace dts::session
