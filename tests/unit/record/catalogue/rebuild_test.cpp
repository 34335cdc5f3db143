// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <fstream>

#include "record/recording.h"
#include "record/xdf/recovery.h"
#include "record/xdf/xdf_writer.h"
#include "unit/record/catalogue/catalogue_fixture.h"

namespace dts::record {
namespace {

using catalogue_test::code;
using catalogue_test::facts;
using catalogue_test::what;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::int64_t kStartUtcNs = 1'700'000'000'000'000'000;

/// How a recording of the tests ends.
enum class End { Closed, Incomplete, Abandoned };

class CatalogueRebuild : public catalogue_test::CatalogueFixture {
 protected:
  CatalogueRebuild() { std::filesystem::create_directory(path("sessions")); }
  [[nodiscard]] std::string file(const std::string& name) const { return path("sessions/" + name); }

  /// 200 scans at 100 Hz of synthetic data; one trial done, one under way at the end.
  void record(const std::string& name, const SessionFacts& session, End end = End::Closed) const {
    auto writer = XdfWriter::create(file(name), to_facts(session));
    ASSERT_TRUE(writer) << what(writer);
    XdfWriter& xdf = **writer;
    const auto rate = core::Rate::create(100, 1).value();
    const auto raw = xdf.add_stream({.name = "floor/raw", .content = "DTS", .rate = rate, .channels = {{.label = "w1_v", .unit = "V"}}});
    const auto events =
        xdf.add_stream({.name = "floor/events", .content = "Markers", .value_type = ValueType::Text, .channels = {{.label = "event"}}});
    const auto tell = [&](const char* phase, std::int64_t trial, std::uint64_t scan) {
      RecordedEvent told{.event = "trial", .scan = {scan}};
      told.values = {
          {"phase", phase}, {"trial", trial}, {"attempt", std::int64_t{1}}, {"block", std::int64_t{1}}, {"condition", std::string("a")}};
      const std::vector<std::pair<double, std::string>> texts{{1000.0 + static_cast<double>(scan) / 100.0, to_json(told)}};
      ASSERT_TRUE(xdf.write_texts(events, texts, {.first_scan = {scan}}));
    };
    const std::vector<std::pair<double, std::string>> start{{1000.0, to_json({.event = "segment"})}};
    ASSERT_TRUE(xdf.write_texts(events, start, {}));
    ASSERT_TRUE(xdf.write_samples(raw, 1000.0, std::vector<double>(200, 1.5), {}));
    tell("measure", 1, 20);
    tell("done", 1, 80);
    tell("measure", 2, 120);
    const bool is_closed = end == End::Closed ? xdf.close().has_value() : end == End::Incomplete && xdf.close_incomplete("disk full");
    ASSERT_EQ(is_closed, end != End::Abandoned);
    if (end == End::Abandoned) xdf.abandon();
  }
  /// 200 scans at 100 Hz, an outage of 4 s, and 100 more.
  void record_with_outage(const std::string& name) const {
    auto writer = XdfWriter::create(file(name), to_facts(facts())).value();
    const auto rate = core::Rate::create(100, 1).value();
    const auto raw =
        writer->add_stream({.name = "floor/raw", .content = "DTS", .rate = rate, .channels = {{.label = "w1_v", .unit = "V"}}});
    const auto events =
        writer->add_stream({.name = "floor/events", .content = "Markers", .value_type = ValueType::Text, .channels = {{.label = "event"}}});
    const auto write = [&](double at_s, const RecordedEvent& begin, std::size_t scans) {
      const XdfWriter::Position position{.segment = begin.segment, .first_scan = {0}};
      const std::vector<std::pair<double, std::string>> texts{{at_s, to_json(begin)}};
      ASSERT_TRUE(writer->write_texts(events, texts, position));
      ASSERT_TRUE(writer->write_samples(raw, at_s, std::vector<double>(scans, 1.5), position));
    };
    write(1000.0, {.event = "segment"}, 200);
    write(1006.0, {.event = "segment", .segment = 1, .values = {{"reason", std::string("overrun")}, {"missing_scans", std::int64_t{400}}}},
          100);
    ASSERT_TRUE(writer->close());
  }
  Rebuilt rebuilt() {
    auto done = rebuild(catalogue(), path("sessions"));
    EXPECT_TRUE(done) << what(done);
    return done.value_or(Rebuilt{});
  }
  SessionRow session(const std::string& id = "s1") {
    auto found = catalogue().session(id);
    EXPECT_TRUE(found) << what(found);
    return found.value_or(SessionRow{});
  }
  PartRow only_part(const std::string& id = "s1") {
    const auto parts = session(id).parts;
    EXPECT_EQ(parts.size(), 1U);
    return parts.empty() ? PartRow{} : parts[0];
  }
};

TEST_F(CatalogueRebuild, NoRecordings_DoesNothing) {
  EXPECT_EQ(rebuilt().added, 0U);
  EXPECT_TRUE(catalogue().parts()->empty());
}

TEST_F(CatalogueRebuild, NoFolder_IsNotFoundAndMarksNothing) {
  ASSERT_TRUE(catalogue().begin_part(facts(), "/gone.xdf"));
  EXPECT_EQ(code(rebuild(catalogue(), path("none"))), core::ErrorCode::NotFound);
  EXPECT_EQ(only_part().state, PartState::Recording);
}

TEST_F(CatalogueRebuild, ClosedRecording_IsEnteredWithAllItSays) {
  record("whatever.xdf", facts("s1", 1, kStartUtcNs));
  const auto done = rebuilt();
  EXPECT_EQ(done.added, 1U);
  EXPECT_THAT(done.unreadable, ElementsAre());
  const SessionRow row = session();
  EXPECT_EQ(row.rig, "floor");
  EXPECT_EQ(row.protocol, "free");
  EXPECT_EQ(row.subject, "P017");
  EXPECT_EQ(row.state, "complete");
  EXPECT_EQ(row.started_utc_ns, kStartUtcNs);
  EXPECT_NEAR(static_cast<double>(row.ended_utc_ns - kStartUtcNs), 2e9, 1.1e7);
  const PartRow part = only_part();
  EXPECT_EQ(part.file, file("whatever.xdf"));
  EXPECT_EQ(part.state, PartState::Complete);
  EXPECT_EQ(part.sha256, verify(file("whatever.xdf"))->sha256);
  EXPECT_EQ(part.bytes, std::filesystem::file_size(file("whatever.xdf")));
  EXPECT_EQ(part.scans, 200U);
}

TEST_F(CatalogueRebuild, Trials_AreReadFromTheEvents) {
  record("a.xdf", facts());
  static_cast<void>(rebuilt());
  const auto trials = session().trials;
  ASSERT_EQ(trials.size(), 2U);
  const TrialRow first{.session_id = "s1", .trial = 1, .condition = "a", .outcome = "done", .first_scan = 20, .last_scan = 80};
  EXPECT_EQ(trials[0], first);
  EXPECT_EQ(trials[1].outcome, "aborted");
  EXPECT_EQ(trials[1].last_scan, 199U);
}

TEST_F(CatalogueRebuild, PartsOfAnOlderCatalogue_AreReadAgainForWhatTheyLack) {
  record_with_outage("a.xdf");
  static_cast<void>(rebuilt());
  const PartRow whole = only_part();
  ASSERT_TRUE(whole.losses);
  EXPECT_EQ(whole.losses->of(core::GapReason::Overrun), (core::LossCount{.gaps = 1, .scans = 400}));
  EXPECT_EQ(whole.duration_s, 7.0);
  close();
  ASSERT_TRUE(meddle("UPDATE parts SET losses = '{}', duration_s = 3.0; PRAGMA user_version = 4"));  // as version 2 became version 3

  EXPECT_EQ(rebuilt().read_again, 1U);
  EXPECT_EQ(only_part(), whole);
  EXPECT_EQ(rebuilt().read_again, 0U) << "once is enough";
}

TEST_F(CatalogueRebuild, PartOfAnOlderCatalogueWhoseFileIsUnreadable_StaysUnknown) {
  record_with_outage("a.xdf");
  static_cast<void>(rebuilt());
  ASSERT_TRUE(meddle("UPDATE parts SET losses = ''"));
  std::ofstream(file("a.xdf")) << "junk";

  EXPECT_EQ(rebuilt().read_again, 0U);
  EXPECT_FALSE(only_part().losses);
  EXPECT_EQ(only_part().state, PartState::Complete);
}

TEST_F(CatalogueRebuild, RecordingWithoutAnyScan_IsNotComplete) {
  ASSERT_TRUE(XdfWriter::create(file("empty.xdf"), to_facts(facts())).value()->close());
  static_cast<void>(rebuilt());
  EXPECT_EQ(only_part().state, PartState::Incomplete);
  EXPECT_EQ(session().state, "incomplete");
}

TEST_F(CatalogueRebuild, Calibration_ComesBackWithItsRecording) {
  SessionFacts calibrated = facts();
  calibrated.calibration_id = "cop-7";
  record("a.xdf", calibrated);
  static_cast<void>(rebuilt());
  EXPECT_FALSE(meddle("INSERT INTO calibrations VALUES ('cop-7', '', '', '')")) << "the id is not taken";
  EXPECT_TRUE(meddle("INSERT INTO calibrations VALUES ('cop-8', '', '', '')"));
}

TEST_F(CatalogueRebuild, Again_FindsNothingNew) {
  record("a.xdf", facts());
  static_cast<void>(rebuilt());
  const auto before = session();
  const auto done = rebuilt();
  EXPECT_EQ(done.added + done.found_again + done.missing, 0U);
  EXPECT_EQ(session(), before);
}

TEST_F(CatalogueRebuild, WhatTheCatalogueSays_IsNotOverwritten) {
  record("a.xdf", facts());
  ASSERT_TRUE(catalogue().begin_part(facts(), file("a.xdf")));
  ASSERT_TRUE(catalogue().end_session("s1", "aborted", "fell ill", 7));
  static_cast<void>(rebuilt());
  EXPECT_EQ(session().message, "fell ill");
  EXPECT_EQ(only_part().state, PartState::Recording);
}

TEST_F(CatalogueRebuild, IncompleteRecording_SaysWhy) {
  record("a.xdf", facts(), End::Incomplete);
  static_cast<void>(rebuilt());
  EXPECT_EQ(only_part().state, PartState::Incomplete);
  EXPECT_EQ(only_part().reason, "disk full");
  EXPECT_EQ(session().state, "incomplete");
}

TEST_F(CatalogueRebuild, RecordingWithoutFooters_IsInterrupted) {
  record("a.xdf", facts(), End::Abandoned);
  EXPECT_EQ(rebuilt().added, 1U);
  EXPECT_EQ(only_part().state, PartState::Interrupted);
  EXPECT_EQ(only_part().file, file("a.xdf.part"));
  EXPECT_EQ(only_part().sha256, "");
  EXPECT_EQ(session().state, "interrupted");
  EXPECT_EQ(session().trials.size(), 2U);
}

TEST_F(CatalogueRebuild, TornRecording_IsEnteredUpToThere) {
  record("a.xdf", facts(), End::Abandoned);
  std::ofstream(file("a.xdf.part"), std::ios::app | std::ios::binary) << "\x04torn";
  EXPECT_EQ(rebuilt().added, 1U);
  EXPECT_EQ(only_part().state, PartState::Interrupted);
  EXPECT_EQ(only_part().scans, 200U);
  EXPECT_EQ(only_part().bytes, std::filesystem::file_size(file("a.xdf.part")));
  EXPECT_NE(only_part().reason, "");
}

TEST_F(CatalogueRebuild, RepairedCopyBesideItsOriginal_IsTheOneThatCounts) {
  record("a.xdf", facts(), End::Abandoned);
  ASSERT_TRUE(recover(file("a.xdf.part"), recovered_name(file("a.xdf.part"))));
  EXPECT_EQ(rebuilt().added, 1U);
  EXPECT_EQ(only_part().state, PartState::Recovered);
  EXPECT_EQ(only_part().file, file("a.recovered.xdf"));
  EXPECT_EQ(rebuilt().found_again, 0U);
}

TEST_F(CatalogueRebuild, RepairedCopyOfAKnownInterruptedOne_TakesItsPlace) {
  record("a.xdf", facts(), End::Abandoned);
  static_cast<void>(rebuilt());
  ASSERT_TRUE(recover(file("a.xdf.part"), recovered_name(file("a.xdf.part"))));
  EXPECT_EQ(rebuilt().found_again, 1U);
  EXPECT_EQ(only_part().state, PartState::Recovered);
  EXPECT_GE(only_part().lost_s_at_most, 0.0);
}

TEST_F(CatalogueRebuild, RepairedCopyOfOneThatWasCutOffBeforeItsFirstSample_IsOneToo) {
  XdfWriter::create(file("a.xdf"), to_facts(facts())).value()->abandon();
  ASSERT_TRUE(recover(file("a.xdf.part"), recovered_name(file("a.xdf.part"))));
  EXPECT_EQ(rebuilt().added, 1U);
  EXPECT_EQ(only_part().state, PartState::Recovered);
  EXPECT_EQ(session().state, "interrupted");
}

TEST_F(CatalogueRebuild, HalfACopyOfAKnownInterruptedOne_DoesNot) {
  record("a.xdf", facts(), End::Abandoned);
  static_cast<void>(rebuilt());
  std::filesystem::copy_file(file("a.xdf.part"), file("a.recovered.xdf"));
  EXPECT_EQ(rebuilt().found_again, 0U);
  EXPECT_EQ(only_part().file, file("a.xdf.part"));
}

TEST_F(CatalogueRebuild, FileGone_IsMissingAndComesBack) {
  record("a.xdf", facts());
  static_cast<void>(rebuilt());
  const PartRow before = only_part();
  std::filesystem::rename(file("a.xdf"), path("elsewhere"));
  EXPECT_EQ(rebuilt().missing, 1U);
  EXPECT_EQ(only_part().state, PartState::Missing);
  EXPECT_EQ(only_part().sha256, before.sha256);
  EXPECT_EQ(rebuilt().missing, 1U);  // still

  std::filesystem::rename(path("elsewhere"), file("a.xdf"));
  EXPECT_EQ(rebuilt().found_again, 1U);
  EXPECT_EQ(only_part(), before);
  EXPECT_EQ(session().trials.size(), 2U);
}

TEST_F(CatalogueRebuild, FileMoved_IsFoundAtItsNewPlace) {
  record("a.xdf", facts());
  static_cast<void>(rebuilt());
  std::filesystem::create_directories(file("2026/november"));
  std::filesystem::rename(file("a.xdf"), file("2026/november/b.xdf"));
  const auto done = rebuilt();
  EXPECT_EQ(done.found_again, 1U);
  EXPECT_EQ(done.missing, 0U);
  EXPECT_EQ(only_part().file, file("2026/november/b.xdf"));
  EXPECT_EQ(only_part().state, PartState::Complete);
}

TEST_F(CatalogueRebuild, CopyOfAKnownOne_IsNoRecordingOfItsOwn) {
  record("a.xdf", facts());
  std::filesystem::copy_file(file("a.xdf"), file("b.xdf"));
  EXPECT_EQ(rebuilt().added, 1U);
  EXPECT_EQ(only_part().file, file("a.xdf"));
}

TEST_F(CatalogueRebuild, RecordingBeingWritten_IsLeftAlone) {
  record("a.xdf", facts(), End::Abandoned);
  ASSERT_TRUE(catalogue().begin_part(facts(), file("a.xdf")));  // by its final name
  const auto done = rebuilt();
  EXPECT_EQ(done.added + done.found_again + done.missing, 0U);
  EXPECT_EQ(only_part().state, PartState::Recording);
}

TEST_F(CatalogueRebuild, SeveralParts_MakeOneSession) {
  record("z.xdf", facts("s1", 1, kStartUtcNs), End::Incomplete);
  record("a.xdf", facts("s1", 2, kStartUtcNs + 60'000'000'000));
  EXPECT_EQ(rebuilt().added, 2U);
  const SessionRow row = session();
  ASSERT_EQ(row.parts.size(), 2U);
  EXPECT_EQ(row.parts[0].file, file("z.xdf"));
  EXPECT_EQ(row.state, "complete");  // as its newest part, though that was found first
  EXPECT_EQ(row.started_utc_ns, kStartUtcNs);
  EXPECT_EQ(row.trials.size(), 4U);
}

TEST_F(CatalogueRebuild, SessionThatRuns_GoesOnWhenAnOldPartIsFound) {
  ASSERT_TRUE(catalogue().begin_part(facts("s1", 2, 2000), "now"));
  record("a.xdf", facts("s1", 1, 1000));
  EXPECT_EQ(rebuilt().added, 1U);
  EXPECT_EQ(session().state, "running");
}

TEST_F(CatalogueRebuild, WhatIsNoRecordingOfOurs_IsToldAndLeftOut) {
  std::ofstream(file("a.xdf")) << "no XDF";
  std::ofstream(file("b.xdf.part")) << "";
  ASSERT_TRUE((*XdfWriter::create(file("c.xdf"), {{"made_by", "another program"}}))->close());
  std::ofstream(file("notes.txt")) << "not looked at";
  std::filesystem::create_directory(file("folder.xdf"));
  ASSERT_EQ(::mkfifo(file("pipe.xdf").c_str(), 0600), 0);
  const auto done = rebuilt();
  EXPECT_EQ(done.added, 0U);
  EXPECT_THAT(done.unreadable,
              ElementsAre(HasSubstr("a.xdf: "), HasSubstr("c.xdf: it is no recording of dtsd"), HasSubstr("b.xdf.part: ")));
}

TEST_F(CatalogueRebuild, HostileFacts_AreToldAndLeftOut) {
  record("a.xdf", facts("../../etc/passwd"));
  record("b.xdf", facts("s2", 0));
  record("c.xdf", facts("s3", 1));
  auto other = facts("s3", 2);
  other.subject = "P2";
  record("d.xdf", other);
  const auto done = rebuilt();
  EXPECT_EQ(done.added, 1U);
  EXPECT_THAT(done.unreadable, ElementsAre(HasSubstr("a.xdf"), HasSubstr("b.xdf"), HasSubstr("d.xdf")));
  EXPECT_EQ(catalogue().parts()->size(), 1U);
}

TEST_F(CatalogueRebuild, ClosedRecordingThatRotted_IsIncompleteAndSaysWhere) {
  record("a.xdf", facts());
  std::string bytes;
  {
    std::ifstream in(file("a.xdf"), std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(in), {});
  }
  std::filesystem::remove(file("a.xdf"));
  std::ofstream(file("a.xdf"), std::ios::binary) << bytes.substr(0, bytes.size() - 10);
  EXPECT_EQ(rebuilt().added, 1U);
  EXPECT_EQ(only_part().state, PartState::Incomplete);
  EXPECT_NE(only_part().reason, "");
}

TEST_F(CatalogueRebuild, LostCatalogue_ComesBackFromTheFiles) {
  record("a.xdf", facts("s1", 1, 1000));
  record("b.xdf", facts("s2", 1, 2000), End::Abandoned);
  static_cast<void>(rebuilt());
  const auto before = catalogue().sessions({});
  close();
  std::filesystem::remove(path());
  EXPECT_EQ(rebuilt().added, 2U);
  EXPECT_EQ(*catalogue().sessions({}), *before);
}

}  // namespace
}  // namespace dts::record
