// SPDX-License-Identifier: Apache-2.0
// With a real PostgreSQL.
#include "fleet/hub/erasures.h"

#include <filesystem>

#include "unit/fleet/hub/hub_fixture.h"

namespace dts::fleet::hub {
namespace {

/// A bucket whose server does not answer.
class AwayStore final : public Store {
 public:
  AwayStore() : Store("") {}
  [[nodiscard]] core::Status put(const RecordingName& /*name*/, const std::string& /*file*/) override { return away(); }
  [[nodiscard]] core::Result<bool> has(const RecordingName& /*name*/) const override { return away(); }
  [[nodiscard]] core::Result<std::optional<LocalFile>> file(const RecordingName& /*name*/) const override { return away(); }
  [[nodiscard]] core::Result<bool> remove(const RecordingName& /*name*/) override {
    ++asked;
    return away();
  }
  [[nodiscard]] core::Result<std::vector<RecordingName>> list() const override { return away(); }

  int asked = 0;

 private:
  static tl::unexpected<core::Error> away() { return core::fail(core::ErrorCode::Unreachable, "away"); }
};

class ErasuresTest : public DatabaseTest {
 protected:
  void SetUp() override {
    DatabaseTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    store_ = open_folder_store(folder_.path()).value();
    erasures_ = std::make_unique<Erasures>(*catalogue_, *store_, journal_);
  }
  /// Enters a session with a recording.
  void enter(const std::string& session) {
    ASSERT_TRUE(catalogue_->put_session("kent", session_of(session, 1)));
    const std::string bytes = "recording of " + session;
    const RecordingName name{"kent", sum_of(bytes)};
    std::ofstream(folder_.path() + "/whole", std::ios::binary) << bytes;
    ASSERT_TRUE(store_->put(name, folder_.path() + "/whole"));
    v1::UploadOffer offer;
    offer.set_sha256(name.sha256);
    offer.set_bytes(bytes.size());
    offer.set_session_id(session);
    offer.set_part(1);
    ASSERT_TRUE(catalogue_->put_recording(name, offer, *store_, "hub-1", 1));
  }
  [[nodiscard]] bool has_file(const std::string& session) const {
    return store_->file({"kent", sum_of("recording of " + session)}).value().has_value();
  }
  [[nodiscard]] std::string journal_text() const { return content_of(folder_.path() + "/erased"); }

  test::TemporaryFolder folder_;
  ErasureJournal journal_{folder_.path()};
  std::unique_ptr<Store> store_;
  std::unique_ptr<Erasures> erasures_;
};

TEST_F(ErasuresTest, Erase_RemovesRowsAndFiles_AndIsWrittenOnce) {
  enter("s1");
  enter("s2");
  EXPECT_EQ(erasures_->erase({"kent", "s1"}, "local:anna", 1), 1U);
  EXPECT_EQ(erasures_->erase({"kent", "s1"}, "local:anna", 1), 0U);
  EXPECT_FALSE(has_file("s1"));
  EXPECT_TRUE(has_file("s2"));
  EXPECT_EQ(value("SELECT string_agg(id, ',') FROM session"), "s2");
  EXPECT_EQ(value("SELECT concat_ws('|', who, what, target) FROM audit"), "local:anna|erase_session|kent/s1");
  EXPECT_EQ(journal_text(), "\nkent s1 erased\n");
}

TEST_F(ErasuresTest, Journal_IsWrittenBeforeTheRowsAreRemoved) {
  enter("s1");
  ASSERT_TRUE(database_->run_script("ALTER TABLE job RENAME TO away"));
  EXPECT_FALSE(erasures_->erase({"kent", "s1"}, "clinic:kent", 1));
  EXPECT_EQ(value("SELECT count(*) FROM session"), "1");
  EXPECT_EQ(journal_.read().value(), (std::set<SessionName>{{"kent", "s1"}}));
}

TEST_F(ErasuresTest, WithoutTheJournal_NothingIsErased) {
  enter("s1");
  std::filesystem::create_directory(folder_.path() + "/erased");
  const auto erased = erasures_->erase({"kent", "s1"}, "clinic:kent", 1);
  ASSERT_FALSE(erased);
  EXPECT_NE(erased.error().what.find("Is a directory"), std::string::npos) << erased.error().what;
  EXPECT_TRUE(has_file("s1"));
  EXPECT_EQ(value("SELECT count(*) FROM session"), "1");
}

TEST_F(ErasuresTest, Reconcile_ErasesWhatAnOlderDatabaseBringsBack) {
  ASSERT_TRUE(journal_.add({"kent", "s1"}));
  enter("s1");
  enter("s2");
  EXPECT_EQ(erasures_->reconcile(1), 1U);
  EXPECT_EQ(erasures_->remove_left(""), 1U);
  EXPECT_FALSE(has_file("s1"));
  EXPECT_EQ(value("SELECT string_agg(id, ',') FROM session"), "s2");
  EXPECT_EQ(value("SELECT who FROM audit"), "journal");
  EXPECT_EQ(erasures_->reconcile(1), 0U);
}

TEST_F(ErasuresTest, Reconcile_CompletesALostJournal) {
  ASSERT_TRUE(erasures_->erase({"kent", "s1"}, "clinic:kent", 1));
  std::filesystem::remove(folder_.path() + "/erased");
  EXPECT_EQ(erasures_->reconcile(1), 0U);
  EXPECT_EQ(journal_.read().value(), (std::set<SessionName>{{"kent", "s1"}}));
}

TEST_F(ErasuresTest, Create_MakesAnEmptyJournal_AndKeepsAnOldOne) {
  ASSERT_TRUE(journal_.create());
  EXPECT_TRUE(std::filesystem::exists(folder_.path() + "/erased"));
  EXPECT_EQ(journal_text(), "");
  ASSERT_TRUE(journal_.add({"kent", "s1"}));
  ASSERT_TRUE(journal_.create());
  EXPECT_EQ(journal_text(), "\nkent s1 erased\n");
}

TEST_F(ErasuresTest, TornLine_IsSkipped_AndTheNextIsWhole) {
  EXPECT_EQ(journal_.read()->size(), 0U);
  ASSERT_TRUE(journal_.add({"kent", "s1"}));
  std::ofstream(folder_.path() + "/erased", std::ios::app) << "\nkent 2026112";
  ASSERT_TRUE(journal_.add({"leeds", "s2"}));
  std::ofstream(folder_.path() + "/erased", std::ios::app) << "\nKent/.. s3 erased\nkent s4";
  EXPECT_EQ(journal_.read().value(), (std::set<SessionName>{{"kent", "s1"}, {"leeds", "s2"}}));
}

TEST_F(ErasuresTest, RecordingThatCannotBeRemoved_DoesNotStopTheOthers) {
  // A folder in the place of the recording cannot be unlinked.
  std::filesystem::create_directories(folder_.path() + "/" + key_of({"kent", sum_of("a")}));
  ASSERT_TRUE(database_->run("INSERT INTO erased_file VALUES ('kent', sha256('a'))"));
  enter("s1");
  ASSERT_TRUE(catalogue_->erase_session({"kent", "s1"}, "clinic:kent", 1));
  EXPECT_FALSE(erasures_->remove_left(""));
  EXPECT_FALSE(has_file("s1"));
  EXPECT_EQ(value("SELECT count(*) FROM erased_file"), "1");
}

TEST_F(ErasuresTest, StoreThatIsAway_IsAskedOnce) {
  for (const std::string session : {"s1", "s2", "s3"}) {
    enter(session);
    ASSERT_TRUE(catalogue_->erase_session({"kent", session}, "clinic:kent", 1));
  }
  AwayStore away;
  EXPECT_EQ(Erasures(*catalogue_, away, journal_).remove_left("").error().code, core::ErrorCode::Unreachable);
  EXPECT_EQ(away.asked, 1);
  EXPECT_EQ(erasures_->remove_left(""), 3U);
}

TEST_F(ErasuresTest, QuotaOfErasures_RejectsNewOnes_ButNoRepetition) {
  QuotaFigures quota;
  quota.erased_sessions = 1;
  Catalogue limited(*database_, quota);
  Erasures erasures(limited, *store_, journal_);
  ASSERT_TRUE(erasures.erase({"kent", "s1"}, "clinic:kent", 1));
  EXPECT_EQ(erasures.erase({"kent", "s2"}, "clinic:kent", 1).error().code, core::ErrorCode::WrongState);
  EXPECT_TRUE(erasures.erase({"kent", "s1"}, "clinic:kent", 1));
  EXPECT_TRUE(erasures.erase({"leeds", "s2"}, "clinic:leeds", 1));
  EXPECT_EQ(journal_.read()->size(), 2U);
}

}  // namespace
}  // namespace dts::fleet::hub
