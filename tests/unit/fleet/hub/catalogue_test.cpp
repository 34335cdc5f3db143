// SPDX-License-Identifier: Apache-2.0
// With a real PostgreSQL.
#include "fleet/hub/catalogue.h"

#include <chrono>
#include <iostream>
#include <thread>
#include <vector>

#include "fleet/hub/audit_trail.h"
#include "unit/fleet/hub/hub_fixture.h"

namespace dts::fleet::hub {
namespace {

using database::Database;
using database::migrate;

class CatalogueTest : public DatabaseTest {
 protected:
  void SetUp() override {
    DatabaseTest::SetUp();
    if (!IsSkipped() && !HasFatalFailure()) store_ = open_folder_store(folder_.path()).value();
  }
  /// Puts a recording of a session into the store and the catalogue.
  core::Result<v1::Receipt> enter(const std::string& clinic, const std::string& session, const std::string& bytes, std::uint32_t part = 1) {
    const RecordingName name{clinic, sum_of(bytes)};
    const std::string file = folder_.path() + "/whole";
    std::ofstream(file, std::ios::binary) << bytes;
    DTS_TRY(store_->put(name, file));
    v1::UploadOffer offer;
    offer.set_sha256(name.sha256);
    offer.set_bytes(bytes.size());
    offer.set_session_id(session);
    offer.set_part(part);
    return catalogue_->put_recording(name, offer, *store_, "hub-1", 1'763'736'400'123'456'789);
  }

  core::Status erase(const std::string& session) { return catalogue_->erase_session({"kent", session}, "clinic:kent", 7); }

  test::TemporaryFolder folder_;
  std::unique_ptr<Store> store_;
};

TEST_F(CatalogueTest, Migrate_Again_ChangesNothing) {
  EXPECT_TRUE(migrate(*database_));
  EXPECT_EQ(value("SELECT count(*) FROM schema_version"), std::to_string(database::kSchemaVersion));
}

TEST_F(CatalogueTest, Migrate_TablesOfANewerHub_AreRejected) {
  ASSERT_TRUE(database_->run("INSERT INTO schema_version (version) VALUES (99)"));
  const auto migrated = migrate(*database_);
  ASSERT_FALSE(migrated);
  EXPECT_EQ(migrated.error().code, core::ErrorCode::Unsupported);
}

TEST_F(CatalogueTest, Facts_AreStoredAsTheyAre) {
  ASSERT_EQ(catalogue_->put_session("kent", session_of("s1", 3)), 3U);
  EXPECT_EQ(
      value("SELECT concat_ws('|', revision, rig, protocol, subject, state, started, ended, planned_trials, fields, label) FROM session"),
      R"(3|floor|romberg|P017|complete|2025-11-21 14:45:25.125+00|2025-11-21 14:46:25+00|2|{"arm_length_cm": "71"})");
  EXPECT_EQ(value("SELECT concat_ws('|', part, state, bytes, scans, duration_s, store_key) FROM part"), "1|complete|1000|100|1.5");
  EXPECT_EQ(value("SELECT concat_ws('|', part, trial, attempt, condition, outcome, recorded_outcome, fault) FROM trial"),
            R"(1|1|1|eyes "open", \ both|done||)");
  EXPECT_EQ(value("SELECT concat_ws('|', name, analysis, value, unit) FROM result"), "MVELO|clinic|8.38|mm/s");
}

TEST_F(CatalogueTest, Facts_LateOrDoubled_ChangeNothing) {
  ASSERT_EQ(catalogue_->put_session("kent", session_of("s1", 3)), 3U);
  auto late = session_of("s1", 2);
  late.set_subject("P018");
  late.clear_trials();
  EXPECT_EQ(catalogue_->put_session("kent", late), 3U);
  late.set_revision(3);
  EXPECT_EQ(catalogue_->put_session("kent", late), 3U);
  EXPECT_EQ(value("SELECT subject FROM session"), "P017");
  EXPECT_EQ(value("SELECT count(*) FROM trial"), "1");
}

TEST_F(CatalogueTest, Facts_NewerRevision_ReplacesTheWholeSession) {
  ASSERT_TRUE(catalogue_->put_session("kent", session_of("s1", 1)));
  ASSERT_TRUE(
      database_->run("INSERT INTO result (clinic, session, name, analysis, value, unit) VALUES ('kent', 's1', 'MVELO', 'sway 1', 1, '')"));
  auto newer = session_of("s1", 2);
  newer.clear_trials();
  newer.clear_parts();
  newer.mutable_results(0)->set_name("RDIST");
  EXPECT_EQ(catalogue_->put_session("kent", newer), 2U);
  EXPECT_EQ(value("SELECT count(*) FROM trial"), "0");
  EXPECT_EQ(value("SELECT count(*) FROM part"), "0");
  EXPECT_EQ(value("SELECT string_agg(name || ' ' || analysis, ',' ORDER BY name) FROM result"), "MVELO sway 1,RDIST clinic");
}

TEST_F(CatalogueTest, Results_HaveTheWeekAndProtocolOfTheirSession_AlsoInANewerRevision) {
  const std::string results =
      "SELECT string_agg(concat_ws('|', name, value, week, started IS NULL, protocol), ',' ORDER BY name) FROM result";
  auto session = session_of("s1", 1);
  session.add_results()->set_name("RDIST");
  ASSERT_TRUE(catalogue_->put_session("kent", session));
  EXPECT_EQ(value(results), "MVELO|8.38|2025-11-17|f|romberg,RDIST|0|2025-11-17|f|romberg");
  session.set_revision(2);
  session.set_started_utc_ns(1'764'547'199'000'000'000);  // the last second of a Sunday
  session.set_protocol("mctsib");
  session.mutable_results(0)->set_value(7);
  session.mutable_results(1)->set_name("AREA");
  ASSERT_TRUE(catalogue_->put_session("kent", session));
  EXPECT_EQ(value(results), "AREA|0|2025-11-24|f|mctsib,MVELO|7|2025-11-24|f|mctsib");
  session.set_revision(3);
  session.set_is_deleted(true);
  session.add_results()->set_name("B");
  ASSERT_TRUE(catalogue_->put_session("kent", session));
  EXPECT_EQ(value(results), "AREA|0|t|mctsib,B|0|t|mctsib,MVELO|7|t|mctsib");
}

TEST_F(CatalogueTest, ClinicsWithTheSameSession_StayApart) {
  ASSERT_TRUE(catalogue_->put_session("kent", session_of("s1", 5)));
  auto other = session_of("s1", 1);
  other.set_subject("X1");
  EXPECT_EQ(catalogue_->put_session("leeds", other), 1U);
  EXPECT_EQ(value("SELECT string_agg(clinic || subject, ',' ORDER BY clinic) FROM session"), "kentP017,leedsX1");
}

TEST_F(CatalogueTest, Recording_BeforeItsFacts_IsFoundByThem) {
  const auto receipt = enter("kent", "s1", "recording of s1");
  ASSERT_TRUE(receipt) << core::to_string(receipt.error());
  EXPECT_EQ(receipt->stored_utc_ns(), 1'763'736'400'123'456'000);
  EXPECT_EQ(receipt->bytes(), 15U);
  EXPECT_EQ(receipt->hub(), "hub-1");
  ASSERT_TRUE(catalogue_->put_session("kent", session_of("s1", 1)));
  EXPECT_EQ(value("SELECT concat_ws('|', state, scans, store_key IS NOT NULL, stored_utc) FROM part"),
            "complete|100|t|2025-11-21 14:46:40.123456+00");
}

TEST_F(CatalogueTest, Recording_AfterItsFacts_CompletesThem) {
  ASSERT_TRUE(catalogue_->put_session("kent", session_of("s1", 1)));
  ASSERT_TRUE(enter("kent", "s1", "recording of s1"));
  EXPECT_EQ(value("SELECT concat_ws('|', state, store_key) FROM part"), "complete|" + key_of({"kent", sum_of("recording of s1")}));
}

TEST_F(CatalogueTest, FactsOfAnOpenPart_KeepWhatIsStored) {
  ASSERT_TRUE(enter("kent", "s1", "recording of s1"));
  auto open = session_of("s1", 1);
  open.mutable_parts(0)->clear_sha256();
  open.mutable_parts(0)->set_bytes(0);
  ASSERT_TRUE(catalogue_->put_session("kent", open));
  EXPECT_EQ(value("SELECT concat_ws('|', bytes, store_key IS NOT NULL) FROM part"), "15|t");
}

TEST_F(CatalogueTest, Recording_Twice_KeepsTheFirstReceipt) {
  ASSERT_TRUE(enter("kent", "s1", "recording of s1"));
  ASSERT_TRUE(database_->run("UPDATE receipt SET hub = 'hub-0'"));
  const auto again = enter("kent", "s1", "recording of s1");
  ASSERT_TRUE(again);
  EXPECT_EQ(again->hub(), "hub-0");
  EXPECT_EQ(value("SELECT count(*) FROM receipt"), "1");
  EXPECT_EQ(value("SELECT count(*) FROM part"), "1");
}

TEST_F(CatalogueTest, Recording_OfAnotherSession_IsRejected) {
  ASSERT_TRUE(catalogue_->put_session("kent", session_of("s1", 1)));
  const auto entered = enter("kent", "s2", "recording of s1");
  ASSERT_FALSE(entered);
  EXPECT_EQ(entered.error().code, core::ErrorCode::WrongState);
  EXPECT_EQ(value("SELECT count(*) FROM receipt"), "0");
}

TEST_F(CatalogueTest, Recording_ThatIsNotInTheStore_GetsNoReceipt) {
  v1::UploadOffer offer;
  offer.set_session_id("s1");
  offer.set_part(1);
  offer.set_bytes(5);
  const auto entered = catalogue_->put_recording({"kent", sum_of("x")}, offer, *store_, "hub-1", 0);
  ASSERT_FALSE(entered);
  EXPECT_EQ(entered.error().code, core::ErrorCode::DataDamaged);
  EXPECT_EQ(value("SELECT count(*) FROM part"), "0");
}

TEST_F(CatalogueTest, RemoveRecording_WithAReceipt_IsRejected) {
  ASSERT_TRUE(enter("kent", "s1", "recording of s1"));
  const RecordingName name{"kent", sum_of("recording of s1")};
  const auto removed = catalogue_->remove_recording(name, *store_);
  ASSERT_FALSE(removed);
  EXPECT_EQ(removed.error().code, core::ErrorCode::WrongState);
  EXPECT_EQ(store_->has(name), true);
}

TEST_F(CatalogueTest, Erase_RemovesAllRows_AndNamesTheFiles) {
  ASSERT_TRUE(catalogue_->put_session("kent", session_of("s1", 1)));
  ASSERT_TRUE(catalogue_->put_session("kent", session_of("s2", 1)));
  ASSERT_TRUE(enter("kent", "s1", "recording of s1"));
  const auto erased = erase("s1");
  ASSERT_TRUE(erased) << core::to_string(erased.error());
  const auto left = catalogue_->left_recordings("kent").value();
  ASSERT_EQ(left, std::vector<RecordingName>{(RecordingName{"kent", sum_of("recording of s1")})});
  EXPECT_EQ(catalogue_->left_recordings("leeds")->size(), 0U);
  EXPECT_TRUE(catalogue_->remove_left(left.front(), *store_).value());
  EXPECT_EQ(catalogue_->left_recordings("")->size(), 0U);
  for (const std::string table : {"session", "part", "trial", "result", "receipt"}) {
    const std::string key = table == "session" ? "id" : "session";
    EXPECT_EQ(value("SELECT count(*) FROM " + table + " WHERE " + key + " = 's1'"), "0") << table;
  }
  EXPECT_EQ(value("SELECT count(*) FROM session"), "1");
  EXPECT_EQ(value("SELECT concat_ws('|', who, what, target) FROM audit"), "clinic:kent|erase_session|kent/s1");
  EXPECT_EQ(value("SELECT count(*) FROM audit WHERE audit::text LIKE '%P017%'"), "0");
}

/// Facts of one session may announce a recording that has arrived as part of another one.
TEST_F(CatalogueTest, Erase_TakesAlongTheReceiptOfTheSameRecording) {
  auto first = session_of("s1", 1);
  first.mutable_parts(0)->set_sha256(sum_of("newer recording of s1"));
  ASSERT_TRUE(catalogue_->put_session("kent", first));
  ASSERT_TRUE(enter("kent", "s1", "recording of s2"));  // its part stays the announced one
  ASSERT_TRUE(catalogue_->put_session("kent", session_of("s2", 1)));
  ASSERT_TRUE(erase("s2"));
  EXPECT_EQ(value("SELECT count(*) FROM receipt"), "0");
  EXPECT_TRUE(catalogue_->remove_left({"kent", sum_of("recording of s2")}, *store_).value());
  EXPECT_EQ(value("SELECT count(*) FROM erased_file"), "0");
}

TEST_F(CatalogueTest, Erase_LeavesNoPartOfAnotherSession_WithoutItsRecording) {
  auto first = session_of("s1", 1);
  first.mutable_parts(0)->set_sha256(sum_of("newer recording of s1"));
  ASSERT_TRUE(catalogue_->put_session("kent", first));
  ASSERT_TRUE(enter("kent", "s1", "recording of s2"));
  ASSERT_TRUE(catalogue_->put_session("kent", session_of("s2", 1)));
  EXPECT_EQ(value("SELECT store_key IS NOT NULL FROM part WHERE session = 's2'"), "t");
  ASSERT_TRUE(erase("s1"));
  EXPECT_EQ(value("SELECT store_key IS NOT NULL FROM part WHERE session = 's2'"), "f");
}

TEST_F(CatalogueTest, ErasedRecording_ThatHasAReceiptAgain_Stays_AndIsNoLongerToBeRemoved) {
  ASSERT_TRUE(enter("kent", "s1", "recording"));
  ASSERT_TRUE(erase("s1"));
  ASSERT_TRUE(enter("kent", "s2", "recording"));
  EXPECT_FALSE(catalogue_->remove_left({"kent", sum_of("recording")}, *store_).value());
  EXPECT_TRUE(store_->file({"kent", sum_of("recording")}).value());
  EXPECT_EQ(catalogue_->left_recordings("")->size(), 0U);
}

TEST_F(CatalogueTest, Quota_OfSessionsAndRows_RejectsMore_AndAnErasureMakesRoom) {
  QuotaFigures quota;
  quota.sessions = 2;
  quota.rows = 8;
  quota.recordings = 1;
  quota.erased_sessions = 1;
  Catalogue limited(*database_, quota);
  ASSERT_EQ(limited.put_session("kent", session_of("s1", 1)), 1U);  // 3 rows
  ASSERT_EQ(limited.put_session("kent", session_of("s2", 1)), 1U);
  const auto third = limited.put_session("kent", session_of("s3", 1));
  ASSERT_FALSE(third);
  EXPECT_EQ(third.error().code, core::ErrorCode::WrongState);
  EXPECT_NE(third.error().what.find("2 sessions"), std::string::npos) << third.error().what;
  EXPECT_EQ(limited.put_session("leeds", session_of("s3", 1)), 1U);

  auto larger = session_of("s1", 2);
  for (int number = 0; number < 2; ++number) larger.add_results()->set_name("R" + std::to_string(number));
  EXPECT_EQ(limited.put_session("kent", larger), 2U);  // 8 rows
  larger.set_revision(3);
  larger.add_results()->set_name("R2");
  EXPECT_EQ(limited.put_session("kent", larger).error().code, core::ErrorCode::WrongState);
  EXPECT_EQ(value("SELECT sum(rows) FROM row_count WHERE clinic = 'kent'"), "8");

  EXPECT_TRUE(limited.check_room_for_recording("kent"));
  ASSERT_TRUE(enter("kent", "s1", "recording of s1"));
  EXPECT_EQ(limited.check_room_for_recording("kent").error().code, core::ErrorCode::WrongState);
  EXPECT_TRUE(limited.check_room_for_recording("leeds"));
  EXPECT_TRUE(limited.check_room_for_erasure("kent"));
  ASSERT_TRUE(erase("s1"));
  EXPECT_EQ(limited.check_room_for_erasure("kent").error().code, core::ErrorCode::WrongState);
  EXPECT_TRUE(limited.check_room_for_recording("kent"));
  EXPECT_EQ(value("SELECT concat_ws('|', sum(sessions), sum(rows), sum(recordings), sum(erased)) FROM row_count WHERE clinic = 'kent'"),
            "1|3|0|1");
  EXPECT_EQ(limited.put_session("kent", session_of("s3", 1)), 1U);
}

TEST_F(CatalogueTest, Rigs_AreTheNewest64) {
  v1::Beat beat;
  for (int number = 0; number < 64; ++number) beat.add_rigs()->set_rig("old-" + std::to_string(number));
  ASSERT_TRUE(catalogue_->put_beat("kent", beat, 1'000'000'000'000'000'000));
  ASSERT_TRUE(catalogue_->put_beat("leeds", beat, 1'000'000'000'000'000'000));
  beat.clear_rigs();
  for (int number = 0; number < 3; ++number) beat.add_rigs()->set_rig("new-" + std::to_string(number));
  ASSERT_TRUE(catalogue_->put_beat("kent", beat, 1'000'000'010'000'000'000));
  EXPECT_EQ(value("SELECT count(*) FROM rig WHERE clinic = 'kent'"), "64");
  EXPECT_EQ(value("SELECT count(*) FROM rig WHERE clinic = 'kent' AND id LIKE 'new-%'"), "3");
  EXPECT_EQ(value("SELECT count(*) FROM rig WHERE clinic = 'leeds'"), "64");
}

/// A worker writes a result while the clinic hides the session: the result must not stay in the trend.
TEST_F(CatalogueTest, ResultOfAWorker_DuringAChangeOfItsSession_HasTheNewState) {
  ASSERT_TRUE(catalogue_->put_session("kent", session_of("s1", 1)));
  const auto worker = open_database();
  const std::string pid = worker->run("SELECT pg_backend_pid()").value().text(0, 0);
  std::atomic<bool> has_ended{false};
  std::jthread writing;
  const auto changed = database_->transaction([&]() -> core::Status {
    DTS_TRY(database_->run("UPDATE session SET is_deleted = true, protocol = 'reach'"));
    writing = std::jthread([&] {
      EXPECT_TRUE(
          worker->run("INSERT INTO result (clinic, session, name, analysis, value, unit) VALUES ('kent', 's1', 'MVELO', 'sway 1', 1, '')"));
      has_ended = true;
    });
    // Not pg_stat_activity, which does not change within a transaction.
    const std::string waits = "SELECT FROM pg_locks WHERE NOT granted AND pid = " + pid;
    while (!has_ended) {
      DTS_TRY_ASSIGN(const auto rows, database_->run(waits));
      if (!rows.empty()) break;
    }
    return {};
  });
  ASSERT_TRUE(changed) << core::to_string(changed.error());
  writing.join();
  EXPECT_EQ(value("SELECT concat_ws('|', started, week, protocol) FROM result WHERE analysis = 'sway 1'"), "reach");
  EXPECT_EQ(value("SELECT concat_ws('|', started, week, protocol) FROM result WHERE analysis = 'clinic'"), "reach");
  ASSERT_TRUE(database_->run("UPDATE session SET is_deleted = false"));
  EXPECT_EQ(value("SELECT concat_ws('|', count(*), min(week), max(week)) FROM result"), "2|2025-11-17|2025-11-17");
}

TEST_F(CatalogueTest, ErasedSession_StaysErased) {
  ASSERT_TRUE(erase("s1"));
  ASSERT_TRUE(erase("s1"));
  const auto facts = catalogue_->put_session("kent", session_of("s1", 9));
  ASSERT_FALSE(facts);
  EXPECT_EQ(facts.error().code, core::ErrorCode::NotFound);
  const auto recording = enter("kent", "s1", "recording of s1");
  ASSERT_FALSE(recording);
  EXPECT_EQ(recording.error().code, core::ErrorCode::NotFound);
  EXPECT_EQ(value("SELECT count(*) FROM audit"), "1");
  EXPECT_TRUE(catalogue_->put_session("leeds", session_of("s1", 1)));
}

TEST_F(CatalogueTest, Beat_KeepsTheNewestAndADay) {
  v1::Beat beat;
  beat.set_utc_ns(1'000'000'000'000'000'000);
  beat.set_has_daemon(true);
  beat.set_daemon_version("0.2.0");
  beat.mutable_backlog()->set_bytes(500);
  beat.mutable_disk()->set_state(v1::DISK_STATE_LOW);
  auto& rig = *beat.add_rigs();
  rig.set_rig("floor");
  rig.set_device(v1::DEVICE_STATE_STREAMING);
  rig.set_calibration("cop-1");
  rig.add_streams("cop");
  rig.add_streams("sway");
  const auto head = catalogue_->put_beat("kent", beat, 1'000'000'002'500'000'000);
  ASSERT_TRUE(head) << core::to_string(head.error());
  EXPECT_EQ(*head, "");
  beat.mutable_backlog()->set_bytes(100);
  ASSERT_TRUE(erase("s1"));
  const auto second = catalogue_->put_beat("kent", beat, 1'000'000'010'000'000'000);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->size(), 32U);
  EXPECT_EQ(value("SELECT concat_ws('|', clinic, clock_offset_s, daemon_version, disk_state, backlog_bytes, backlog_oldest) FROM beat"),
            "kent|-10|0.2.0|low|100");
  EXPECT_EQ(value("SELECT concat_ws('|', day, beats, largest_clock_offset_s, largest_backlog_bytes) FROM beat_history"),
            "2001-09-09|2|10|500");
  EXPECT_EQ(value("SELECT concat_ws('|', id, device, calibration, streams, at - calibration_since) FROM rig"),
            "floor|streaming|cop-1|{cop,sway}|00:00:07.5");
  ASSERT_TRUE(catalogue_->prune_history());
  EXPECT_EQ(value("SELECT count(*) FROM beat_history"), "0");
}

TEST_F(CatalogueTest, AuditTrail_DetectsAChange) {
  const Clinic clinic{.id = "kent", .title = "Kent", .nkey = "UA1"};
  ASSERT_TRUE(catalogue_->add_clinic(clinic, "local:anna", 1));
  ASSERT_TRUE(catalogue_->revoke_clinic("kent", "local:anna", 2));
  EXPECT_EQ(verify_audit(*database_), 2U);
  ASSERT_TRUE(database_->run("UPDATE audit SET who = 'local:eve' WHERE number = 1"));
  const auto verified = verify_audit(*database_);
  ASSERT_FALSE(verified);
  EXPECT_EQ(verified.error().code, core::ErrorCode::DataDamaged);
}

TEST_F(CatalogueTest, Clinic_TwiceOrUnknown_IsRejected) {
  const Clinic clinic{.id = "kent", .title = "Kent", .nkey = "UA1"};
  ASSERT_TRUE(catalogue_->add_clinic(clinic, "local:anna", 1));
  EXPECT_EQ(catalogue_->add_clinic({.id = "leeds", .title = "", .nkey = "UA1"}, "local:anna", 1).error().code, core::ErrorCode::WrongState);
  EXPECT_EQ(catalogue_->revoke_clinic("york", "local:anna", 1).error().code, core::ErrorCode::NotFound);
  ASSERT_TRUE(catalogue_->revoke_clinic("kent", "local:anna", 1));
  EXPECT_EQ(catalogue_->revoke_clinic("kent", "local:anna", 1).error().code, core::ErrorCode::WrongState);
  EXPECT_TRUE(catalogue_->clinics()->front().is_revoked);
  EXPECT_EQ(value("SELECT count(*) FROM audit"), "2");
}

TEST_F(CatalogueTest, Notification_WakesTheListener) {
  const auto listener = open_database();
  listener->listen("clinic");
  EXPECT_TRUE(listener->wait_notification(std::chrono::milliseconds(0)).value());  // a new connection may have missed one
  ASSERT_TRUE(catalogue_->add_clinic({.id = "kent", .title = "", .nkey = "UA1"}, "local:anna", 1));
  EXPECT_TRUE(listener->wait_notification(std::chrono::seconds(60)).value());
  EXPECT_FALSE(listener->wait_notification(std::chrono::milliseconds(0)).value());
}

TEST_F(CatalogueTest, LostConnection_IsOpenedAgain_ButNotWithinATransaction) {
  const auto main = open_database();
  const auto end_it = [&] {
    return main->run(
        "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE pid <> pg_backend_pid() AND datname = current_database()");
  };
  const auto done = database_->transaction([&]() -> core::Status {
    DTS_TRY(database_->run("INSERT INTO erased (clinic, session) VALUES ('kent', 's1')"));
    EXPECT_TRUE(end_it());
    EXPECT_FALSE(database_->run("SELECT 1"));
    EXPECT_FALSE(database_->run("INSERT INTO erased (clinic, session) VALUES ('kent', 's2')"));
    return {};
  });
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, core::ErrorCode::Unreachable);
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!database_->run("SELECT 1") && std::chrono::steady_clock::now() < deadline) {
  }
  EXPECT_EQ(value("SELECT count(*) FROM erased"), "0");
}

TEST_F(CatalogueTest, Reader_SeesPermittedSessions_WithoutSubjects) {
  ASSERT_TRUE(catalogue_->put_session("kent", session_of("s1", 1)));
  ASSERT_TRUE(catalogue_->put_session("leeds", session_of("s2", 1)));
  auto other = session_of("s3", 1);
  other.set_protocol("reach");
  ASSERT_TRUE(catalogue_->put_session("leeds", other));
  ASSERT_TRUE(
      database_->run_script("DO $$ BEGIN CREATE ROLE anna LOGIN IN ROLE reader; EXCEPTION WHEN duplicate_object THEN NULL; END $$;"
                            "INSERT INTO permit VALUES ('anna', 'leeds', 'romberg')"));
  Database anna({.connection = connection_ + " user=anna", .name = "anna"});
  const auto first = [&](const std::string& sql) {
    const auto rows = anna.run(sql);
    return rows ? rows->text(0, 0) : std::string(core::name(rows.error().code));
  };
  EXPECT_EQ(first("SELECT string_agg(clinic || id, ',') FROM study.session"), "leedss2");
  EXPECT_EQ(first("SELECT string_agg(session, ',') FROM study.result"), "s2");
  EXPECT_EQ(first("SELECT string_agg(session, ',') FROM study.trial"), "s2");
  EXPECT_EQ(first("SELECT string_agg(session, ',') FROM study.part"), "s2");
  EXPECT_EQ(first("SELECT subject FROM session"), "not_allowed");
  EXPECT_EQ(first("SELECT subject FROM study.subject"), "not_allowed");
  EXPECT_EQ(first("SELECT count(*) FROM receipt"), "not_allowed");
  ASSERT_TRUE(database_->run_script("GRANT subject_reader TO anna; INSERT INTO permit VALUES ('anna', 'kent', NULL)"));
  EXPECT_EQ(first("SELECT string_agg(session || subject, ',' ORDER BY session) FROM study.subject"), "s1P017,s2P017");
  ASSERT_TRUE(database_->run_script("REVOKE subject_reader FROM anna"));
}

/// As the hub does it: several connections, whose commits share the wait for the disk.
TEST_F(CatalogueTest, Speed_OfAThousandSessions) {
  constexpr int kThreads = 4;
  constexpr int kEach = 250;
  auto common = session_of("s", 1);
  for (std::uint32_t number = 2; number <= 9; ++number) {
    *common.add_trials() = common.trials(0);
    common.mutable_trials(static_cast<int>(number) - 1)->set_trial(number);
  }
  const auto begun = std::chrono::steady_clock::now();
  std::atomic<int> put{0};
  {
    std::vector<std::jthread> threads;
    for (int thread = 0; thread < kThreads; ++thread) {
      threads.emplace_back([&, thread] {
        const auto database = open_database();
        auto session = common;
        for (int number = 0; number < kEach; ++number) {
          session.set_session_id("s" + std::to_string(thread * kEach + number));
          session.mutable_parts(0)->set_sha256(sum_of(session.session_id()));
          put += Catalogue(*database).put_session("kent", session) == 1U ? 1 : 0;
        }
      });
    }
  }
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begun;
  std::cout << "facts of 1000 sessions with 9 trials: " << 1000.0 / taken.count() << " a second\n";
  EXPECT_EQ(put, kThreads * kEach);
  EXPECT_EQ(value("SELECT count(*) FROM trial"), "9000");
}

}  // namespace
}  // namespace dts::fleet::hub
