// SPDX-License-Identifier: Apache-2.0
#include "record/catalogue/subject_notes.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "unit/record/catalogue/catalogue_fixture.h"

namespace dts::record {
namespace {

namespace fs = std::filesystem;
using catalogue_test::code;
using catalogue_test::what;

SubjectNotes notes_of(const std::string& subject) {
  return {.subject = subject,
          .next_number = 4,
          .notes = {{.number = 1, .utc_ns = 5, .who = "local:anna", .text = "walks with P018 and a \"stick\""}},
          .plan = {{.number = 3, .utc_ns = 6, .who = "local", .protocol = "romberg", .due_date = "2026-12-31"}}};
}

class SubjectNotesTest : public ::testing::Test {
 protected:
  SubjectNotesTest() { fs::create_directories(folder_); }
  ~SubjectNotesTest() override { fs::remove_all(folder_); }
  [[nodiscard]] std::string file(const std::string& subject) const { return folder_ + "/subjects/" + subject + ".json"; }
  void write(const std::string& text) const {
    fs::create_directories(folder_ + "/subjects");
    std::ofstream(file("P017")) << text;
  }
  [[nodiscard]] std::string text_of(const std::string& subject) const {
    std::ostringstream text;
    text << std::ifstream(file(subject)).rdbuf();
    return text.str();
  }

  std::string folder_ = ::testing::TempDir() + "subject_notes_" + std::to_string(::getpid());
};

TEST_F(SubjectNotesTest, AreReadAsTheyWereWritten) {
  const auto none = read_subject_notes(folder_, "P017");
  ASSERT_TRUE(none) << what(none);
  EXPECT_TRUE(none->is_empty());
  EXPECT_EQ(none->next_number, 1U);

  ASSERT_TRUE(write_subject_notes(folder_, notes_of("P017")));
  ASSERT_TRUE(write_subject_notes(folder_, notes_of("P017.2")));
  const auto read = read_subject_notes(folder_, "P017");
  ASSERT_TRUE(read) << what(read);
  EXPECT_EQ(*read, notes_of("P017"));
  EXPECT_EQ(subjects_with_notes(folder_).value(), (std::vector<std::string>{"P017", "P017.2"}));

  ASSERT_TRUE(remove_subject_notes(folder_, "P017"));
  EXPECT_EQ(subjects_with_notes(folder_).value(), std::vector<std::string>{"P017.2"}) << "a longer ID is another subject";
  ASSERT_TRUE(remove_subject_notes(folder_, "P017")) << "it is gone already";
}

TEST_F(SubjectNotesTest, NumbersOfRemovedEntriesStayUsed) {
  ASSERT_TRUE(write_subject_notes(folder_, notes_of("P017")));
  ASSERT_TRUE(write_subject_notes(folder_, {.subject = "P017", .next_number = 9}));
  EXPECT_EQ(read_subject_notes(folder_, "P017")->next_number, 9U) << "the last entry was removed";
  ASSERT_TRUE(write_subject_notes(folder_, {.subject = "P018"}));
  EXPECT_FALSE(fs::exists(file("P018"))) << "it never had an entry";
}

TEST_F(SubjectNotesTest, AnIdNeverBecomesAPath) {
  EXPECT_EQ(code(write_subject_notes(folder_, notes_of("../P017"))), core::ErrorCode::InvalidArgument);
  EXPECT_EQ(code(write_subject_notes(folder_, notes_of(""))), core::ErrorCode::InvalidArgument);
  EXPECT_TRUE(read_subject_notes(folder_, "../../etc/passwd")->is_empty());
}

TEST_F(SubjectNotesTest, AForeignFileIsRejected) {
  for (const char* text :
       {"", "[]", R"({"subject":"P018","next_number":2,"notes":[],"plan":[]})", R"({"subject":"P017","next_number":2,"notes":[]})",
        R"({"subject":"P017","next_number":-1,"notes":[],"plan":[]})",
        R"({"subject":"P017","next_number":2,"plan":[],"notes":[{"number":2,"utc_ns":1,"who":"a","text":"number is not used yet"}]})",
        R"({"subject":"P017","next_number":2,"plan":[],"notes":[{"number":1,"utc_ns":1,"who":"a","text":"two\nlines"}]})",
        R"({"subject":"P017","next_number":2,"notes":[],"plan":[{"number":1,"utc_ns":1,"who":"a","protocol":"x","due_date":"soon"}]})"}) {
    write(text);
    const auto read = read_subject_notes(folder_, "P017");
    EXPECT_EQ(code(read), core::ErrorCode::DataDamaged) << text;
    EXPECT_NE(what(read).find(file("P017")), std::string::npos) << text;
  }
}

TEST_F(SubjectNotesTest, ADateIsADayOfTheCalendar) {
  for (const char* good : {"2026-12-31", "2028-02-29", "1970-01-01"}) EXPECT_TRUE(is_date(good)) << good;
  for (const char* bad :
       {"", "2026-02-29", "2026-13-01", "2026-00-10", "2026-1-01", "31.12.2026", "2026-12-3x", "+026-12-31", "0026-12-31"})
    EXPECT_FALSE(is_date(bad)) << bad;
}

TEST_F(SubjectNotesTest, AMentionOfAnErasedSubjectIsRemovedFromOthers) {
  ASSERT_TRUE(write_subject_notes(folder_, notes_of("P017")));
  ASSERT_TRUE(remove_mentions_in_notes(folder_, "P018"));
  EXPECT_EQ(text_of("P017").find("P018"), std::string::npos) << text_of("P017");
  EXPECT_EQ(read_subject_notes(folder_, "P017")->notes.front().text, "walks with [erased] and a \"stick\"");
}

TEST_F(SubjectNotesTest, WhatACrashLeftOfAFileIsListedAndRemoved) {
  ASSERT_TRUE(write_subject_notes(folder_, notes_of("P017")));
  std::ofstream(file("P017") + ".new") << "walks";
  std::ofstream(file("P020") + ".new") << "walks with P017";
  EXPECT_EQ(subjects_with_notes(folder_).value(), (std::vector<std::string>{"P017", "P020"}));
  ASSERT_TRUE(remove_subject_notes(folder_, "P017"));
  EXPECT_FALSE(fs::exists(file("P017")));
  EXPECT_FALSE(fs::exists(file("P017") + ".new"));
  EXPECT_EQ(remove_mentions_in_notes(folder_, "P017").value(), std::vector<std::string>{});
  EXPECT_EQ(subjects_with_notes(folder_).value(), std::vector<std::string>{}) << "the other's may mention it";
}

TEST_F(SubjectNotesTest, ADamagedFileOfAnotherSubjectIsReported_AndTheOthersAreCleaned) {
  write("garbage");
  ASSERT_TRUE(write_subject_notes(folder_, notes_of("P019")));
  const auto unread = remove_mentions_in_notes(folder_, "P018");
  ASSERT_TRUE(unread) << what(unread);
  EXPECT_EQ(*unread, std::vector<std::string>{file("P017")});
  EXPECT_EQ(text_of("P019").find("P018"), std::string::npos);
  EXPECT_EQ(text_of("P017"), "garbage");
}

}  // namespace
}  // namespace dts::record
