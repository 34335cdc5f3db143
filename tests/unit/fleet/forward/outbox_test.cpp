// SPDX-License-Identifier: Apache-2.0
// dtsd's sessions in, facts, files and erasures out.
#include "fleet/forward/outbox.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "fleet/wire/messages.h"
#include "support/committed_text.h"
#include "support/temporary_folder.h"
#include "unit/fleet/forward/fake_clinic.h"

namespace dts::fleet::forward {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::int64_t kS = 1'000'000'000;
constexpr std::int64_t kNow = 1'800'000'000 * kS;

class OutboxTest : public testing::Test {
 protected:
  void SetUp() override {
    open();
    clinic_.add_entry(kNow - 3600 * kS, "start_session");
  }
  void open() {
    store_.reset();
    store_ = Store::open(folder_.path()).value();
    outbox_ = std::make_unique<Outbox>(clinic_, *store_, wire::SendRules{}, core::Log());
  }
  static std::string sha(char letter) { return std::string(64, letter); }
  void look_at_all(std::int64_t utc_ns = kNow) { ASSERT_TRUE(outbox_->look_at_all(utc_ns, {})); }
  /// Answers all facts as the centre does; returns the sessions in the order in which they were sent.
  std::vector<std::string> send_facts() {
    std::vector<std::string> sent;
    for (auto facts = store_->next_facts().value(); facts; facts = store_->next_facts().value()) {
      sent.push_back(facts->session_id());
      EXPECT_TRUE(store_->facts_answered(*facts, facts->revision()));
    }
    return sent;
  }
  static Hashes hashes(char recorded, char sent) {
    return {
        .recorded_sha256 = wire::bytes_of_hex(sha(recorded)).value(), .sent_sha256 = wire::bytes_of_hex(sha(sent)).value(), .bytes = 100};
  }
  /// Adds an erasure at `utc_ns` to the audit trail, which reaches back.
  void enter_erasure(std::int64_t utc_ns, const std::string& count = "1 session") {
    clinic_.add_entry(utc_ns, "erase_subject", "ok", count);
  }

  test::TemporaryFolder folder_;
  FakeClinic clinic_;
  std::unique_ptr<Store> store_;
  std::unique_ptr<Outbox> outbox_;
};

TEST_F(OutboxTest, NewSessions_SendTheirFactsOldestFirst) {
  clinic_.add("b", 2 * kS);
  clinic_.add("a", 1 * kS);
  look_at_all();
  const auto facts = store_->next_facts().value();
  ASSERT_TRUE(facts);
  EXPECT_EQ(facts->session_id(), "a");
  EXPECT_EQ(facts->subject(), "P017");
  EXPECT_EQ(facts->revision(), static_cast<std::uint64_t>(kNow / 1'000'000));
  EXPECT_FALSE(facts->has_label());
  EXPECT_THAT(send_facts(), ElementsAre("a", "b"));
}

TEST_F(OutboxTest, UnchangedSession_IsAskedForOnce) {
  clinic_.add("a", kS);
  look_at_all();
  look_at_all();
  EXPECT_THAT(clinic_.shown, ElementsAre("a"));
}

TEST_F(OutboxTest, ChangedSession_SendsItsFactsWithALargerRevision) {
  clinic_.add("a", kS);
  look_at_all();
  const auto first = store_->next_facts().value()->revision();
  send_facts();
  clinic_.sessions[0].set_subject("P018");
  look_at_all(kNow - 60 * kS);  // the clock was set back
  const auto facts = store_->next_facts().value();
  EXPECT_EQ(facts->subject(), "P018");
  EXPECT_EQ(facts->revision(), first + 1);
}

TEST_F(OutboxTest, ChangeThatDoesNotLeaveTheClinic_SendsNothing) {
  clinic_.add("a", kS);
  look_at_all();
  send_facts();
  clinic_.sessions[0].set_label("Herr Weber");
  look_at_all();
  EXPECT_THAT(send_facts(), IsEmpty());
}

TEST_F(OutboxTest, CentreWithALargerRevision_GetsTheNext) {
  clinic_.add("a", kS);
  look_at_all();
  const auto facts = store_->next_facts().value();
  const std::uint64_t of_the_centre = facts->revision() + 1'000'000;
  ASSERT_TRUE(store_->facts_answered(*facts, of_the_centre));
  const auto again = store_->next_facts().value();
  ASSERT_TRUE(again);
  EXPECT_EQ(again->revision(), of_the_centre + 1);
  EXPECT_EQ(again->subject(), "P017");
  ASSERT_TRUE(store_->facts_answered(*again, again->revision()));
  EXPECT_FALSE(store_->next_facts().value());
}

TEST_F(OutboxTest, RefusedFacts_AreNotSentAgainUntilTheyChange) {
  clinic_.add("a", kS);
  look_at_all();
  ASSERT_TRUE(store_->facts_rejected(*store_->next_facts().value(), "state is invalid"));
  EXPECT_FALSE(store_->next_facts().value());
  EXPECT_THAT(store_->rejected_facts().value(), ElementsAre(testing::Pair("a", "state is invalid")));
  clinic_.sessions[0].set_subject("P018");
  look_at_all();
  EXPECT_TRUE(store_->next_facts().value());
}

TEST_F(OutboxTest, OnlyClosedParts_AreSent) {
  auto& session = clinic_.add("a", kS);
  clinic_.add_part(session, "/1.xdf", sha('1'), 100);
  clinic_.add_part(session, "/2.xdf", sha('2'), 100, v1::PART_STATE_INCOMPLETE);
  clinic_.add_part(session, "/3.xdf", sha('3'), 100, v1::PART_STATE_RECOVERED);
  clinic_.add_part(session, "/4.xdf", sha('4'), 100, v1::PART_STATE_INTERRUPTED);
  clinic_.add_part(session, "/5.xdf", sha('5'), 100, v1::PART_STATE_MISSING);
  clinic_.add_part(session, "/6.xdf", "", 100, v1::PART_STATE_RECORDING);
  clinic_.add_part(session, "/7.xdf", "short", 100);
  look_at_all();
  EXPECT_EQ(store_->backlog().value().files(), 3U);
  EXPECT_EQ(store_->backlog().value().bytes(), 300U);
  EXPECT_EQ(store_->backlog().value().oldest_utc_ns(), kS);
}

TEST_F(OutboxTest, AHeldFile_IsNotTheOldestToSend) {
  clinic_.add_part(clinic_.add("a", kS), "/a.xdf", sha('a'), 100);
  look_at_all();
  ASSERT_TRUE(store_->hold(*store_->next_file(2 * kS).value(), "the centre has erased this session"));
  EXPECT_EQ(store_->backlog().value().held_files(), 1U);
  EXPECT_EQ(store_->backlog().value().oldest_utc_ns(), 0);
}

TEST_F(OutboxTest, OldestFile_IsSentFirstAndPostponedOnesLater) {
  clinic_.add_part(clinic_.add("b", 2 * kS), "/b.xdf", sha('b'), 100);
  clinic_.add_part(clinic_.add("a", 1 * kS), "/a.xdf", sha('a'), 100);
  look_at_all();
  const auto first = store_->next_file(kNow).value();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->file, "/a.xdf");
  EXPECT_EQ(first->sent_sha256, "");
  EXPECT_FALSE(first->is_session_sent);
  ASSERT_TRUE(store_->postpone(*first, kNow + kS, "cannot be read"));
  EXPECT_EQ(store_->next_file(kNow).value()->file, "/b.xdf");
  EXPECT_EQ(store_->next_file(kNow + kS).value()->file, "/a.xdf");
}

TEST_F(OutboxTest, FileWithoutItsFactsAtTheCentre_HoldsUpNoOther) {
  clinic_.add_part(clinic_.add("a", 1 * kS), "/a.xdf", sha('a'), 100);
  clinic_.add_part(clinic_.add("b", 2 * kS), "/b.xdf", sha('b'), 100);
  look_at_all();
  const auto facts = store_->next_facts({"a"}).value();
  ASSERT_TRUE(facts);
  ASSERT_TRUE(store_->facts_answered(*facts, facts->revision()));
  EXPECT_EQ(store_->next_file(kNow).value()->file, "/b.xdf");
  send_facts();
  EXPECT_EQ(store_->next_file(kNow).value()->file, "/a.xdf");
}

TEST_F(OutboxTest, ChecksumOfSentBytes_IsAddedToTheFactsBeforeTheFileIsSent) {
  clinic_.add_part(clinic_.add("a", kS), "/a.xdf", sha('a'), 100);
  look_at_all();
  const auto facts = store_->next_facts().value();
  EXPECT_EQ(facts->parts(0).sha256(), "");
  EXPECT_EQ(wire::hex_of(facts->parts(0).recorded_sha256()), sha('a'));
  send_facts();
  EXPECT_TRUE(store_->next_file(kNow).value()->is_session_sent);
  ASSERT_TRUE(store_->set_sent_sha256(*store_->next_file(kNow).value(), hashes('a', 'c'), kNow));
  EXPECT_FALSE(store_->next_file(kNow).value()->is_session_sent);
  const auto again = store_->next_facts().value();
  ASSERT_TRUE(again);
  EXPECT_GT(again->revision(), facts->revision());
  EXPECT_EQ(wire::hex_of(again->parts(0).sha256()), sha('c'));
  send_facts();
  EXPECT_TRUE(store_->next_file(kNow).value()->is_session_sent);
  EXPECT_EQ(store_->next_file(kNow).value()->sent_sha256, sha('c'));
}

TEST_F(OutboxTest, Receipt_IsFoundByBothChecksums) {
  clinic_.add_part(clinic_.add("a", kS), "/a.xdf", sha('a'), 100);
  look_at_all();
  const auto file = *store_->next_file(kNow).value();
  ASSERT_TRUE(store_->set_sent_sha256(file, hashes('a', 'c'), kNow));
  EXPECT_EQ(store_->find(sha('a')).value().at(0).state, FileState::Waiting);
  v1::Receipt receipt;
  receipt.set_stored_utc_ns(kNow);
  receipt.set_hub("hub-1");
  ASSERT_TRUE(store_->set_stored(file, receipt));
  for (const char letter : {'a', 'c'}) {
    const auto found = store_->find(sha(letter)).value();
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].state, FileState::Stored);
    EXPECT_EQ(found[0].receipt_utc_ns, kNow);
  }
  EXPECT_THAT(store_->find(sha('b')).value(), IsEmpty());
  EXPECT_EQ(store_->backlog().value().files(), 0U);
  EXPECT_EQ(store_->backlog().value().last_receipt_utc_ns(), kNow);
  open();
  look_at_all();
  EXPECT_FALSE(store_->next_file(kNow).value());
}

TEST_F(OutboxTest, RepairedRecording_ReplacesTheOneThatWaited) {
  auto& session = clinic_.add("a", kS);
  clinic_.add_part(session, "/a.xdf", sha('a'), 100, v1::PART_STATE_INCOMPLETE);
  look_at_all();
  const auto old = *store_->next_file(kNow).value();
  session.mutable_parts(0)->set_sha256(sha('b'));
  session.mutable_parts(0)->set_state(v1::PART_STATE_RECOVERED);
  look_at_all();
  EXPECT_FALSE(store_->is_wanted(old).value());
  EXPECT_EQ(store_->backlog().value().files(), 1U);
  EXPECT_EQ(store_->next_file(kNow).value()->recorded_sha256, sha('b'));
}

TEST_F(OutboxTest, HeldFile_IsCountedAndTriedAgainAtTheNextStart) {
  clinic_.add_part(clinic_.add("a", kS), "/a.xdf", sha('a'), 100);
  look_at_all();
  ASSERT_TRUE(store_->hold(*store_->next_file(kNow).value(), "its SHA-256 differs"));
  EXPECT_FALSE(store_->next_file(kNow).value());
  EXPECT_EQ(store_->backlog().value().held_files(), 1U);
  EXPECT_EQ(store_->held().value().at(0).why_not, "its SHA-256 differs");
  ASSERT_TRUE(store_->retry_held());
  EXPECT_TRUE(store_->next_file(kNow).value());
}

TEST_F(OutboxTest, OtherRules_SendFactsAndReadFilesAgain) {
  ASSERT_TRUE(store_->set_rules({}));
  clinic_.add_part(clinic_.add("a", kS), "/a.xdf", sha('a'), 100);
  look_at_all();
  ASSERT_TRUE(store_->set_sent_sha256(*store_->next_file(kNow).value(), hashes('a', 'c'), kNow));
  send_facts();
  ASSERT_TRUE(store_->set_rules({}));
  EXPECT_EQ(store_->next_file(kNow).value()->sent_sha256, sha('c'));
  ASSERT_TRUE(store_->set_rules({.labels = true}));
  EXPECT_EQ(store_->next_file(kNow).value()->sent_sha256, "");
  outbox_ = std::make_unique<Outbox>(clinic_, *store_, wire::SendRules{.labels = true}, core::Log());
  look_at_all();
  EXPECT_EQ(store_->next_facts().value()->label(), "Frau Weber");
}

TEST_F(OutboxTest, TighterRules_TakeBackFactsThatWait) {
  ASSERT_TRUE(store_->set_rules({.labels = true}));
  outbox_ = std::make_unique<Outbox>(clinic_, *store_, wire::SendRules{.labels = true}, core::Log());
  clinic_.add("a", kS);
  look_at_all();
  ASSERT_EQ(store_->next_facts().value()->label(), "Frau Weber");
  ASSERT_TRUE(store_->set_rules({}));
  EXPECT_FALSE(store_->next_facts().value()) << "until dtsd has listed the session again";
  outbox_ = std::make_unique<Outbox>(clinic_, *store_, wire::SendRules{}, core::Log());
  look_at_all();
  EXPECT_FALSE(store_->next_facts().value()->has_label());
}

TEST_F(OutboxTest, AnotherCentreOrName_GetsEverythingAgain) {
  ASSERT_TRUE(store_->set_centre("kent", "authority"));
  clinic_.add_part(clinic_.add("a", kS), "/a.xdf", sha('a'), 100);
  look_at_all();
  ASSERT_TRUE(store_->set_sent_sha256(*store_->next_file(kNow).value(), hashes('a', 'c'), kNow));
  send_facts();
  v1::Receipt receipt;
  receipt.set_stored_utc_ns(kNow);
  ASSERT_TRUE(store_->set_stored(*store_->next_file(kNow).value(), receipt));
  ASSERT_TRUE(store_->set_centre("kent", "authority"));
  EXPECT_FALSE(store_->next_file(kNow).value());
  EXPECT_FALSE(store_->next_facts().value());
  ASSERT_TRUE(store_->set_centre("kent-2", "authority"));
  look_at_all();
  send_facts();
  const auto file = store_->next_file(kNow).value();
  ASSERT_TRUE(file);
  EXPECT_TRUE(file->is_session_sent);
  EXPECT_EQ(file->receipt_utc_ns, 0);
  EXPECT_EQ(store_->backlog().value().last_receipt_utc_ns(), 0);
}

TEST_F(OutboxTest, OfferAgain_OffersEverythingAndRepeatsErasures) {
  clinic_.add_part(clinic_.add("a", kS), "/a.xdf", sha('a'), 100);
  for (const char* gone : {"b", "c"}) clinic_.add_part(clinic_.add(gone, 2 * kS), std::string("/") + gone + ".xdf", sha(*gone), 100);
  look_at_all();
  ASSERT_TRUE(store_->set_sent_sha256(*store_->next_file(kNow).value(), hashes('a', 'd'), kNow));
  send_facts();
  v1::Receipt receipt;
  receipt.set_stored_utc_ns(kNow);
  ASSERT_TRUE(store_->set_stored(*store_->next_file(kNow).value(), receipt));
  clinic_.sessions.resize(1);
  enter_erasure(kNow + 30 * kS, "2 sessions");
  look_at_all(kNow + 60 * kS);
  ASSERT_TRUE(store_->erasure_answered("b"));  // that of c waits
  ASSERT_TRUE(store_->offer_again());
  EXPECT_EQ(store_->next_erased({"b"}).value(), "c");
  EXPECT_EQ(store_->next_erased({"c"}).value(), "b");
  look_at_all(kNow + 120 * kS);
  EXPECT_THAT(send_facts(), ElementsAre("a"));
  const auto file = store_->next_file(kNow + 120 * kS).value();
  ASSERT_TRUE(file);
  EXPECT_EQ(file->session, "a");
  EXPECT_EQ(file->receipt_utc_ns, 0);
  EXPECT_TRUE(file->is_session_sent);
  EXPECT_EQ(store_->backlog().value().files(), 2U) << "those of a, and of c, whose erasure waits";
  ASSERT_TRUE(store_->erasure_answered("b"));
  ASSERT_TRUE(store_->erasure_answered("c"));
  EXPECT_FALSE(store_->next_erased().value());
  look_at_all(kNow + 180 * kS);
  EXPECT_FALSE(store_->next_erased().value());
  EXPECT_EQ(store_->backlog().value().files(), 1U);
}

TEST_F(OutboxTest, DeletedSession_IsToldAndNotErased) {
  clinic_.add("a", kS);
  look_at_all();
  send_facts();
  clinic_.sessions[0].set_is_deleted(true);
  enter_erasure(kNow + 30 * kS);
  look_at_all(kNow + 60 * kS);
  EXPECT_TRUE(store_->next_facts().value()->is_deleted());
  EXPECT_FALSE(store_->next_erased().value());
}

TEST_F(OutboxTest, ErasedSession_IsErasedAtTheCentreAndItsFilesAreNotSent) {
  RecordProperty("requirement", "FLEET-3");
  clinic_.add_part(clinic_.add("a", kS), "/a.xdf", sha('a'), 100);
  clinic_.add("b", kS);
  look_at_all();
  const auto file = *store_->next_file(kNow).value();
  clinic_.sessions.erase(clinic_.sessions.begin());
  enter_erasure(kNow + 30 * kS);
  look_at_all(kNow + 60 * kS);
  EXPECT_EQ(store_->next_erased().value(), "a");
  EXPECT_FALSE(store_->is_wanted(file).value());
  EXPECT_FALSE(store_->next_file(kNow).value());
  EXPECT_THAT(send_facts(), ElementsAre("b"));
  ASSERT_TRUE(store_->erasure_answered("a"));
  EXPECT_FALSE(store_->next_erased().value());
  look_at_all(kNow + 120 * kS);
  EXPECT_FALSE(store_->next_erased().value());
}

TEST_F(OutboxTest, ErasureWhileTheForwarderWasDown_IsSeen) {
  clinic_.add("a", kS);
  look_at_all();
  clinic_.sessions.clear();
  enter_erasure(kNow + 30 * kS);
  open();
  look_at_all(kNow + 600 * kS);
  EXPECT_EQ(store_->next_erased().value(), "a");
}

TEST_F(OutboxTest, ErasureThatIsEnteredLate_IsSeenAnHourLater) {
  clinic_.add("a", kS);
  look_at_all();
  clinic_.sessions.clear();
  look_at_all(kNow + 600 * kS);
  EXPECT_FALSE(store_->next_erased().value());
  enter_erasure(kNow + 500 * kS);
  look_at_all(kNow + 1200 * kS);
  EXPECT_EQ(clinic_.whole_audits, 1);  // not asked again so soon: dtsd verifies its trail for each question
  look_at_all(kNow + 4300 * kS);
  EXPECT_EQ(store_->next_erased().value(), "a");
}

/// The noted entry is older than all that dtsd sends: it proves nothing, and the trail reaches back to the last list.
TEST_F(OutboxTest, ErasureAfterManyEntries_IsSeen) {
  clinic_.add("a", kS);
  look_at_all();
  for (std::uint32_t entry = 0; entry < kMostListed; ++entry) clinic_.add_entry(kNow + 300 * kS, "login");
  look_at_all(kNow + 600 * kS);
  clinic_.sessions.clear();
  enter_erasure(kNow + 700 * kS);
  look_at_all(kNow + 1200 * kS);
  EXPECT_EQ(store_->next_erased().value(), "a");
}

TEST_F(OutboxTest, ErasureAfterTheClockWasSetBack_IsSeen) {
  clinic_.add("a", kS);
  look_at_all(kNow + 100'000 * kS);
  look_at_all();
  clinic_.add_entry(kNow + 10 * kS, "start");
  clinic_.sessions.clear();
  enter_erasure(kNow + 30 * kS);
  look_at_all(kNow + 60 * kS);
  EXPECT_EQ(store_->next_erased().value(), "a");
}

/// The catalogue was made again: nothing is missing, and its trail is new.
TEST_F(OutboxTest, ErasureInACatalogueThatWasMadeAgain_IsSeen) {
  clinic_.add("a", kS);
  look_at_all();
  clinic_.trail.Clear();
  clinic_.add_entry(kNow + 10 * kS, "start");
  look_at_all(kNow + 4000 * kS);
  clinic_.sessions.clear();
  enter_erasure(kNow + 4100 * kS);
  look_at_all(kNow + 4200 * kS);
  EXPECT_EQ(store_->next_erased().value(), "a");
}

/// What looks like an erasure and is none.
class NoErasureTest : public OutboxTest {
 protected:
  void SetUp() override {
    OutboxTest::SetUp();
    clinic_.add("a", kS);
    look_at_all();
    send_facts();
  }
  void expect_none(std::int64_t utc_ns = kNow + 60 * kS) {
    (void)outbox_->look_at_all(utc_ns, {});
    (void)outbox_->look_at_all(utc_ns + 7200 * kS, {});
    EXPECT_FALSE(store_->next_erased().value());
  }
};

TEST_F(NoErasureTest, SilentDaemon) {
  clinic_.is_silent = true;
  expect_none();
}

TEST_F(NoErasureTest, EmptyCatalogueWithoutATrail) {
  clinic_.sessions.clear();
  expect_none();
}

TEST_F(NoErasureTest, NewCatalogueInWhichAnotherSubjectWasErased) {
  ASSERT_TRUE(store_->set_newest_audit(""));  // as an earlier version leaves it
  clinic_.sessions.clear();
  clinic_.trail.Clear();
  clinic_.add_entry(kNow + 10 * kS, "start_session");  // its trail does not reach back to the session
  enter_erasure(kNow + 20 * kS);
  expect_none();
}

TEST_F(NoErasureTest, ErasureLongBefore) {
  clinic_.sessions.clear();
  enter_erasure(kNow - 1800 * kS);
  expect_none();
}

TEST_F(NoErasureTest, ErasureOfAnotherSubjectLater) {
  clinic_.sessions.clear();
  expect_none();
  enter_erasure(kNow + 20000 * kS);
  expect_none(kNow + 20060 * kS);
}

TEST_F(NoErasureTest, ErasureOfFewerSessionsThanAreMissing) {
  clinic_.add("b", 2 * kS);
  look_at_all();
  clinic_.sessions.clear();
  enter_erasure(kNow + 30 * kS, "1 session");
  expect_none();
}

TEST_F(NoErasureTest, CatalogueFromABackupInWhichAnErasureIsRepeated) {
  RecordProperty("requirement", "FLEET-6");
  const auto backup = clinic_.sessions;
  const auto trail_of_backup = clinic_.trail;
  clinic_.sessions.clear();
  enter_erasure(kNow + 30 * kS);
  look_at_all(kNow + 60 * kS);
  ASSERT_EQ(store_->next_erased().value(), "a");
  ASSERT_TRUE(store_->erasure_answered("a"));
  clinic_.add("b", 100 * kS);  // of another person, after the backup
  clinic_.add_entry(kNow + 100 * kS, "start_session");
  look_at_all(kNow + 120 * kS);

  clinic_.sessions = backup;
  clinic_.trail = trail_of_backup;
  clinic_.add_entry(kNow + 150 * kS, "start");
  clinic_.sessions.clear();
  enter_erasure(kNow + 160 * kS);
  expect_none(kNow + 180 * kS);

  clinic_.add("c", 200 * kS);
  look_at_all(kNow + 20000 * kS);
  clinic_.sessions.clear();
  enter_erasure(kNow + 20010 * kS);
  look_at_all(kNow + 20020 * kS);
  EXPECT_EQ(store_->next_erased().value(), "c") << "erasures after the restore are believed";
  ASSERT_TRUE(store_->erasure_answered("c"));
  EXPECT_FALSE(store_->next_erased().value());
}

TEST_F(NoErasureTest, CatalogueFromABackupInWhichAnotherSubjectIsErasedAtOnce) {
  const auto backup = clinic_.trail;
  clinic_.add("b", 4000 * kS);
  clinic_.add_entry(kNow + 4000 * kS, "start_session");
  look_at_all(kNow + 4100 * kS);
  EXPECT_EQ(clinic_.whole_audits, 0) << "only the newest entry is noted";

  clinic_.sessions.pop_back();
  clinic_.trail = backup;
  enter_erasure(kNow + 4200 * kS);
  expect_none(kNow + 4300 * kS);
}

TEST_F(NoErasureTest, ErasureThatFailed) {
  clinic_.sessions.clear();
  clinic_.add_entry(kNow + 30 * kS, "erase_subject", "not_allowed");
  expect_none();
}

TEST_F(NoErasureTest, TrailThatIsBroken) {
  clinic_.sessions.clear();
  enter_erasure(kNow + 30 * kS);
  clinic_.trail.set_problem("entry 2 was changed");
  expect_none();
}

/// A list of dtsd that is cut: as many newer sessions as it can hold.
std::vector<v1::SessionRecord> full_list() {
  std::vector<v1::SessionRecord> full;
  for (std::uint32_t n = 0; n < kMostListed; ++n) {
    full.emplace_back();
    full.back().set_session_id("n");  // the same: only their number matters
    full.back().set_started_utc_ns(2 * kS);
  }
  return full;
}

TEST_F(NoErasureTest, SessionBeyondAListThatIsCut) {
  enter_erasure(kNow + 30 * kS);
  auto full = full_list();
  full.push_back(clinic_.sessions.front());
  clinic_.sessions = std::move(full);
  expect_none();
}

TEST_F(OutboxTest, ErasureBeyondAListThatIsCut_IsSeen) {
  clinic_.add("a", kS);
  look_at_all();
  clinic_.sessions = full_list();
  enter_erasure(kNow + 30 * kS);
  look_at_all(kNow + 60 * kS);
  EXPECT_EQ(store_->next_erased().value(), "a");
}

TEST_F(OutboxTest, OfferAgain_OffersSessionsBeyondAListThatIsCut) {
  clinic_.add_part(clinic_.add("a", kS), "/a.xdf", sha('a'), 100);
  look_at_all();
  ASSERT_TRUE(store_->set_sent_sha256(*store_->next_file(kNow).value(), hashes('a', 'c'), kNow));
  send_facts();
  v1::Receipt receipt;
  receipt.set_stored_utc_ns(kNow);
  ASSERT_TRUE(store_->set_stored(*store_->next_file(kNow).value(), receipt));
  auto full = full_list();
  full.push_back(clinic_.sessions.front());
  clinic_.sessions = std::move(full);
  ASSERT_TRUE(store_->offer_again());
  look_at_all(kNow + 60 * kS);
  EXPECT_THAT(send_facts(), testing::Contains("a"));
  const auto file = store_->next_file(kNow + 60 * kS).value();
  ASSERT_TRUE(file);
  EXPECT_EQ(file->session, "a");
  EXPECT_TRUE(file->is_session_sent);
}

TEST_F(NoErasureTest, NewStateFolderOfTheForwarder) {
  clinic_.sessions.clear();
  enter_erasure(kNow + 30 * kS);
  store_.reset();
  std::filesystem::remove(folder_.path() + "/sent.sqlite");
  std::filesystem::remove(folder_.path() + "/sent.sqlite-wal");
  open();
  expect_none();
}

TEST(Store, DamagedFile_IsReported) {
  test::TemporaryFolder folder;
  std::ofstream(folder.path() + "/sent.sqlite") << std::string(5000, 'x');
  EXPECT_EQ(Store::open(folder.path()).error().code, core::ErrorCode::DataDamaged);
}

TEST(Store, SetAside_KeepsEachDamagedStoreAndItsLog) {
  test::TemporaryFolder folder;
  const std::string file = folder.path() + "/sent.sqlite";
  for (const std::string number : {"1", "2"}) {
    std::ofstream(file) << "damaged " + number;
    std::ofstream(file + "-wal") << "log " + number;
    EXPECT_EQ(Store::set_aside(folder.path()).value(), file + ".damaged-" + number);
    EXPECT_FALSE(std::filesystem::exists(file));
    EXPECT_FALSE(std::filesystem::exists(file + "-wal"));
  }
  EXPECT_EQ(test::content_of(file + ".damaged-1"), "damaged 1");
  EXPECT_EQ(test::content_of(file + ".damaged-1-wal"), "log 1");
  EXPECT_EQ(test::content_of(file + ".damaged-2"), "damaged 2");
}

}  // namespace
}  // namespace dts::fleet::forward
