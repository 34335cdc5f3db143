// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "dts/wire/event_json.h"
#include "record/catalogue/recording_files.h"
#include "record/recording.h"
#include "record/xdf/recovery.h"
#include "record/xdf/xdf_writer.h"
#include "support/event_text.h"
#include "unit/record/catalogue/catalogue_fixture.h"

namespace dts::record {
namespace {

using catalogue_test::code;
using catalogue_test::facts;
using catalogue_test::what;

constexpr std::int64_t kStartUtcNs = 1'700'000'000'000'000'000;

/// How a recording of the tests ends.
enum class End { Closed, Incomplete, Abandoned };

class CatalogueRebuild : public catalogue_test::CatalogueFixture {
 protected:
  CatalogueRebuild() { std::filesystem::create_directory(path("sessions")); }
  [[nodiscard]] std::string file(const std::string& name) const { return path("sessions/" + name); }

  /// 200 scans at 100 Hz of synthetic data, an outage of 4 s and 100 more; one trial done, one under way at the end.
  void record(const std::string& name, const SessionFacts& session, End end = End::Closed,
              const std::vector<std::string>& more_events = {}) const {
    auto writer = XdfWriter::create(file(name), to_facts(session));
    ASSERT_TRUE(writer) << what(writer);
    XdfWriter& xdf = **writer;
    const auto rate = core::Rate::create(100, 1).value();
    const auto raw = xdf.add_stream({.name = "floor/raw", .content = "DTS", .rate = rate, .channels = {{.label = "w1_v", .unit = "V"}}});
    const auto events =
        xdf.add_stream({.name = "floor/events", .content = "Markers", .value_type = ValueType::Text, .channels = {{.label = "event"}}});
    const auto tell = [&](double time_s, const std::string& text) {
      const v1::Event event = test::event_of(text);
      const std::vector<std::pair<double, std::string>> texts{{time_s, wire::to_json(event)}};
      ASSERT_TRUE(xdf.write_texts(events, texts, {.segment = event.segment(), .first_scan = {event.scan()}}));
    };
    const auto step = [&](const std::string& step_of_trial, int trial, int scan) {
      tell(1000.0 + static_cast<double>(scan) / 100.0, "scan: " + std::to_string(scan) + " trial { step: TRIAL_EVENT_KIND_" +
                                                           step_of_trial + " trial: " + std::to_string(trial) +
                                                           " attempt: 1 block: 1 condition: 'a' }");
    };
    tell(1000.0, "segment_start {}");
    ASSERT_TRUE(xdf.write_samples(raw, 1000.0, std::vector<double>(200, 1.5), {}));
    step("MEASURE", 1, 20);
    step("DONE", 1, 80);
    for (const std::string& text : more_events) tell(1000.85, text);
    step("MEASURE", 2, 120);
    tell(1006.0, "segment: 1 segment_start { reason: GAP_REASON_OVERRUN missing_scans: 400 }");
    ASSERT_TRUE(xdf.write_samples(raw, 1006.0, std::vector<double>(100, 1.5), {.segment = 1}));
    const bool is_closed = end == End::Closed ? xdf.close().has_value() : end == End::Incomplete && xdf.close_incomplete("disk full");
    ASSERT_EQ(is_closed, end != End::Abandoned);
    if (end == End::Abandoned) xdf.abandon();
  }
  /// What `rebuild` did: "2 added", and what it could not read.
  std::string rebuilt() {
    const auto done = rebuild(catalogue(), path("sessions"));
    if (!done) return what(done);
    std::string text;
    for (const auto& [count, kind] : {std::pair{done->added, " added "},
                                      {done->found_again, " found again "},
                                      {done->missing, " missing "},
                                      {done->read_again, " read again "}}) {
      if (count != 0) text += std::to_string(count) + kind;
    }
    for (const std::string& line : done->unreadable) text += "\n" + line;
    for (std::size_t at = text.find(folder_); at != std::string::npos; at = text.find(folder_)) text.erase(at, folder_.string().size());
    return text;
  }
  std::string torn(const std::string& name, std::uintmax_t bytes) const {
    std::ifstream in(file(name), std::ios::binary);
    const std::string whole{std::istreambuf_iterator<char>(in), {}};
    std::filesystem::remove(file(name));  // closed recordings are read-only
    std::ofstream(file(name), std::ios::binary) << whole.substr(0, whole.size() - bytes);
    return file(name);
  }
};

const std::string kLoss = R"({"overrun":{"gaps":1,"scans":400}})";

TEST_F(CatalogueRebuild, NoRecordingsOrNoFolder_ChangesNothing) {
  EXPECT_EQ(rebuilt(), "");
  ASSERT_TRUE(catalogue().begin_part(facts(), file("a.xdf")));
  const std::string before = sessions_text();
  EXPECT_EQ(code(rebuild(catalogue(), path("none"))), core::ErrorCode::NotFound);
  EXPECT_EQ(sessions_text(), before);
}

TEST_F(CatalogueRebuild, EachWayOfEnding_IsEnteredWithAllThatTheFileSays) {
  record("closed.xdf", facts("s1", 1, kStartUtcNs));
  record("incomplete.xdf", facts("s2", 1, kStartUtcNs - 1), End::Incomplete);
  record("abandoned.xdf", facts("s3", 1, kStartUtcNs - 2), End::Abandoned);
  record("torn.xdf", facts("s4", 1, kStartUtcNs - 3), End::Abandoned);
  std::ofstream(file("torn.xdf.part"), std::ios::app | std::ios::binary) << "\x04torn";
  ASSERT_TRUE(XdfWriter::create(file("empty.xdf"), to_facts(facts("s5", 1, kStartUtcNs - 4))).value()->close());
  record("rotten.xdf", facts("s6", 1, kStartUtcNs - 5));
  torn("rotten.xdf", 10);
  record("repaired.xdf", facts("s7", 1, kStartUtcNs - 6), End::Abandoned);
  ASSERT_TRUE(recover(file("repaired.xdf.part"), recovered_name(file("repaired.xdf.part"))));
  XdfWriter::create(file("cut.xdf"), to_facts(facts("s8", 1, kStartUtcNs - 7))).value()->abandon();
  ASSERT_TRUE(recover(file("cut.xdf.part"), recovered_name(file("cut.xdf.part"))));

  EXPECT_EQ(rebuilt(), "8 added ");

  EXPECT_EQ(
      sessions_text(),
      "s1 floor free P017 complete from 1700000000000000000 to 1700000007000000000\n"
      "  part 1 sessions/closed.xdf complete 300 scans 7 s, 1 valid, lost {\"overrun\":{\"gaps\":1,\"scans\":400}} 0 s\n"
      "  trial 1.1.1 a done 0:20 to 0:80\n"
      "  trial 1.2.1 a aborted 0:120 to 1:99\n"
      "s2 floor free P017 incomplete from 1699999999999999999 to 1700000006999999999: disk full\n"
      "  part 1 sessions/incomplete.xdf incomplete 300 scans 7 s, 1 valid, lost {\"overrun\":{\"gaps\":1,\"scans\":400}} 0 s: disk full\n"
      "  trial 1.1.1 a done 0:20 to 0:80\n"
      "  trial 1.2.1 a aborted 0:120 to 1:99\n"
      "s3 floor free P017 interrupted from 1699999999999999998 to 1700000006999999998: it was not closed: the daemon or the power failed "
      "during the recording\n"
      "  part 1 sessions/abandoned.xdf.part interrupted 300 scans 7 s, 1 valid, lost {\"overrun\":{\"gaps\":1,\"scans\":400}} 0 s: it was "
      "not closed: the daemon or the power failed during the recording\n"
      "  trial 1.1.1 a done 0:20 to 0:80\n"
      "  trial 1.2.1 a aborted 0:120 to 1:99\n"
      "s4 floor free P017 interrupted from 1699999999999999997 to 1700000006999999997: /sessions/torn.xdf.part: chunk of 1852993396 bytes "
      "(at most 64 MiB are allowed) at byte 4711\n"
      "  part 1 sessions/torn.xdf.part interrupted 300 scans 7 s, 1 valid, lost {\"overrun\":{\"gaps\":1,\"scans\":400}} 0 s: "
      "/sessions/torn.xdf.part: chunk of 1852993396 bytes (at most 64 MiB are allowed) at byte 4711\n"
      "  trial 1.1.1 a done 0:20 to 0:80\n"
      "  trial 1.2.1 a aborted 0:120 to 1:99\n"
      "s5 floor free P017 incomplete from 1699999999999999996 to 1699999999999999996: it contains no scan\n"
      "  part 1 sessions/empty.xdf incomplete 0 scans 0 s, 0 valid, lost {} 0 s: it contains no scan\n"
      "s6 floor free P017 incomplete from 1699999999999999995 to 1700000006999999995: /sessions/rotten.xdf: chunk torn at byte 4899\n"
      "  part 1 sessions/rotten.xdf incomplete 300 scans 7 s, 1 valid, lost {\"overrun\":{\"gaps\":1,\"scans\":400}} 0 s: "
      "/sessions/rotten.xdf: chunk torn at byte 4899\n"
      "  trial 1.1.1 a done 0:20 to 0:80\n"
      "  trial 1.2.1 a aborted 0:120 to 1:99\n"
      "s7 floor free P017 interrupted from 1699999999999999994 to 1700000006999999994: no footer\n"
      "  part 1 sessions/repaired.recovered.xdf recovered 300 scans 7 s, 1 valid, lost {\"overrun\":{\"gaps\":1,\"scans\":400}} 0.75 s: no "
      "footer\n"
      "  trial 1.1.1 a done 0:20 to 0:80\n"
      "  trial 1.2.1 a aborted 0:120 to 1:99\n"
      "s8 floor free P017 interrupted from 1699999999999999993 to 1699999999999999993: interrupted; this is the repaired copy\n"
      "  part 1 sessions/cut.recovered.xdf recovered 0 scans 0 s, 0 valid, lost {} 0 s: interrupted; this is the repaired copy\n");
  const PartRow part = catalogue().session("s1")->parts.at(0);
  EXPECT_EQ(part.sha256, verify(part.file)->sha256);
  EXPECT_EQ(part.bytes, std::filesystem::file_size(part.file));
  EXPECT_EQ(catalogue().session("s3")->parts.at(0).sha256, "");
  const std::string before = sessions_text();
  EXPECT_EQ(rebuilt(), "") << "finds nothing new";
  close();
  std::filesystem::remove(path());
  EXPECT_EQ(rebuilt(), "8 added ");
  EXPECT_EQ(sessions_text(), before) << "a lost catalogue comes back from the files";
}

TEST_F(CatalogueRebuild, PartsOfAnOlderCatalogue_AreReadAgainForWhatTheyLack) {
  record("a.xdf", facts(), End::Closed,
         {"scan: 85 trial { step: TRIAL_EVENT_KIND_REDONE trial: 1 attempt: 1 block: 1 }",
          "scan: 85 trial { step: TRIAL_EVENT_KIND_READY trial: 1 attempt: 2 block: 1 }", "scan: 85 marker { text: 'fell' }",
          "scan: 85 trial { step: TRIAL_EVENT_KIND_UNDONE trial: 1 attempt: 1 block: 1 }"});
  const auto markers_and_attempts = [this] {
    std::string text;
    const SessionRow session = catalogue().session("s1").value();
    for (const MarkerRow& marker : session.markers) {
      text +=
          std::to_string(marker.part) + "." + std::to_string(marker.number) + " " + marker.text + " " + std::to_string(marker.scan) + ", ";
    }
    const auto attempts = catalogue().newest_attempts("s1").value();
    for (const auto& [trial, attempt] : attempts) text += "trial " + std::to_string(trial) + " attempt " + std::to_string(attempt) + ", ";
    return text;
  };
  EXPECT_EQ(rebuilt(), "1 added ");
  const std::string whole = sessions_text();
  const std::string events = "1.1 fell 85, trial 1 attempt 2, trial 2 attempt 1, ";
  EXPECT_EQ(markers_and_attempts(), events) << "attempt 2 was undone: its number is not used again";
  close();
  ASSERT_TRUE(
      meddle("UPDATE parts SET losses = '{}', duration_s = 3.0; PRAGMA user_version = 4;"  // as version 2 became version 3
             "ALTER TABLE parts DROP COLUMN rig; ALTER TABLE parts DROP COLUMN leading_part;"
             "ALTER TABLE parts DROP COLUMN has_events; DROP TABLE begun_attempts; DROP TABLE markers; DROP TABLE corrections; ALTER TABLE "
             "trials DROP COLUMN corrected_outcome; "
             "ALTER TABLE sessions "
             "DROP COLUMN notes;"
             "ALTER TABLE sessions DROP COLUMN corrected_subject; ALTER TABLE sessions DROP COLUMN corrected_label;"
             "ALTER TABLE sessions DROP COLUMN is_deleted"));

  EXPECT_EQ(rebuilt(), "1 read again ");
  EXPECT_EQ(sessions_text(), whole);
  EXPECT_EQ(markers_and_attempts(), events);
  EXPECT_EQ(rebuilt(), "") << "once is enough";

  ASSERT_TRUE(meddle("UPDATE parts SET has_events = 0; DELETE FROM markers; DELETE FROM begun_attempts"));  // version 8, losses known
  EXPECT_EQ(rebuilt(), "1 read again ");
  EXPECT_EQ(markers_and_attempts(), events);

  ASSERT_TRUE(meddle("UPDATE parts SET losses = ''"));
  torn("a.xdf", std::filesystem::file_size(file("a.xdf")));
  EXPECT_EQ(rebuilt(), "");
  std::string unknown = whole;
  EXPECT_EQ(sessions_text(), unknown.replace(unknown.find(kLoss), kLoss.size(), "unknown"));
}

/// One correction of the notes of session s1 for each text.
Corrections notes(const std::vector<std::string>& texts) {
  Corrections made{.session_id = "s1"};
  for (const std::string& text : texts) {
    made.add({.utc_ns = 1, .who = "local", .field = CorrectedField::Notes, .old_value = "", .new_value = text, .reason = "r"});
  }
  return made;
}

TEST_F(CatalogueRebuild, ACopyOfCorrectionsElsewhere_DoesNotReplaceThoseBesideTheRecording) {
  for (const std::string folder : {"a", "z"}) {  // before and after the name of the right file
    const std::string copied = folder + "-copy/s1.corrections.json";
    std::filesystem::remove_all(file(""));
    std::filesystem::create_directories(file(folder + "-copy"));
    record("k.xdf", facts("s1"));
    const std::string beside = corrections_file(file("k.xdf"), "s1");
    EXPECT_EQ(rebuilt().substr(0, 2), "1 ");
    for (const std::vector<std::string>& copy : std::vector<std::vector<std::string>>{{"1"}, {"other", "2"}, {"1", "2", "3"}}) {
      ASSERT_TRUE(write_corrections(beside, notes({"1", "2"})));
      ASSERT_TRUE(catalogue().set_corrections(notes({"1", "2"})));
      ASSERT_TRUE(write_corrections(file(copied), notes(copy)));
      EXPECT_EQ(rebuilt(), "");
      EXPECT_EQ(read_corrections(beside).value(), notes({"1", "2"})) << copied;
      EXPECT_EQ(catalogue().session("s1")->corrections, notes({"1", "2"}).all) << copied;
    }
    std::filesystem::remove(beside);
    EXPECT_EQ(rebuilt(), "");
    EXPECT_EQ(read_corrections(beside).value(), notes({"1", "2", "3"})) << "the longest is right if the file is lost";
    ASSERT_TRUE(catalogue().erase({"s1"}));
  }
}

TEST_F(CatalogueRebuild, CorrectionsThatCannotBeWritten_AreListed) {
  record("a.xdf", facts("s1"));
  EXPECT_EQ(rebuilt(), "1 added ");
  const std::string beside = corrections_file(file("a.xdf"), "s1");
  std::filesystem::create_directories(beside + ".new/in the way");
  ASSERT_TRUE(catalogue().set_corrections(notes({"1"})));
  EXPECT_EQ(rebuilt(), "\ncannot write '/sessions/s1.corrections.json': File exists") << "there is no file";
  std::ofstream(beside) << R"({"session_id": "s1", "corrections": []})";
  EXPECT_EQ(rebuilt(), "\ncannot write '/sessions/s1.corrections.json': File exists") << "it is shorter";
  EXPECT_EQ(catalogue().session("s1")->corrections, notes({"1"}).all);
}

TEST_F(CatalogueRebuild, CorrectionsThatACrashLeftUnfinished_AreRemoved) {
  std::ofstream(file("s1.corrections.json.new")) << "as P017";
  EXPECT_EQ(rebuilt(), "");
  EXPECT_FALSE(std::filesystem::exists(file("s1.corrections.json.new")));
}

TEST_F(CatalogueRebuild, OfTwoListsOfCorrections_TheLongerOneIsRight) {
  record("a.xdf", facts());
  EXPECT_EQ(rebuilt(), "1 added ");
  Corrections one{.session_id = "s1"};
  one.add({.who = "local", .field = CorrectedField::Subject, .old_value = "P017", .new_value = "P018", .reason = "r"});
  Corrections two = one;
  two.add({.who = "local", .field = CorrectedField::Notes, .old_value = "", .new_value = "n", .reason = "r"});
  const std::string beside = corrections_file(file("a.xdf"), "s1");

  ASSERT_TRUE(write_corrections(beside, two));  // dtsd ended before it entered the second one
  ASSERT_TRUE(catalogue().set_corrections(one));
  EXPECT_EQ(rebuilt(), "");
  EXPECT_EQ(catalogue().session("s1")->corrections, two.all);

  ASSERT_TRUE(write_corrections(beside, one));  // somebody restored an older folder
  EXPECT_EQ(rebuilt(), "");
  EXPECT_EQ(read_corrections(beside).value(), two);

  std::filesystem::remove(beside);
  EXPECT_EQ(rebuilt(), "");
  EXPECT_EQ(read_corrections(beside).value(), two);

  ASSERT_TRUE(write_corrections(file("other.corrections.json"), {.session_id = "unknown", .all = one.all}));
  EXPECT_EQ(rebuilt(), "\n/sessions/other.corrections.json: no session unknown") << "its recordings may be elsewhere";
  EXPECT_TRUE(std::filesystem::exists(file("other.corrections.json")));
}

TEST_F(CatalogueRebuild, Calibration_ComesBackWithItsRecording) {
  SessionFacts calibrated = facts();
  calibrated.calibration_id = "cop-7";
  record("a.xdf", calibrated);
  EXPECT_EQ(rebuilt(), "1 added ");
  EXPECT_FALSE(meddle("INSERT INTO calibrations VALUES ('cop-7', '', '', '')")) << "the id is not taken";
  EXPECT_TRUE(meddle("INSERT INTO calibrations VALUES ('cop-8', '', '', '')"));
}

TEST_F(CatalogueRebuild, WhatTheCatalogueSays_IsNotOverwritten) {
  record("a.xdf", facts());
  record("b.xdf", facts("s2"), End::Abandoned);
  ASSERT_TRUE(catalogue().begin_part(facts(), file("a.xdf")));
  ASSERT_TRUE(catalogue().end_session("s1", "aborted", "fell ill", 7));
  ASSERT_TRUE(catalogue().begin_part(facts("s2"), file("b.xdf")));  // being written: known by its final name
  const std::string before = sessions_text();
  EXPECT_EQ(rebuilt(), "");
  EXPECT_EQ(sessions_text(), before);
}

TEST_F(CatalogueRebuild, RepairedCopyOfAKnownInterruptedOne_TakesItsPlaceOnceItIsWhole) {
  record("a.xdf", facts(), End::Abandoned);
  EXPECT_EQ(rebuilt(), "1 added ");
  const std::string before = sessions_text();
  std::filesystem::copy_file(file("a.xdf.part"), file("a.recovered.xdf"));
  EXPECT_EQ(rebuilt(), "") << "half a copy";
  EXPECT_EQ(sessions_text(), before);
  std::filesystem::remove(file("a.recovered.xdf"));
  ASSERT_TRUE(recover(file("a.xdf.part"), file("a.recovered.xdf")));
  EXPECT_EQ(rebuilt(), "1 found again ");
  EXPECT_EQ(
      sessions_text(),
      "s1 floor free P017 interrupted from 1000 to 7000001000: it was not closed: the daemon or the power failed during the recording\n"
      "  part 1 sessions/a.recovered.xdf recovered 300 scans 7 s, 1 valid, lost {\"overrun\":{\"gaps\":1,\"scans\":400}} 0.75 s: no "
      "footer\n"
      "  trial 1.1.1 a done 0:20 to 0:80\n"
      "  trial 1.2.1 a aborted 0:120 to 1:99\n");
}

TEST_F(CatalogueRebuild, FileGoneMovedOrCopied_IsStillTheSamePart) {
  record("a.xdf", facts());
  std::filesystem::copy_file(file("a.xdf"), file("b.xdf"));
  EXPECT_EQ(rebuilt(), "1 added ");
  const std::string before = sessions_text();
  std::filesystem::remove(file("b.xdf"));
  std::filesystem::rename(file("a.xdf"), path("elsewhere"));
  EXPECT_EQ(rebuilt(), "1 missing ");
  EXPECT_EQ(rebuilt(), "1 missing ") << "still";
  std::string missing = before;
  EXPECT_EQ(
      sessions_text(),
      missing.replace(missing.find("xdf complete") + 4, 8, "missing").replace(missing.find(" 0 s\n") + 4, 0, ": the file is missing"));
  std::filesystem::rename(path("elsewhere"), file("a.xdf"));
  EXPECT_EQ(rebuilt(), "1 found again ");
  EXPECT_EQ(sessions_text(), before);
  std::filesystem::create_directories(file("2026/november"));
  std::filesystem::rename(file("a.xdf"), file("2026/november/b.xdf"));
  EXPECT_EQ(rebuilt(), "1 found again ");
  std::string moved = before;
  EXPECT_EQ(sessions_text(), moved.replace(moved.find("a.xdf"), 5, "2026/november/b.xdf"));
}

TEST_F(CatalogueRebuild, SeveralParts_MakeOneSessionThatEndedAsItsNewest) {
  record("z.xdf", facts("s1", 1, kStartUtcNs), End::Incomplete);
  record("a.xdf", facts("s1", 2, kStartUtcNs + 60'000'000'000));
  ASSERT_TRUE(catalogue().begin_part(facts("s2", 2, 2000), path("now")));  // runs, elsewhere
  record("b.xdf", facts("s2", 1, 1000));
  EXPECT_EQ(rebuilt(), "3 added 1 missing ");
  EXPECT_EQ(sessions_text(),
            "s1 floor free P017 complete from 1700000000000000000 to 1700000067000000000\n"
            "  part 1 sessions/z.xdf incomplete 300 scans 7 s, 1 valid, lost {\"overrun\":{\"gaps\":1,\"scans\":400}} 0 s: disk full\n"
            "  part 2 sessions/a.xdf complete 300 scans 7 s, 1 valid, lost {\"overrun\":{\"gaps\":1,\"scans\":400}} 0 s\n"
            "  trial 1.1.1 a done 0:20 to 0:80\n"
            "  trial 1.2.1 a aborted 0:120 to 1:99\n"
            "  trial 2.1.1 a done 0:20 to 0:80\n"
            "  trial 2.2.1 a aborted 0:120 to 1:99\n"
            "s2 floor free P017 running from 1000 to 0\n"
            "  part 1 sessions/b.xdf complete 300 scans 7 s, 1 valid, lost {\"overrun\":{\"gaps\":1,\"scans\":400}} 0 s\n"
            "  part 2 now missing 0 scans 0 s, 0 valid, lost unknown 0 s: the file is missing\n"
            "  trial 1.1.1 a done 0:20 to 0:80\n"
            "  trial 1.2.1 a aborted 0:120 to 1:99\n");
}

TEST_F(CatalogueRebuild, WhatIsNoRecordingOfOursOrHostile_IsToldAndLeftOut) {
  std::ofstream(file("a.xdf")) << "no XDF";
  std::ofstream(file("b.xdf.part")) << "";
  ASSERT_TRUE((*XdfWriter::create(file("c.xdf"), {{"made_by", "another program"}}))->close());
  std::ofstream(file("notes.txt")) << "not looked at";
  std::filesystem::create_directory(file("folder.xdf"));
  ASSERT_EQ(::mkfifo(file("pipe.xdf").c_str(), 0600), 0);
  record("d.xdf", facts("../../etc/passwd"));
  record("e.xdf", facts("s2", 0));
  record("f.xdf", facts("s3", 1));
  auto other = facts("s3", 2);
  other.subject = "P2";
  record("g.xdf", other);
  EXPECT_EQ(rebuilt(),
            "1 added \n"
            "/sessions/a.xdf: /sessions/a.xdf is not an XDF file\n"
            "/sessions/c.xdf: it is not a recording of dtsd\n"
            "/sessions/d.xdf: a session's id is not 1 to 128 letters, digits, '_', '.' or '-'\n"
            "/sessions/e.xdf: session s2 names no rig, or part 0\n"
            "/sessions/g.xdf: session s3 is known with another rig, protocol or subject\n"
            "/sessions/b.xdf.part: /sessions/b.xdf.part is not an XDF file");
  EXPECT_EQ(catalogue().parts()->size(), 1U);
}

TEST_F(CatalogueRebuild, FilesOfASession_AreFoundWithoutACatalogue_TheBestOfEachPart) {
  record("s1.xdf", facts("s1"), End::Abandoned);
  ASSERT_TRUE(recover(file("s1.xdf.part"), recovered_name(file("s1.xdf.part"))));
  SessionFacts companion = facts("s1", 2);
  companion.rig = "plate";
  companion.rigs = {"floor", "plate"};
  companion.leading_part = 1;
  record("s1-plate.xdf", companion);
  record("s2.xdf", facts("s2"));

  EXPECT_FALSE(files_of_session(path("missing"), "s1"));
  const auto found = files_of_session(path("sessions"), "s1");
  ASSERT_TRUE(found) << what(found);
  ASSERT_EQ(found->size(), 2U);
  EXPECT_TRUE((*found)[0].file.ends_with("/s1.recovered.xdf")) << (*found)[0].file;
  EXPECT_TRUE((*found)[1].file.ends_with("/s1-plate.xdf")) << (*found)[1].file;
  EXPECT_EQ((*found)[1].facts, companion);
  EXPECT_EQ(code(files_of_session(path("sessions"), "s3")), core::ErrorCode::NotFound);
}

}  // namespace
}  // namespace dts::record
