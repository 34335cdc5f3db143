// SPDX-License-Identifier: Apache-2.0
// A daemon that is killed while it erases a subject: afterwards the subject is either complete or gone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "system/daemon_process.h"

namespace dts::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class EraseTest : public ::testing::Test {
 protected:
  std::string record(const std::string& subject, const std::string& label = "") {
    std::vector<std::string> words{"session", "start", "--rig", "floor", "--protocol", "free", "--subject", subject};
    if (!label.empty()) words.insert(words.end(), {"--label", label});
    const Finished started = daemon_.ctl(words);
    EXPECT_EQ(started.status, 0) << started.err;
    EXPECT_TRUE(eventually([&] {
      const auto status = daemon_.control().status();
      return status && status->rigs(0).session().state() == v1::SESSION_STATE_RUNNING;
    }));
    EXPECT_EQ(daemon_.ctl({"session", "stop"}).status, 0);
    return started.out.substr(0, started.out.find('\n'));
  }
  [[nodiscard]] std::set<std::string> listed() const {
    std::set<std::string> ids;
    const auto list = json::parse(daemon_.ctl({"session", "list", "--json"}).out);
    for (const json& session : list["sessions"]) ids.insert(session["session_id"]);
    return ids;
  }
  /// The sessions that have a file.
  [[nodiscard]] std::set<std::string> on_disk() const {
    std::set<std::string> ids;
    for (const auto& entry : std::filesystem::directory_iterator(daemon_.state_directory() / "sessions")) {
      const std::string name = entry.path().filename();
      ids.insert(name.substr(0, name.find('.')));
    }
    return ids;
  }
  [[nodiscard]] bool has_journal() const { return std::filesystem::exists(daemon_.state_directory() / "erasure.json"); }
  /// Neither in recordings, corrections and the catalogue, nor in its log.
  void expect_nowhere(const std::string& text) const {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(daemon_.state_directory())) {
      if (!entry.is_regular_file()) continue;
      EXPECT_EQ(read_file(entry.path()).find(text), std::string::npos) << entry.path();
    }
  }
  [[nodiscard]] std::ptrdiff_t entered_erasures() {
    const auto audit = daemon_.control().audit(1000);
    EXPECT_TRUE(audit);
    if (!audit) return -1;
    return std::ranges::count_if(audit->entries(),
                                 [](const auto& entry) { return entry.what() == "erase_subject" && entry.result() == "ok"; });
  }
  void kill_and_restart() {
    daemon_.signal(SIGKILL);
    static_cast<void>(daemon_.wait());
    daemon_.restart();
    ASSERT_TRUE(daemon_.is_ready()) << daemon_.log();
  }

  DaemonProcess daemon_;
};

/// The whole program, killed at once and killed when the erasure is on the disk. fault_recording kills a part of it at every call to the
/// disk.
TEST_F(EraseTest, Killed_TheSubjectIsCompleteOrGone) {
  const std::string other = record("P018");
  std::ptrdiff_t gone = 0;
  std::ptrdiff_t erased = 0;
  for (const bool has_begun : {false, true}) {
    const std::set<std::string> ours{record("P017"), record("P017")};
    EXPECT_EQ(daemon_.ctl({"session", "edit", other, "--notes", "confused with P017", "--reason", has_begun ? "a" : "b"}).status, 0);
    std::thread client([this] { static_cast<void>(daemon_.ctl({"subject", "erase", "P017", "--yes", "--timeout", "1"})); });
    if (has_begun) {
      EXPECT_TRUE(eventually([this, &ours] { return has_journal() || on_disk().count(*ours.begin()) == 0; }));
    }
    kill_and_restart();
    client.join();

    EXPECT_TRUE(eventually([this] { return !has_journal(); }));
    std::set<std::string> expected{other};
    const bool is_gone = on_disk() == expected;
    gone += is_gone ? 1 : 0;
    if (!is_gone) expected.insert(ours.begin(), ours.end());
    EXPECT_EQ(on_disk(), expected);
    EXPECT_EQ(listed(), expected);
    const auto audit = daemon_.control().audit();
    ASSERT_TRUE(audit);
    EXPECT_EQ(audit->problem(), "");
    if (!is_gone) {
      EXPECT_EQ(daemon_.ctl({"subject", "erase", "P017", "--yes"}).status, 0);
    }
    expect_nowhere("P017");
    EXPECT_EQ(entered_erasures(), ++erased);
  }
  EXPECT_GT(gone, 0) << "the daemon completes what it has begun";
}

TEST_F(EraseTest, WhatIsErasedIsNowhereInTheStateFolder) {
  RecordProperty("requirement", "SES-10");
  const std::string id = record("SUBJECTXYZ", "eyes closed");
  const std::string other = record("P018");
  EXPECT_EQ(daemon_.ctl({"session", "edit", other, "--notes", "SUBJECTXYZ was meant", "--reason", "note"}).status, 0);
  EXPECT_EQ(daemon_.ctl({"subject", "erase", "SUBJECTXYZ"}).status, 2) << "nobody can be asked";
  EXPECT_EQ(listed().size(), 2U);
  const Finished erased = daemon_.ctl({"subject", "erase", "SUBJECTXYZ", "--yes"});
  ASSERT_EQ(erased.status, 0) << erased.err;
  EXPECT_THAT(erased.out, HasSubstr("erased: 1 session, 2 files"));
  EXPECT_THAT(erased.out, HasSubstr("backups: "));
  expect_nowhere("SUBJECTXYZ");
  EXPECT_EQ(daemon_.log().find("SUBJECTXYZ"), std::string::npos);
  EXPECT_EQ(daemon_.ctl({"status", "--json"}).out.find("SUBJECTXYZ"), std::string::npos);
  EXPECT_EQ(daemon_.ctl({"subject", "show", "SUBJECTXYZ"}).status, 5);
  const Finished audit = daemon_.ctl({"audit"});
  EXPECT_EQ(audit.status, 0);
  EXPECT_THAT(audit.out, HasSubstr("erase_subject"));
  EXPECT_EQ(audit.out.find("SUBJECTXYZ"), std::string::npos);
}

TEST_F(EraseTest, CorrectedValuesAreInListShowExportAndReport) {
  RecordProperty("requirement", "SES-9");
  EXPECT_EQ(daemon_.ctl({"session", "start", "--rig", "floor", "--protocol", "free", "--label", "Anna Schmidt, born 1950"}).status, 2);
  const std::string id = record("P071", "Baseline 2");
  EXPECT_EQ(daemon_.ctl({"session", "edit", id, "--subject", "P017", "--reason", "=cmd|' /C calc'!A0"}).status, 2) << "no words";
  EXPECT_EQ(daemon_.ctl({"session", "edit", id, "--subject", "P017", "--reason", "confused with Anna Schmidt"}).status, 2);
  EXPECT_EQ(daemon_.ctl({"session", "edit", id, "--notes", "Anna Schmidt, born 1950", "--reason", "note"}).status, 2);
  EXPECT_EQ(daemon_.ctl({"session", "edit", id, "--subject", "P017", "--reason", "typing error"}).status, 0);
  EXPECT_EQ(daemon_.ctl({"session", "edit", id, "--subject", "P017", "--reason", "again"}).status, 2) << "nothing to correct";
  EXPECT_EQ(daemon_.ctl({"session", "edit", id, "--reason", "nothing"}).status, 2);
  EXPECT_EQ(daemon_.ctl({"session", "edit", id, "--subject", "P017"}).status, 2) << "no reason";
  EXPECT_EQ(daemon_.ctl({"session", "edit", "none", "--subject", "P017", "--reason", "r"}).status, 5);
  const auto shown = json::parse(daemon_.ctl({"session", "show", id, "--json"}).out);
  EXPECT_EQ(shown["subject"], "P017");
  EXPECT_EQ(shown["corrections"][0]["old_value"], "P071");
  EXPECT_THAT(daemon_.ctl({"session", "list"}).out, HasSubstr("complete, corrected"));
  EXPECT_THAT(daemon_.ctl({"session", "show", id}).out, HasSubstr("subject ID: P071 -> P017"));
  const std::string folder = daemon_.directory() / "csv";
  ASSERT_EQ(daemon_.ctl({"session", "export", id, "--format", "csv", "--out", folder}).status, 0);
  const auto document = json::parse(read_file(folder + "/" + id + "_recording.json"));
  EXPECT_EQ(document["subject"], "P017");
  EXPECT_EQ(document["recorded_subject"], "P071");
  EXPECT_EQ(document["corrections"][0]["old_value"], "P071");
  ASSERT_EQ(daemon_.ctl({"session", "export", id, "--format", "bids", "--out", daemon_.directory() / "bids"}).status, 0);
  EXPECT_TRUE(std::filesystem::exists(daemon_.directory() / "bids" / "sub-P017"));
  ASSERT_EQ(daemon_.ctl({"report", id, "--format", "html", "--out", daemon_.directory() / "report"}).status, 0);
  EXPECT_THAT(read_file(daemon_.directory() / "report" / "session.html"), HasSubstr("P017 (corrected; recorded: P071)"));
  EXPECT_EQ(daemon_.ctl({"session", "delete", id, "--reason", "a test"}).status, 0);
  EXPECT_TRUE(listed().empty());
  EXPECT_THAT(daemon_.ctl({"session", "list", "--deleted"}).out, HasSubstr(id));
  EXPECT_EQ(daemon_.ctl({"report", id, "--out", daemon_.directory() / "report"}).status, 6);
  EXPECT_EQ(daemon_.ctl({"session", "restore", id}).status, 0);
  EXPECT_EQ(listed().size(), 1U);
}

}  // namespace
}  // namespace dts::test
