// SPDX-License-Identifier: Apache-2.0
#include "fleet/desk/pages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/ostream_sink.h>

#include <atomic>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>

#include "fleet/database/schema.h"
#include "fleet/desk/query_pool.h"
#include "support/postgres_server.h"

namespace dts::fleet::desk {
namespace {

using database::Database;
using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// One PostgreSQL for all tests, and a new database for each.
class PagesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!test::PostgresServer::programs()) GTEST_SKIP() << "PostgreSQL is not installed";
    static const auto server = std::make_unique<test::PostgresServer>();
    static std::atomic<int> count{0};
    const std::string name = "pages" + std::to_string(++count);
    Database first({.connection = server->connection(), .name = "test"});
    ASSERT_TRUE(first.run("CREATE DATABASE " + name));
    connection_ = server->connection(name);
    database_ = std::make_unique<Database>(database::DatabaseOptions{.connection = connection_, .name = "test"});
    const auto migrated = database::migrate(*database_);
    ASSERT_TRUE(migrated) << core::to_string(migrated.error());
    sql("INSERT INTO clinic (id, title, nkey) VALUES ('kent', 'Kent', 'U1'), ('dover', 'Dover', 'U2')");
  }

  void sql(const std::string& statements) {
    const auto done = database_->run_script(statements);
    ASSERT_TRUE(done) << core::to_string(done.error());
  }
  /// A heartbeat of a clinic that is well, with one rig.
  void add_beat(const std::string& clinic) {
    sql("INSERT INTO beat VALUES ('" + clinic + "', now(), 0.01, '1.2.0', true, '1.2.0', 'fine', 1000, 60, 0, 0, NULL, NULL, 0)");
    sql("INSERT INTO rig SELECT '" + clinic +
        "', 'floor', 'floor', 16, 'streaming', 100, 100.1, 5000, 0, 0, 'idle', '', 'c1', "
        "now() - interval '20 days', '{cop}', at FROM beat WHERE clinic = '" +
        clinic + "'");
  }
  void add_session(const std::string& clinic, const std::string& id, const std::string& started, const std::string& protocol = "romberg",
                   const std::string& subject = "P1") {
    sql("INSERT INTO session (clinic, id, revision, rig, protocol, subject, state, started, planned_trials, is_deleted, fields) VALUES ('" +
        clinic + "', '" + id + "', 1, 'floor', '" + protocol + "', '" + subject + "', 'complete', '" + started + "', 4, false, '{}')");
  }
  void add_result(const std::string& clinic, const std::string& session, double value) {
    sql("INSERT INTO result (clinic, session, name, analysis, value, unit) VALUES ('" + clinic + "', '" + session +
        "', 'MVELO', 'clinic', " + std::to_string(value) + ", 'mm/s')");
  }
  static json read(const core::Result<std::string>& document) {
    EXPECT_TRUE(document) << core::to_string(document.error());
    return document ? json::parse(*document) : json();
  }
  json clinics() { return read(clinics_page(*database_, "1.2.0-dev"))["clinics"]; }
  json kent() {
    for (const json& clinic : clinics()) {
      if (clinic["name"] == "kent") return clinic;
    }
    return nullptr;
  }
  static std::vector<std::string> ids(const json& page) {
    std::vector<std::string> found;
    for (const json& session : page["sessions"]) found.push_back(session["id"]);
    return found;
  }

  std::string connection_;
  std::unique_ptr<Database> database_{};
};

/// What a page says if its database, as this user, has this statement; and what the log says of three of them.
struct Failure {
  core::Error answer;
  std::string log;
};

Failure failure_of(const std::string& connection, const std::string& statement) {
  std::ostringstream said;
  boost::asio::io_context io;
  std::optional<core::Error> answer;
  {
    QueryPool pool(io, connection, core::Log(std::make_shared<spdlog::logger>("", std::make_shared<spdlog::sinks::ostream_sink_mt>(said))));
    for (int count = 0; count < 3; ++count) {
      answer.reset();
      pool.submit(
          [&](Database& database) -> core::Result<std::string> {
            DTS_TRY(database.run(statement));
            return std::string();
          },
          [&](core::Result<std::string> result) { answer = result ? core::Error{} : result.error(); });
      while (!answer) {
        io.restart();
        io.run_for(std::chrono::milliseconds(5));
      }
    }
  }
  return {.answer = *answer, .log = said.str()};
}

TEST_F(PagesTest, ADatabaseThatRejectsTheDashboard_IsLoggedOnce_WithWhatToDo) {
  sql("CREATE ROLE without_rights LOGIN");
  for (const auto& [user, reason] : {std::pair("nobody_of_ours", "role \"nobody_of_ours\" does not exist"),
                                     std::pair("without_rights", "permission denied for table session")}) {
    const Failure failure = failure_of(connection_ + " user=" + user, "SELECT FROM session");
    EXPECT_EQ(failure.answer.code, core::ErrorCode::Unreachable);
    EXPECT_EQ(failure.answer.what, "the database of the centre rejects the dashboard");
    EXPECT_THAT(failure.log, HasSubstr(reason));
    EXPECT_THAT(failure.log, HasSubstr("CREATE ROLE"));
    EXPECT_EQ(failure.log.find("[error]"), failure.log.rfind("[error]")) << failure.log;
  }
  sql("DROP ROLE without_rights");
}

TEST_F(PagesTest, ClinicThatIsWell_HasNothingWrong) {
  add_beat("kent");

  const json kent = clinics()[1];  // after dover, which has never reported
  EXPECT_EQ(kent["name"], "kent");
  EXPECT_EQ(kent["wrong"], json::array());
  EXPECT_LT(kent["beat_age_s"].get<double>(), 10.0);
  EXPECT_EQ(kent["rigs"][0]["device"], "streaming");
  EXPECT_EQ(kent["rigs"][0]["is_present"], true);
  EXPECT_NEAR(kent["rigs"][0]["calibration_age_d"].get<double>(), 20.0, 0.1);
}

TEST_F(PagesTest, ProblemsFirstThenByName_RevokedLast) {
  sql("INSERT INTO clinic (id, title, nkey, state) VALUES ('bath', 'Bath', 'U3', 'revoked'), ('ayr', 'Ayr', 'U4', 'active'), "
      "('york', 'York', 'U5', 'active')");
  add_beat("kent");
  add_beat("ayr");

  std::vector<std::string> names;
  for (const json& clinic : clinics()) names.push_back(clinic["name"]);
  EXPECT_THAT(names, ElementsAre("dover", "york", "ayr", "kent", "bath"));
  EXPECT_EQ(clinics()[4]["wrong"], json::array());  // a revoked clinic need not report
}

/// A change of a clinic that is well, and what is then wrong.
struct Change {
  std::string name;
  std::string statement;
  std::string wrong;
};
class WrongTest : public PagesTest, public ::testing::WithParamInterface<Change> {};

TEST_P(WrongTest, IsNamed) {
  add_beat("kent");
  sql(GetParam().statement);

  const json expected = GetParam().wrong.empty() ? json::array() : json::array({GetParam().wrong});
  EXPECT_EQ(kent()["wrong"], expected);
  EXPECT_EQ(kent()["rigs"][0]["has_old_calibration"], GetParam().wrong == "calibration");
}

INSTANTIATE_TEST_SUITE_P(
    Clinic, WrongTest,
    ::testing::Values(
        Change{"NoBeat", "UPDATE beat SET at = at - interval '31 s'; UPDATE rig SET at = at - interval '31 s'", "no_beat"},
        Change{"BeatOf25S", "UPDATE beat SET at = at - interval '25 s'; UPDATE rig SET at = at - interval '25 s'", ""},
        Change{"NoDaemon", "UPDATE beat SET has_daemon = false, daemon_version = '', disk_state = 'unspecified'", "no_daemon"},
        Change{"NoDevice", "UPDATE rig SET device = 'gone'", "no_device"}, Change{"WaitingDevice", "UPDATE rig SET device = 'waiting'", ""},
        Change{"Disk", "UPDATE beat SET disk_state = 'low'", "disk"}, Change{"Losses", "UPDATE rig SET lost_scans_total = 7", "losses"},
        Change{"RigThatIsGone", "UPDATE rig SET device = 'gone', lost_scans_total = 7, at = at - interval '1 hour'", ""},
        Change{"Held", "UPDATE beat SET held_files = 1", "held"},
        Change{"Backlog", "UPDATE beat SET backlog_oldest = now() - interval '25 hours'", "backlog"},
        Change{"BacklogOfToday", "UPDATE beat SET backlog_oldest = now() - interval '23 hours'", ""},
        Change{"Calibration", "UPDATE rig SET calibration_since = now() - interval '181 days'", "calibration"},
        Change{"NoCalibration", "UPDATE rig SET calibration = '', calibration_since = now() - interval '181 days'", ""},
        Change{"Clock", "UPDATE beat SET clock_offset_s = -1.1", "clock"},
        Change{"OldDaemon", "UPDATE beat SET daemon_version = '1.1.9'", "version"},
        Change{"OldForwarder", "UPDATE beat SET forwarder_version = '0.99'", "version"},
        Change{"NewerVersion", "UPDATE beat SET forwarder_version = '1.10.0'", ""},
        Change{"VersionOfAHostileClinic", "UPDATE beat SET forwarder_version = '99999999999999999999.1', daemon_version = 'x'", ""}),
    [](const auto& tested) { return tested.param.name; });

TEST_F(PagesTest, Clinic_HasHistoryAndNewestReceipts) {
  add_beat("kent");
  sql("INSERT INTO beat_history VALUES ('kent', '2026-11-24', 10, now(), now(), 0, 500, 9), ('kent', '2026-11-25', 10, now(), now(), 0, "
      "700, 9)");
  sql("INSERT INTO receipt SELECT 'kent', sha256(n::text::bytea), n, 'S' || n, 1, timestamptz '2026-11-25' + n * interval '1 min', "
      "'hub-1', "
      "'x' FROM generate_series(1, 12) n");

  const json page = read(clinic_page(*database_, "1.2.0", "kent"));
  EXPECT_EQ(page["clinic"]["name"], "kent");
  ASSERT_EQ(page["history"].size(), 2U);
  EXPECT_EQ(page["history"][1]["largest_backlog_bytes"], 700);
  ASSERT_EQ(page["receipts"].size(), 10U);
  EXPECT_EQ(page["receipts"][0]["session"], "S12");
  EXPECT_EQ(page["receipts"][9]["session"], "S3");
}

TEST_F(PagesTest, UnknownClinic_IsNotFound) {
  const auto page = clinic_page(*database_, "1.2.0", "bath");

  ASSERT_FALSE(page);
  EXPECT_EQ(page.error().code, core::ErrorCode::NotFound);
}

TEST_F(PagesTest, Sessions_NewestFirstInPagesByKey_NoneTwiceNoneMissing) {
  for (int number = 0; number < 7; ++number) {  // several at the same moment
    add_session(number % 2 == 0 ? "kent" : "dover", "S" + std::to_string(number),
                "2026-11-2" + std::to_string(number / 3) + " 10:00:00.123456Z");
  }
  std::vector<std::string> all;
  SessionFilter filter{.limit = 2};
  int pages = 0;
  for (; pages < 10; ++pages) {
    const json page = read(sessions_page(*database_, filter));
    for (const std::string& id : ids(page)) all.push_back(id);
    if (page["next"].is_null()) break;
    filter.before = parse_session_key(page["next"].get<std::string>());
    ASSERT_TRUE(filter.before.has_value());
  }
  EXPECT_EQ(pages, 3);
  EXPECT_THAT(all, ElementsAre("S6", "S4", "S5", "S3", "S2", "S0", "S1"));
}

TEST_F(PagesTest, Sessions_ByEachFilter_WithoutHiddenOnes) {
  add_session("kent", "A", "2026-11-20 10:00Z", "romberg", "P1");
  add_session("dover", "B", "2026-11-21 10:00Z", "reach", "P2");
  add_session("kent", "C", "2026-11-22 10:00Z", "reach", "P1");
  add_session("kent", "D", "2026-11-23 10:00Z");
  sql("UPDATE session SET rig = 'chair' WHERE id = 'B'; UPDATE session SET is_deleted = true WHERE id = 'D'");
  const auto of = [&](const SessionFilter& filter) { return ids(read(sessions_page(*database_, filter))); };

  EXPECT_THAT(of({}), ElementsAre("C", "B", "A"));
  EXPECT_THAT(of({.clinic = "kent"}), ElementsAre("C", "A"));
  EXPECT_THAT(of({.rig = "chair"}), ElementsAre("B"));
  EXPECT_THAT(of({.protocol = "reach"}), ElementsAre("C", "B"));
  EXPECT_THAT(of({.subject = "P1"}), ElementsAre("C", "A"));
  EXPECT_THAT(of({.since_ms = 1795240800000}), ElementsAre("C", "B"));  // 2026-11-21 06:00 UTC
  EXPECT_THAT(of({.clinic = "kent' OR 'a' = 'a"}), IsEmpty());
}

TEST_F(PagesTest, Session_SumsItsParts) {
  add_session("kent", "A", "2026-11-20 10:00Z");
  sql("INSERT INTO part (clinic, session, part, bytes, duration_s, valid_trials, store_key, rig, leading_part) VALUES "
      "('kent', 'A', 1, 5, 60, 2, 'x', 'floor', 0), ('kent', 'A', 2, 5, 30, 1, NULL, 'floor', 0), "
      "('kent', 'A', 3, 5, 30, 0, NULL, 'plate', 2)");

  const json session = read(sessions_page(*database_, {}))["sessions"][0];
  EXPECT_EQ(session["duration_s"], 90) << "the third was recorded at the same time as the second";
  EXPECT_EQ(session["valid_trials"], 3);
  EXPECT_EQ(session["parts"], 3);
  EXPECT_EQ(session["stored_parts"], 1);
  EXPECT_THAT(ids(read(sessions_page(*database_, {.rig = "plate"}))), ElementsAre("A"));
  EXPECT_EQ(session["started_ms"], 1795168800000);
}

TEST_F(PagesTest, EmptyCentre_HasEmptyLists) {
  EXPECT_EQ(read(sessions_page(*database_, {})), (json{{"sessions", json::array()}, {"next", nullptr}}));
  EXPECT_EQ(read(measures_page(*database_)), (json{{"measures", json::array()}, {"protocols", json::array()}}));
  EXPECT_EQ(read(trend_page(*database_, {.measure = "MVELO"})), (json{{"points", json::array()}}));
}

TEST_F(PagesTest, Measures_HaveUnitAndCount) {
  add_session("kent", "A", "2026-11-20 10:00Z", "reach");
  add_session("kent", "B", "2026-11-20 11:00Z");
  add_result("kent", "A", 1.0);
  add_result("kent", "B", 2.0);
  sql("INSERT INTO result (clinic, session, name, analysis, value, unit) VALUES ('kent', 'A', 'MVELO', 'sway 0.3.1', 5, 'mm/s')");

  const json page = read(measures_page(*database_));
  EXPECT_EQ(page["measures"], (json::array({{{"name", "MVELO"}, {"analysis", "clinic"}, {"unit", "mm/s"}, {"count", 2}},
                                            {{"name", "MVELO"}, {"analysis", "sway 0.3.1"}, {"unit", "mm/s"}, {"count", 1}}})));
  EXPECT_EQ(page["protocols"], json::array({"reach", "romberg"}));
}

TEST_F(PagesTest, MeasuresAndProtocols_AreLimited) {
  sql("INSERT INTO session (clinic, id, revision, rig, protocol, subject, state, started, planned_trials, is_deleted, fields) "
      "SELECT 'kent', 'S' || n, 1, 'floor', 'p' || n, 'P1', 'complete', now(), 4, false, '{}' FROM generate_series(1, 300) n");
  sql("INSERT INTO result (clinic, session, name, analysis, value, unit) SELECT 'kent', 'S1', 'M' || n, 'clinic', n, 'mm' FROM "
      "generate_series(1, 1500) n");

  const json page = read(measures_page(*database_));
  EXPECT_EQ(page["measures"].size(), std::size_t{kMostMeasures});
  EXPECT_EQ(page["protocols"].size(), std::size_t{kMostProtocols});
}

/// All pages as a role of the dashboard.
class DashboardRoleTest : public PagesTest {
 protected:
  void SetUp() override {
    PagesTest::SetUp();
    if (!database_) return;
    for (const char* clinic : {"kent", "dover"}) {
      add_beat(clinic);
      add_session(clinic, "A", "2026-11-20 10:00Z", "romberg");
      add_session(clinic, "B", "2026-11-20 11:00Z", "reach");
      for (const char* session : {"A", "B"}) {
        add_result(clinic, session, 1.0);
        const std::string key = std::string("'") + clinic + "', '" + session + "'";
        sql("INSERT INTO part (clinic, session, part, bytes, store_key) VALUES (" + key + ", 1, 5, 'k')");
        sql("INSERT INTO receipt VALUES ('" + std::string(clinic) + "', sha256('" + session + "'), 5, '" + session +
            "', 1, now(), 'hub-1', 'k')");
      }
    }
  }
  void become(const std::string& role, const std::string& group) {
    sql("DO $$ BEGIN IF NOT EXISTS (SELECT FROM pg_roles WHERE rolname = '" + role + "') THEN CREATE ROLE " + role +
        "; END IF; END $$; GRANT " + group + " TO " + role + "; SET ROLE " + role);
  }
  static std::set<std::string> clinics_of(const json& sessions) {
    std::set<std::string> found;
    for (const json& session : sessions["sessions"]) found.insert(session["clinic"]);
    return found;
  }
  void expect_rejected(const std::string& statement) {
    const auto done = database_->run(statement);
    ASSERT_FALSE(done) << statement;
    EXPECT_EQ(done.error().code, core::ErrorCode::NotAllowed) << statement;
  }
};

TEST_F(DashboardRoleTest, Dashboard_SeesAllClinics_AndChangesNothing) {
  become("desk", "dashboard");

  EXPECT_EQ(clinics().size(), 2U);
  EXPECT_EQ(clinics()[0]["rigs"].size(), 1U);
  EXPECT_EQ(read(clinic_page(*database_, "1.2.0", "kent"))["receipts"].size(), 2U);
  EXPECT_THAT(clinics_of(read(sessions_page(*database_, {}))), ElementsAre("dover", "kent"));
  EXPECT_EQ(read(measures_page(*database_))["measures"][0]["count"], 4);
  EXPECT_EQ(read(trend_page(*database_, {.measure = "MVELO"}))["points"].size(), 2U);
  for (const char* statement :
       {"DELETE FROM session", "UPDATE clinic SET title = ''", "INSERT INTO permit VALUES ('desk', 'kent')", "SELECT nkey FROM clinic",
        "SELECT notes FROM session", "SELECT fields FROM session", "SELECT * FROM audit", "SELECT * FROM job", "TRUNCATE receipt"}) {
    expect_rejected(statement);
  }
}

TEST_F(DashboardRoleTest, StudyDashboard_SeesWhatIsPermitted) {
  sql("INSERT INTO permit (role, clinic) VALUES ('anna', 'kent')");
  sql("INSERT INTO permit (role, clinic, protocol) VALUES ('bert', 'dover', 'reach')");
  become("anna", "study_dashboard");
  EXPECT_EQ(clinics().size(), 1U);
  EXPECT_THAT(clinics_of(read(sessions_page(*database_, {}))), ElementsAre("kent"));
  EXPECT_EQ(read(clinic_page(*database_, "1.2.0", "kent"))["receipts"].size(), 2U);
  EXPECT_EQ(clinic_page(*database_, "1.2.0", "dover").error().code, core::ErrorCode::NotFound);
  EXPECT_EQ(read(trend_page(*database_, {.measure = "MVELO"}))["points"].size(), 1U);
  sql("RESET ROLE");
  become("bert", "study_dashboard");
  const json page = read(sessions_page(*database_, {}));
  EXPECT_THAT(ids(page), ElementsAre("B"));
  EXPECT_EQ(page["sessions"][0]["stored_parts"], 1);
  EXPECT_EQ(read(clinic_page(*database_, "1.2.0", "dover"))["receipts"].size(), 1U);
  EXPECT_EQ(read(measures_page(*database_))["protocols"], json::array({"reach"}));
  sql("RESET ROLE");
  become("nobody_yet", "study_dashboard");
  EXPECT_THAT(clinics(), IsEmpty());
}

TEST_F(PagesTest, Trend_HasQuartilesOfEachWeekAndClinic) {
  for (int number = 1; number <= 5; ++number) {  // Monday to Friday
    const std::string id = "A" + std::to_string(number);
    add_session("kent", id, "2026-11-" + std::to_string(15 + number) + " 10:00Z", number == 5 ? "reach" : "romberg");
    add_result("kent", id, number * 10.0);
  }
  add_session("kent", "B", "2026-11-23 00:00Z");  // the next week begins
  add_result("kent", "B", 7.0);
  add_session("dover", "C", "2026-11-18 10:00Z");
  add_result("dover", "C", 3.0);
  constexpr std::int64_t kWeek = 1794787200000;  // Monday, 2026-11-16
  constexpr std::int64_t kNextWeek = kWeek + 7LL * 86'400'000;

  const auto of = [&](const TrendFilter& filter) { return read(trend_page(*database_, filter))["points"]; };
  EXPECT_EQ(of({.measure = "MVELO"}),
            (json::array({{"dover", kWeek, 1, 3, 3, 3}, {"kent", kWeek, 5, 20, 30, 40}, {"kent", kNextWeek, 1, 7, 7, 7}})));
  EXPECT_EQ(of({.measure = "MVELO", .protocol = "reach"}), (json::array({{"kent", kWeek, 1, 50, 50, 50}})));
  EXPECT_EQ(of({.measure = "MVELO", .clinic = "dover"}), (json::array({{"dover", kWeek, 1, 3, 3, 3}})));
  EXPECT_EQ(of({.measure = "MVELO", .since_ms = kNextWeek}), (json::array({{"kent", kNextWeek, 1, 7, 7, 7}})));
  EXPECT_EQ(of({.measure = "MVELO", .analysis = "sway 0.3.1"}), json::array());
}

TEST_F(PagesTest, HiddenSession_LeavesTheTrendAndReturns) {
  add_session("kent", "A", "2026-11-18 10:00Z");
  add_result("kent", "A", 3.0);
  const auto points = [&] { return read(trend_page(*database_, {.measure = "MVELO"}))["points"].size(); };

  EXPECT_EQ(points(), 1U);
  sql("UPDATE session SET is_deleted = true");
  EXPECT_EQ(points(), 0U);
  sql("UPDATE session SET is_deleted = false");
  EXPECT_EQ(points(), 1U);
}

TEST(SessionKeyTest, OnlyWhatAPageSaid) {
  EXPECT_EQ(parse_session_key("1700000000000000,kent,2026,A"), (SessionKey{1700000000000000, "kent", "2026,A"}));
  for (const char* text : {"", "17", "17,kent", "17,kent,", "17,Kent,A", "-1,kent,A", "99999999999999999999,kent,A",
                           "9300000000000000000,kent,A", ",kent,A"}) {
    EXPECT_FALSE(parse_session_key(text)) << text;
  }
}

}  // namespace
}  // namespace dts::fleet::desk
