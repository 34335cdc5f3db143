// SPDX-License-Identifier: Apache-2.0
#include "record/catalogue/corrections.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <utility>

#include "record/catalogue/sqlite.h"
#include "unit/record/catalogue/catalogue_fixture.h"

namespace dts::record {
namespace {

using catalogue_test::code;
using catalogue_test::facts;
using catalogue_test::what;

Correction correction(CorrectedField field, const std::string& from, const std::string& to) {
  return {.utc_ns = 5, .who = "local:anna", .field = field, .old_value = from, .new_value = to, .reason = "typing error"};
}

Correction outcome(std::uint32_t trial, const std::string& from, const std::string& to) {
  Correction made = correction(CorrectedField::Outcome, from, to);
  made.part = 1;
  made.trial = trial;
  made.attempt = 1;
  return made;
}

Corrections corrections(const std::vector<Correction>& all, const std::string& id = "s1") {
  Corrections made{.session_id = id};
  for (const Correction& one : all) made.add(one);
  return made;
}

class CorrectionsTest : public catalogue_test::CatalogueFixture {
 protected:
  /// A session with three trials: done, rejected, done.
  void add_session(const std::string& id = "s1") {
    ASSERT_TRUE(catalogue().begin_part(facts(id), path(id + ".xdf")));
    std::uint32_t number = 0;
    for (const std::string how : {"done", "rejected", "done"}) {
      ASSERT_TRUE(catalogue().put_trial({.session_id = id, .part = 1, .trial = ++number, .outcome = how}));
    }
    ASSERT_TRUE(catalogue().end_session(id, "complete", "", 2000));
  }
  std::string outcomes(const std::string& id = "s1") {
    std::string text;
    const SessionRow session = catalogue().session(id).value();
    for (const TrialRow& trial : session.trials) {
      text += trial.outcome + (trial.recorded_outcome.empty() ? "" : " (" + trial.recorded_outcome + ")") + ", ";
    }
    return text + std::to_string(session.parts.at(0).valid_trials) + " valid";
  }
  [[nodiscard]] core::Result<bool> overwrite_removed() const {
    return Catalogue::overwrite_removed(path(), folder_, [] { return true; });
  }
  std::string write(const std::string& text) {
    std::ofstream(path("s1.corrections.json")) << text;
    return path("s1.corrections.json");
  }
};

TEST_F(CorrectionsTest, AFileKeepsThem) {
  const Corrections written = corrections({correction(CorrectedField::Subject, "P071", "P017"), outcome(2, "rejected", "done")});
  const std::string file = corrections_file(path("s1.xdf"), "s1");
  ASSERT_TRUE(write_corrections(file, corrections({})));
  ASSERT_TRUE(write_corrections(file, written));
  const auto read = corrections_beside(path("s1.2.xdf"), facts("s1", 2));
  ASSERT_TRUE(read) << what(read);
  EXPECT_EQ(*read, written);
  EXPECT_EQ(read->all[1].number, 2U);
  EXPECT_EQ(*read->value(CorrectedField::Subject), "P017");
  EXPECT_EQ(read->value(CorrectedField::Label), nullptr);
  EXPECT_EQ(*read->outcome(1, 2, 1), "done");
  EXPECT_EQ(read->outcome(2, 2, 1), nullptr);
  EXPECT_EQ(corrected(facts(), *read).subject, "P017");
  EXPECT_EQ(corrections_beside(path("s2.xdf"), facts("s2"))->all.size(), 0U) << "there is no file";
}

TEST_F(CorrectionsTest, TextsThatAreRemovedAreNotRepeated) {
  const Corrections all = corrections({correction(CorrectedField::Label, "Anna Schmidt", "Anna S"),
                                       correction(CorrectedField::Notes, "", "n"), correction(CorrectedField::Label, "Anna S", "")});
  for (const Correction& one : all.all) {
    EXPECT_EQ(one.old_value.find("Anna"), std::string::npos);
    EXPECT_EQ(one.new_value.find("Anna"), std::string::npos);
  }
  EXPECT_EQ(*all.value(CorrectedField::Label), "");
  EXPECT_EQ(*all.value(CorrectedField::Notes), "n");
}

/// Of marker `number` in part 1.
Correction marker(std::uint32_t number, const std::string& from, const std::string& to) {
  Correction made = correction(CorrectedField::Marker, from, to);
  made.part = 1;
  made.marker = number;
  return made;
}

TEST_F(CorrectionsTest, AMarkerIsCorrectedOrRemoved_WithoutTheOthers) {
  const Corrections all = corrections({marker(1, "cough", "sneeze"), marker(2, "Anna fell", "Anna"), marker(2, "Anna", "")});
  EXPECT_EQ(*all.marker(1, 1), "sneeze");
  EXPECT_EQ(*all.marker(1, 2), "");
  EXPECT_EQ(all.marker(2, 1), nullptr);
  EXPECT_EQ(all.all[0].old_value, "cough");
  EXPECT_EQ(all.all[1].old_value + all.all[1].new_value + all.all[2].old_value, "[removed][removed][removed]");
  const std::string file = corrections_file(path("s1.xdf"), "s1");
  ASSERT_TRUE(write_corrections(file, all));
  EXPECT_EQ(*read_corrections(file), all);

  add_session();
  std::uint32_t number = 0;
  for (const char* text : {"cough", "Anna fell", "stumbled"}) {
    ASSERT_TRUE(catalogue().put_marker({.session_id = "s1", .number = ++number, .segment = 2, .scan = 345, .text = text}));
  }
  EXPECT_EQ(catalogue().sessions_with("Anna").value(), std::vector<std::string>{"s1"});
  ASSERT_TRUE(catalogue().set_corrections(all));
  std::string shown;
  const SessionRow session = catalogue().session("s1").value();
  for (const MarkerRow& one : session.markers) shown += one.text + " (" + one.recorded_text + "), ";
  EXPECT_EQ(shown, "sneeze (cough),  (), stumbled (), ");
  EXPECT_EQ(session.markers[1].segment, 2U);
  EXPECT_EQ(session.markers[1].scan, 345U);
  EXPECT_EQ(session.corrections, all.all);
  EXPECT_TRUE(catalogue().sessions_with("Anna").value().empty()) << "the removed text is in no row";
  EXPECT_EQ(code(catalogue().put_marker({.session_id = "s1", .part = 9})), core::ErrorCode::NotFound);
  ASSERT_TRUE(catalogue().erase({"s1"}));
}

TEST_F(CorrectionsTest, BadFilesAreRejectedWithTheirName) {
  const std::string head = "{\"session_id\": \"s1\", \"corrections\": ";
  const std::string one =
      "{\"utc_ns\": 1, \"who\": \"local\", \"field\": \"label\", \"old_value\": \"\", \"new_value\": \"x\", \"reason\": \"r\"}";
  EXPECT_TRUE(read_corrections(write(head + "[" + one + "]}")));
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = one;
    return head + "[" + text.replace(text.find(from), from.size(), to) + "]}";
  };
  std::string many;
  for (std::size_t count = 0; count <= kMostListed; ++count) many += (count == 0 ? "" : ",") + one;
  for (const std::string& text : std::vector<std::string>{
           "", "[]", "{}", head + "3}", head + "[3]}", "{\"corrections\": []}", head + "[" + many + "]}", std::string(100'000, '['),
           changed("\"label\"", "\"name\""), changed("\"local\"", "3"), changed("1,", "-1,"), changed("1,", "1e99,"),
           changed("\"label\"", "\"outcome\""), changed("\"x\"", "\"" + std::string(5000, 'x') + "\""), changed("\"x\"", "\"a\\nb\""),
           changed("\"r\"", "\"\\u001b[31m\""), changed("\"x\"", "\"\\u202eabc\"")}) {
    const auto read = read_corrections(write(text));
    EXPECT_EQ(code(read), core::ErrorCode::DataDamaged) << text.substr(0, 200);
    EXPECT_NE(what(read).find("s1.corrections.json"), std::string::npos);
  }
  const auto subject = [&](const std::string& id) {
    return code(read_corrections(write(head + R"([{"utc_ns": 1, "who": "local", "field": "subject", "old_value": "P 1", "new_value": ")" +
                                       id + R"(", "reason": "r"}]})")));
  };
  for (const std::string good : {"P017", "", "[erased]"}) EXPECT_NE(subject(good), core::ErrorCode::DataDamaged) << good;
  for (const std::string& bad : {std::string("Anna Schmidt"), std::string("<b>"), std::string(65, 'P')}) {
    EXPECT_EQ(subject(bad), core::ErrorCode::DataDamaged) << bad;
  }
  EXPECT_EQ(code(read_corrections(path("none"))), core::ErrorCode::NotFound);
  EXPECT_EQ(code(read_corrections(folder_)), core::ErrorCode::DataDamaged) << "a folder";
}

TEST_F(CorrectionsTest, AForgedSessionIdIsNoPath) {
  std::filesystem::create_directory(path("inner"));
  ASSERT_TRUE(write_corrections(path("x.corrections.json"), corrections({correction(CorrectedField::Subject, "", "Z")}, "../x")));
  const auto read = corrections_beside(path("inner/a.xdf"), facts("../x"));
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->all.empty());
}

TEST_F(CorrectionsTest, TheCatalogueShowsCorrectedAndRecordedValues) {
  add_session();
  ASSERT_TRUE(catalogue().set_corrections(
      corrections({correction(CorrectedField::Subject, "P017", "P018"), correction(CorrectedField::Label, "", "eyes closed"),
                   correction(CorrectedField::Notes, "", "new shoes"), outcome(1, "done", "rejected"), outcome(2, "rejected", "done")})));
  SessionRow row = catalogue().session("s1").value();
  EXPECT_EQ(row.subject + "/" + row.recorded_subject, "P018/P017");
  EXPECT_EQ(row.label + "/" + row.recorded_label + "/" + row.notes, "eyes closed//new shoes");
  EXPECT_EQ(row.corrections.size(), 5U);
  EXPECT_EQ(outcomes(), "rejected (done), done (rejected), done, 2 valid");
  EXPECT_EQ(catalogue().sessions({.subject = "P018"})->size(), 1U);
  EXPECT_EQ(catalogue().sessions({.subject = "P017"})->size(), 0U);

  ASSERT_TRUE(catalogue().set_corrections(corrections({outcome(1, "done", "rejected"), outcome(1, "rejected", "done")})));
  EXPECT_EQ(outcomes(), "done, rejected, done, 2 valid") << "corrected back";
  EXPECT_EQ(catalogue().session("s1")->subject, "P017");
  EXPECT_EQ(code(catalogue().set_corrections(corrections({}, "s9"))), core::ErrorCode::NotFound);
}

TEST_F(CorrectionsTest, DeletedSessionsAreInNoListButTheirOwn) {
  add_session();
  add_session("s2");
  ASSERT_TRUE(catalogue().set_corrections(corrections({correction(CorrectedField::Deleted, "no", "yes")})));
  const auto ids = [this](Shown shown) {
    std::string text;
    const auto rows = catalogue().sessions({.shown = shown}).value();
    for (const SessionRow& row : rows) text += row.id + " ";
    return text;
  };
  EXPECT_EQ(ids(Shown::Kept), "s2 ");
  EXPECT_EQ(ids(Shown::Deleted), "s1 ");
  EXPECT_EQ(ids(Shown::Both), "s2 s1 ");
  EXPECT_TRUE(catalogue().session("s1")->is_deleted);
  ASSERT_TRUE(catalogue().set_corrections(
      corrections({correction(CorrectedField::Deleted, "no", "yes"), correction(CorrectedField::Deleted, "yes", "no")})));
  EXPECT_EQ(ids(Shown::Kept), "s2 s1 ");
}

TEST_F(CorrectionsTest, SubjectsAreCountedWithTheirCorrectedIds) {
  add_session();
  add_session("s2");
  add_session("s3");
  ASSERT_TRUE(catalogue().set_corrections(corrections({correction(CorrectedField::Subject, "P017", "A1")})));
  ASSERT_TRUE(catalogue().set_corrections(corrections({correction(CorrectedField::Deleted, "no", "yes")}, "s2")));
  const auto subjects = catalogue().subjects().value();
  ASSERT_EQ(subjects.size(), 2U);
  EXPECT_EQ(subjects[0], (SubjectRow{.subject = "A1", .sessions = 1, .first_utc_ns = 1000, .last_utc_ns = 1000, .rigs = {"floor"}}));
  EXPECT_EQ(subjects[1].sessions, 2U);
  EXPECT_EQ(subjects[1].deleted_sessions, 1U);
  EXPECT_EQ(catalogue().count_subjects().value(), 2U);
  EXPECT_EQ(catalogue().subjects({.limit = 1}).value(), std::vector{subjects[0]});
  EXPECT_EQ(catalogue().subjects({.subject = "P017", .limit = 1}).value(), std::vector{subjects[1]});
  EXPECT_TRUE(catalogue().subjects({.subject = "P018"})->empty());
  ASSERT_TRUE(catalogue().set_corrections(corrections({correction(CorrectedField::Subject, "P017", "")})));
  EXPECT_EQ(catalogue().count_subjects().value(), 1U) << "a session without a subject";
  EXPECT_EQ(catalogue().subjects()->size(), 1U);
}

TEST_F(CorrectionsTest, DeletedSessionsAreNoFirstOrLastVisitOfASubject) {
  ASSERT_TRUE(catalogue().begin_part(facts("s1", 1, 1000), path("s1.xdf")));
  ASSERT_TRUE(catalogue().begin_part(facts("s2", 1, 2000), path("s2.xdf")));
  const auto visits = [this] {
    const SubjectRow subject = catalogue().subjects()->at(0);
    return std::pair{subject.first_utc_ns, subject.last_utc_ns};
  };
  EXPECT_EQ(visits(), (std::pair<std::int64_t, std::int64_t>{1000, 2000}));
  ASSERT_TRUE(catalogue().set_corrections(corrections({correction(CorrectedField::Deleted, "no", "yes")}, "s2")));
  EXPECT_EQ(visits(), (std::pair<std::int64_t, std::int64_t>{1000, 1000}));
  ASSERT_TRUE(catalogue().set_corrections(corrections({correction(CorrectedField::Deleted, "no", "yes")}, "s1")));
  EXPECT_EQ(visits(), (std::pair<std::int64_t, std::int64_t>{0, 0}));
}

TEST_F(CorrectionsTest, ErasedRowsAreNotEvenInTheBytesOfTheDatabase) {
  add_session();
  ASSERT_TRUE(catalogue().begin_part({.session_id = "s2", .rig = "floor", .protocol = "free", .subject = "SECRETSUBJECT"}, path("s2.xdf")));
  ASSERT_TRUE(catalogue().put_result({.session_id = "s2", .name = "SECRETRESULT", .value = 1.0, .unit = "1", .details = ""}));
  ASSERT_TRUE(catalogue().set_corrections(corrections({correction(CorrectedField::Notes, "", "SECRETNOTES")}, "s2")));
  ASSERT_TRUE(catalogue().append_audit({.utc_ns = 1, .who = "local", .what = "start_session", .target = "s2", .result = "ok"}));

  ASSERT_TRUE(catalogue().erase({"s2", "unknown"}));
  ASSERT_TRUE(overwrite_removed().value());

  EXPECT_EQ(code(catalogue().session("s2")), core::ErrorCode::NotFound);
  EXPECT_TRUE(catalogue().session("s1"));
  EXPECT_EQ(catalogue().results("s2")->size(), 0U);
  EXPECT_EQ(catalogue().verify_audit().value(), 1U) << "the trail is not affected";
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    std::ifstream stream(entry.path(), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    for (const std::string secret : {"SECRETSUBJECT", "SECRETRESULT", "SECRETNOTES"}) {
      EXPECT_EQ(bytes.find(secret), std::string::npos) << secret << " in " << entry.path();
    }
  }
}

TEST_F(CorrectionsTest, OfManySessionsNothingRemains_UnlessAnotherProgramReads) {
  std::vector<std::string> erased;
  for (int number = 0; number < 400; ++number) {
    const std::string id = "s" + std::to_string(number);
    const bool is_secret = number % 3 == 0;
    const std::string subject = is_secret ? "SECRETSUBJECT" : "P017";
    ASSERT_TRUE(catalogue().begin_part({.session_id = id, .rig = "floor", .protocol = "free", .subject = subject}, path(id)));
    ASSERT_TRUE(catalogue().set_corrections(corrections({correction(CorrectedField::Notes, "", subject + std::string(number, 'n'))}, id)));
    if (is_secret) erased.push_back(id);
  }
  const auto remains = [this] {
    return std::ranges::any_of(std::filesystem::directory_iterator(folder_), [](const auto& entry) {
      std::ifstream stream(entry.path(), std::ios::binary);
      return std::string{std::istreambuf_iterator<char>(stream), {}}.find("SECRETSUBJECT") != std::string::npos;
    });
  };
  {
    const Database reader = Database::open(path()).value();
    auto rows = reader.query("SELECT id FROM sessions");
    ASSERT_TRUE(rows.step());
    ASSERT_TRUE(catalogue().erase(erased));
    EXPECT_FALSE(overwrite_removed().value()) << "the reader needs the old rows";
    EXPECT_TRUE(remains());
  }
  EXPECT_TRUE(overwrite_removed().value());
  EXPECT_FALSE(remains());
  EXPECT_EQ(catalogue().sessions({.limit = 1000})->size(), 400 - erased.size());
}

TEST_F(CorrectionsTest, OverwritingOfRemovedRows_IsInterrupted) {
  for (int number = 0; number < 200; ++number) add_session("s" + std::to_string(number));
  ASSERT_TRUE(catalogue().erase({"s1"}));

  EXPECT_FALSE(Catalogue::overwrite_removed(path(), folder_, [] { return false; }));

  EXPECT_EQ(catalogue().sessions({.limit = 1000})->size(), 199U) << "nothing was lost";
  EXPECT_TRUE(overwrite_removed().value());
}

TEST_F(CorrectionsTest, SessionsAreFoundByTheirTexts) {
  add_session();
  add_session("s2");
  add_session("s3");
  ASSERT_TRUE(catalogue().set_corrections(corrections({correction(CorrectedField::Notes, "", "as X9%")}, "s2")));
  EXPECT_EQ(catalogue().sessions_with("X9").value(), std::vector<std::string>{"s2"});
  EXPECT_TRUE(catalogue().sessions_with("P017")->empty()) << "the sessions of this subject";
  ASSERT_TRUE(catalogue().set_corrections(corrections({correction(CorrectedField::Subject, "P017", "P1")}, "s3")));
  EXPECT_EQ(catalogue().sessions_with("P017").value(), std::vector<std::string>{"s3"}) << "the recorded subject ID";
  EXPECT_TRUE(catalogue().sessions_with("%").value() == std::vector<std::string>{"s2"}) << "no pattern";
}

TEST_F(CorrectionsTest, TheTextsOfASessionAreReadWithoutItsTrials) {
  add_session();
  ASSERT_TRUE(catalogue().put_marker({.session_id = "s1", .text = "cough"}));
  ASSERT_TRUE(catalogue().set_corrections(corrections({correction(CorrectedField::Label, "", "eyes closed")})));
  SessionRow expected = catalogue().session("s1").value();
  ASSERT_FALSE(expected.trials.empty() || expected.parts.empty());
  expected.trials.clear();
  expected.parts.clear();
  EXPECT_EQ(catalogue().session_texts("s1").value(), expected);
  EXPECT_EQ(code(catalogue().session_texts("s2")), core::ErrorCode::NotFound);
}

TEST_F(CorrectionsTest, ResultsAreReplacedAsAWhole) {
  add_session();
  ASSERT_TRUE(catalogue().put_result({.session_id = "s1", .name = "old", .value = 1.0, .unit = "1", .details = ""}));
  ASSERT_TRUE(catalogue().set_results("s1", {{.session_id = "s1", .name = "new", .value = 2.0, .unit = "mm", .details = ""}}));
  ASSERT_EQ(catalogue().results("s1")->size(), 1U);
  EXPECT_EQ(catalogue().results("s1")->front().name, "new");
  EXPECT_FALSE(catalogue().set_results("s1", {{.session_id = "s1", .name = "nan", .value = std::nan(""), .unit = "", .details = ""}}));
  EXPECT_EQ(catalogue().results("s1")->front().name, "new") << "nothing or everything";
  const std::vector<ResultRow> bad{{.session_id = "s1", .name = "nan", .value = std::nan(""), .unit = "", .details = ""}};
  EXPECT_FALSE(catalogue().set_corrections(corrections({outcome(1, "done", "rejected")}), bad));
  EXPECT_TRUE(catalogue().session("s1")->corrections.empty()) << "nor corrections";
  EXPECT_EQ(catalogue().results("s1")->front().name, "new");
}

}  // namespace
}  // namespace dts::record
