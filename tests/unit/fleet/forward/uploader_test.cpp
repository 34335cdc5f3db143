// SPDX-License-Identifier: Apache-2.0
// Recordings of a folder to a centre in memory.
#include "fleet/forward/uploader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "fleet/forward/desk.h"
#include "fleet/forward/outbox.h"
#include "support/temporary_folder.h"
#include "unit/fleet/forward/fake_centre.h"
#include "unit/fleet/forward/fake_clinic.h"
#include "unit/fleet/forward/recording_file.h"

namespace dts::fleet::forward {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class UploaderTest : public testing::Test {
 protected:
  /// Adds a session with one recording.
  record::XdfWriter::Closed record(const std::string& session, std::int64_t started_utc_ns, int seconds = 1) {
    auto closed = write_recording(folder_.path() + "/" + session + ".xdf", session, seconds);
    clinic_.add_part(clinic_.add(session, started_utc_ns), closed.file, closed.sha256, closed.bytes);
    return closed;
  }
  void look() {
    Outbox outbox(clinic_, *store_, {}, core::Log());
    ASSERT_TRUE(outbox.look_at_all(1'000'000'000, {}));
  }
  void send_facts() { Desk("kent", centre_, *store_, core::Log()).serve(std::chrono::steady_clock::now(), {}); }
  /// Works until nothing is left to do.
  void work() {
    for (int turn = 0; turn < 100; ++turn) {
      send_facts();
      if (!uploader_.work({})) return;
    }
    FAIL() << "it never ends";
  }

  test::TemporaryFolder folder_;
  FakeClinic clinic_;
  FakeCentre centre_;
  core::SystemClock clock_;
  std::unique_ptr<Store> store_ = Store::open(folder_.path()).value();
  Uploader uploader_{{.clinic = "kent", .rules = {}, .limits = {}}, centre_, *store_, clock_, core::Log()};
};

TEST_F(UploaderTest, Recordings_ArriveOldestFirstAndOnce) {
  record("b", 2);
  record("a", 1, 8);
  look();
  work();
  EXPECT_THAT(centre_.stored, SizeIs(2));
  EXPECT_EQ(store_->backlog().value().files(), 0U);
  std::vector<std::string> order;
  for (const auto& [sha256, offer] : centre_.offers) {
    EXPECT_EQ(centre_.stored.at(sha256).size(), offer.bytes());
    EXPECT_EQ(store_->find(sha256).value().at(0).session, offer.session_id());
  }
  EXPECT_EQ(centre_.received_bytes, centre_.stored.begin()->second.size() + centre_.stored.rbegin()->second.size());
  EXPECT_EQ(uploader_.progress().problem, "");
}

TEST_F(UploaderTest, FactsWithTheChecksum_ArriveBeforeTheFile) {
  record("a", 1);
  look();
  EXPECT_TRUE(uploader_.work({}));  // reads
  EXPECT_FALSE(uploader_.work({}));
  EXPECT_THAT(uploader_.progress().problem, HasSubstr("facts"));
  EXPECT_THAT(centre_.offers, IsEmpty());
  work();
  ASSERT_THAT(centre_.stored, SizeIs(1));
  EXPECT_EQ(wire::hex_of(centre_.facts.back().parts(0).sha256()), centre_.stored.begin()->first);
}

TEST_F(UploaderTest, SentBytes_HaveNoLabelAndTheRecordingStaysAsItIs) {
  const auto closed = record("a", 1);
  struct stat before {};
  ASSERT_EQ(::stat(closed.file.c_str(), &before), 0);
  look();
  work();
  const std::string& bytes = centre_.stored.begin()->second;
  EXPECT_EQ(bytes.size(), closed.bytes);
  EXPECT_THAT(bytes, testing::Not(HasSubstr("Weber")));
  struct stat after {};
  ASSERT_EQ(::stat(closed.file.c_str(), &after), 0);
  EXPECT_EQ(after.st_mtim.tv_nsec, before.st_mtim.tv_nsec);
  EXPECT_EQ(hashes_of(closed.file, {}, {}).value().recorded_sha256, wire::bytes_of_hex(closed.sha256).value());
}

TEST_F(UploaderTest, LostLetters_AreSentAgain) {
  record("a", 1, 60);
  look();
  int chunks = 0;
  centre_.lose = [&chunks](const wire::Subject& subject) {
    if (subject.matter != wire::Matter::Chunk) return false;
    ++chunks;
    return chunks == 3 || chunks == 9;
  };
  work();
  ASSERT_THAT(centre_.stored, SizeIs(1));
  EXPECT_EQ(centre_.stored.begin()->first, record::sha256_of(centre_.stored.begin()->second));
}

TEST_F(UploaderTest, NewConnection_ContinuesAtWhatTheCentreHas) {
  const auto closed = record("a", 1, 60);
  look();
  int chunks = 0;
  centre_.lose = [this, &chunks](const wire::Subject& subject) {
    if (subject.matter == wire::Matter::Chunk && ++chunks == 10) ++centre_.connection;
    return subject.matter == wire::Matter::Chunk && chunks == 10;
  };
  work();
  ASSERT_THAT(centre_.stored, SizeIs(1));
  EXPECT_LT(centre_.received_bytes, closed.bytes + 16 * wire::kLargestChunk);
  EXPECT_EQ(std::ranges::count(centre_.subjects, "dts.v1.kent.up.open"), 2);
}

TEST_F(UploaderTest, CentreThatHasTheFile_GetsNoByte) {
  record("a", 1);
  look();
  work();
  const auto received = centre_.received_bytes;
  store_.reset();
  std::filesystem::remove(folder_.path() + "/sent.sqlite");
  store_ = Store::open(folder_.path()).value();
  Uploader again({.clinic = "kent", .rules = {}, .limits = {}}, centre_, *store_, clock_, core::Log());
  look();
  for (int turn = 0; turn < 5; ++turn) {
    send_facts();
    (void)again.work({});
  }
  EXPECT_EQ(store_->backlog().value().files(), 0U);
  EXPECT_EQ(store_->backlog().value().last_receipt_utc_ns(), 77);
  EXPECT_EQ(centre_.received_bytes, received);
}

TEST_F(UploaderTest, FileThatIsNotWhatDtsdRecorded_IsHeld) {
  const auto closed = record("a", 1);
  std::filesystem::permissions(closed.file, std::filesystem::perms::owner_write, std::filesystem::perm_options::add);
  {
    std::fstream file(closed.file, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(closed.bytes / 2));
    file.put('\x55');
  }
  look();
  work();
  EXPECT_THAT(centre_.offers, IsEmpty());
  EXPECT_EQ(store_->backlog().value().held_files(), 1U);
  EXPECT_THAT(store_->held().value().at(0).why_not, HasSubstr("a.xdf is not what dtsd has recorded"));
}

TEST_F(UploaderTest, FileThatChangesAfterItWasRead_IsHeldAndNotSentForEver) {
  const auto closed = record("a", 1, 8);
  look();
  ASSERT_TRUE(uploader_.work({}));  // reads
  std::filesystem::permissions(closed.file, std::filesystem::perms::owner_write, std::filesystem::perm_options::add);
  {
    std::fstream file(closed.file, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(closed.bytes / 2));
    file.put('\x55');
  }
  work();
  EXPECT_THAT(centre_.stored, IsEmpty());
  EXPECT_EQ(centre_.received_bytes, 2 * closed.bytes);
  EXPECT_EQ(store_->backlog().value().held_files(), 1U);
  EXPECT_THAT(store_->held().value().at(0).why_not, HasSubstr("a.xdf is not what dtsd has recorded"));
}

TEST_F(UploaderTest, FileThatArrivesDamaged_WaitsBeforeItIsSentAgain) {
  record("a", 1);
  look();
  centre_.damage = true;
  work();
  const auto waiting = store_->held().value();
  ASSERT_THAT(waiting, SizeIs(1));
  EXPECT_EQ(waiting[0].state, FileState::Waiting);
  EXPECT_THAT(waiting[0].why_not, HasSubstr("not what was sent"));
  EXPECT_EQ(std::ranges::count(centre_.subjects, "dts.v1.kent.up.hub-1.commit"), 2);
}

TEST_F(UploaderTest, FileThatIsAway_IsTriedAgainLaterAndDoesNotStopTheOthers) {
  const auto away = record("a", 1);
  record("b", 2);
  std::filesystem::rename(away.file, away.file + ".away");
  look();
  work();
  EXPECT_THAT(centre_.stored, SizeIs(1));
  const auto waiting = store_->held().value();
  ASSERT_THAT(waiting, SizeIs(1));
  EXPECT_EQ(waiting[0].session, "a");
  EXPECT_EQ(waiting[0].state, FileState::Waiting);
}

TEST_F(UploaderTest, Refusal_HoldsTheFileWithItsReason) {
  record("a", 1);
  look();
  centre_.open = [](const std::string& /*sha256*/) {
    v1::UploadAnswer answer;
    answer.mutable_refusal()->set_reason("session s is erased");
    return answer;
  };
  work();
  EXPECT_THAT(store_->held().value().at(0).why_not, HasSubstr("session s is erased"));
}

TEST_F(UploaderTest, NoConnection_SendsNothingAndSaysWhy) {
  record("a", 1);
  look();
  work();
  record("b", 2);
  look();
  centre_.is_up = false;
  work();
  EXPECT_THAT(centre_.stored, SizeIs(1));
  EXPECT_THAT(uploader_.progress().problem, HasSubstr("the connection is lost"));
  centre_.is_up = true;
  ++centre_.connection;
  work();
  EXPECT_THAT(centre_.stored, SizeIs(2));
}

TEST_F(UploaderTest, OutsideItsHours_SendsFactsOnly) {
  record("a", 1);
  look();
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  ::localtime_r(&now, &local);
  const std::chrono::minutes time = std::chrono::hours(local.tm_hour) + std::chrono::minutes(local.tm_min);
  const Hours hours{.from = (time + std::chrono::hours(2)) % std::chrono::hours(24),
                    .to = (time + std::chrono::hours(3)) % std::chrono::hours(24)};
  Uploader at_night({.clinic = "kent", .rules = {}, .limits = {.rate = {}, .rate_in_session = {}, .hours = hours}}, centre_, *store_,
                    clock_, core::Log());
  EXPECT_TRUE(at_night.work({}));  // reads
  send_facts();
  EXPECT_FALSE(at_night.work({}));
  EXPECT_THAT(at_night.progress().problem, HasSubstr("only_between"));
  EXPECT_THAT(centre_.offers, IsEmpty());
  EXPECT_THAT(centre_.facts, testing::Not(IsEmpty()));
}

TEST_F(UploaderTest, FileOfAnErasedSession_IsNotSent) {
  record("a", 1);
  look();
  ASSERT_TRUE(uploader_.work({}));
  ASSERT_TRUE(store_->set_erased("a"));
  work();
  EXPECT_THAT(centre_.offers, IsEmpty());
  EXPECT_THAT(centre_.erased, ElementsAre("a"));
  EXPECT_FALSE(store_->next_erased().value());
}

TEST_F(UploaderTest, CentreThatRefusesAnErasure_IsAskedAgain) {
  record("a", 1);
  look();
  ASSERT_TRUE(store_->set_erased("a"));
  v1::EraseAnswer refusal;
  refusal.mutable_refusal()->set_reason("not allowed");
  centre_.erase_answer = refusal.SerializeAsString();
  send_facts();
  EXPECT_EQ(store_->next_erased().value(), "a");
}

TEST_F(UploaderTest, CentreWithoutTime_KeepsTheFactsWaiting) {
  record("a", 1);
  look();
  v1::FactsAnswer later;
  later.mutable_later()->set_reason("PostgreSQL is down");
  later.mutable_later()->set_wait_s(60);
  centre_.facts_answer = later.SerializeAsString();
  Desk desk("kent", centre_, *store_, core::Log());
  const auto now = std::chrono::steady_clock::now();
  desk.serve(now, {});
  EXPECT_THAT(desk.problem(), HasSubstr("PostgreSQL is down"));
  desk.serve(now + std::chrono::seconds(59), {});
  EXPECT_THAT(centre_.facts, SizeIs(1));
  centre_.facts_answer.clear();
  desk.serve(now + std::chrono::seconds(60), {});
  EXPECT_THAT(centre_.facts, SizeIs(2));
  EXPECT_EQ(desk.problem(), "");
  EXPECT_FALSE(store_->next_facts().value());
}

TEST_F(UploaderTest, SessionWhoseFactsFail_DoesNotStopTheOthers) {
  for (const char* session : {"a", "b", "c"}) clinic_.add(session, session[0]);
  look();
  centre_.answer_facts = [](const v1::FleetSession& facts) {
    v1::FactsAnswer answer;
    if (facts.session_id() == "a") return std::string("not an answer");
    answer.set_revision(facts.revision());
    return answer.SerializeAsString();
  };
  Desk desk("kent", centre_, *store_, core::Log());
  const auto now = std::chrono::steady_clock::now();
  desk.serve(now, {});
  desk.serve(now + std::chrono::seconds(1), {});
  EXPECT_EQ(store_->next_facts().value()->session_id(), "a");
  EXPECT_FALSE(store_->next_facts({"a"}).value()) << "b and c have arrived";
  EXPECT_THAT(desk.problem(), HasSubstr("session a"));
  for (int second = 2; second < 600; ++second) desk.serve(now + std::chrono::seconds(second), {});
  EXPECT_GT(std::ranges::count(centre_.facts, "a", &v1::FleetSession::session_id), 4);
  EXPECT_LT(std::ranges::count(centre_.facts, "a", &v1::FleetSession::session_id), 16) << "it waits longer each time";
  centre_.answer_facts = nullptr;
  desk.retry();
  desk.serve(now + std::chrono::seconds(600), {});
  EXPECT_FALSE(store_->next_facts().value());
  EXPECT_EQ(desk.problem(), "");
}

TEST_F(UploaderTest, FactsThatAreTooLarge_AreHeldWithTheReason) {
  clinic_.add("a", 1);
  clinic_.add("b", 2);
  look();
  centre_.reject = [](const link::Letter& letter) -> core::Status {
    if (letter.data.find('a') == 2) return core::fail(core::ErrorCode::LimitExceeded, "2000000 bytes");
    return {};
  };
  send_facts();
  EXPECT_THAT(store_->rejected_facts().value(), ElementsAre(testing::Pair("a", HasSubstr("2000000 bytes"))));
  EXPECT_FALSE(store_->next_facts().value());
  EXPECT_THAT(centre_.facts, SizeIs(1));
}

TEST_F(UploaderTest, CentreWithEverLaterRevisions_MakesNoLoop) {
  clinic_.add("a", 1);
  look();
  centre_.answer_facts = [](const v1::FleetSession& facts) {
    v1::FactsAnswer answer;
    answer.set_revision(facts.revision() + 1);
    return answer.SerializeAsString();
  };
  Desk desk("kent", centre_, *store_, core::Log());
  const auto now = std::chrono::steady_clock::now();
  desk.serve(now, {});
  EXPECT_THAT(centre_.facts, SizeIs(1));
  for (int second = 0; second < 600; ++second) desk.serve(now + std::chrono::seconds(second), {});
  EXPECT_LT(centre_.facts.size(), 16U);
}

TEST_F(UploaderTest, RevisionThatCannotBeIncreased_HoldsTheFacts) {
  clinic_.add("a", 1);
  look();
  v1::FactsAnswer answer;
  answer.set_revision(std::uint64_t{9'223'372'036'854'775'807U});
  centre_.facts_answer = answer.SerializeAsString();
  send_facts();
  EXPECT_THAT(store_->rejected_facts().value(), ElementsAre(testing::Pair("a", HasSubstr("impossible revision"))));
}

TEST_F(UploaderTest, ErasureThatIsRejected_DoesNotStopTheFacts) {
  clinic_.add("a", 1);
  clinic_.add("b", 2);
  look();
  ASSERT_TRUE(store_->set_erased("a"));
  v1::EraseAnswer refusal;
  refusal.mutable_refusal()->set_reason("not allowed");
  centre_.erase_answer = refusal.SerializeAsString();
  Desk desk("kent", centre_, *store_, core::Log());
  desk.serve(std::chrono::steady_clock::now(), {});
  EXPECT_THAT(desk.problem(), HasSubstr("rejected its erasure"));
  EXPECT_FALSE(store_->next_facts().value());
}

TEST_F(UploaderTest, CentreThatAnswersAgain_EndsThePause) {
  record("a", 1);
  look();
  Desk desk("kent", centre_, *store_, core::Log());
  const auto now = std::chrono::steady_clock::now();
  v1::FactsAnswer later;
  later.mutable_later()->set_wait_s(300);
  centre_.facts_answer = later.SerializeAsString();
  desk.serve(now, {});
  centre_.facts_answer.clear();
  desk.serve(now, {});
  EXPECT_TRUE(store_->next_facts().value());
  desk.retry();
  desk.serve(now, {});
  EXPECT_FALSE(store_->next_facts().value());
  int opens = 0;
  centre_.open = [this, &opens](const std::string& /*sha256*/) {
    v1::UploadAnswer answer;
    if (++opens == 1) {
      uploader_.retry();
      answer.mutable_later()->set_wait_s(300);
    } else {
      answer.mutable_refusal()->set_reason("enough");
    }
    return answer;
  };
  work();
  EXPECT_EQ(opens, 2);
}

TEST(Pace, BytesOfASecond_TakeASecond) {
  Pace pace;
  Pace::Time now(std::chrono::seconds(10));
  pace.add(1'000'000, std::nullopt, now);
  EXPECT_TRUE(pace.is_free(now));
  std::size_t sent = 0;
  for (const auto end = now + std::chrono::seconds(60); now < end; now += std::chrono::milliseconds(10)) {
    for (; pace.is_free(now); sent += 10'000) pace.add(10'000, 500'000.0, now);
  }
  EXPECT_NEAR(static_cast<double>(sent), 60 * 500'000.0, 100'000.0);
}

}  // namespace
}  // namespace dts::fleet::forward
