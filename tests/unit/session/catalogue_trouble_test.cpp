// SPDX-License-Identifier: Apache-2.0
// What becomes of sessions and audit trail when the catalogue or the clock fails.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>
#include <fstream>

#include "recordings_fixture.h"

namespace dts::session {
namespace {

using ::testing::HasSubstr;

class CatalogueTroubleTest : public RecordingsTest {
 protected:
  /// As a full disk does it: nothing can be written until it is closed.
  [[nodiscard]] sqlite3* hold_catalogue() const {
    sqlite3* other = nullptr;
    EXPECT_EQ(sqlite3_open((folder_ / "catalogue.sqlite").c_str(), &other), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(other, "BEGIN EXCLUSIVE", nullptr, nullptr, nullptr), SQLITE_OK);
    return other;
  }
};

TEST_F(CatalogueTroubleTest, DamagedCatalogue_IsSetAsideAndMadeAnewFromTheRecordings) {
  RecordProperty("requirement", "REC-10");
  start();
  const std::string id = record(300, {.subject = "P017"});
  ASSERT_TRUE(stop());
  end();
  std::ofstream(folder_ / "catalogue.sqlite", std::ios::binary) << std::string(100'000, 'x');

  start();

  EXPECT_EQ(row(id).state, "complete");
  EXPECT_EQ(row(id).subject, "P017");
  EXPECT_THAT(recordings_->notice(), HasSubstr("rebuilt the catalogue from the recordings, except the audit trail"));
  const auto trail = recordings_->catalogue().audit(10).value();
  ASSERT_EQ(trail.size(), 2U) << "and the start";
  EXPECT_EQ(trail[0].what, "catalogue_rebuilt");
  EXPECT_EQ(std::filesystem::file_size(trail[0].target), 100'000U) << "nothing is deleted";
  EXPECT_TRUE(recordings_->catalogue().verify_audit());
  end();
  start();
  EXPECT_EQ(recordings_->notice(), "") << "once is enough";
}

/// Shows always the same instant.
class StoppedClock : public core::Clock {
 public:
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return 1'000'000'000; }
  void sleep_until_ns(std::int64_t) noexcept override {}
  [[nodiscard]] std::int64_t utc_minus_monotonic_ns() const noexcept override { return 1'700'000'000'000'000'000; }
};

TEST_F(CatalogueTroubleTest, CatalogueDamagedTwiceAtOneInstant_IsKeptTwice) {
  StoppedClock stopped;
  std::vector<std::string> kept;
  for (const std::size_t size : {100'000U, 200'000U}) {
    std::ofstream(folder_ / "catalogue.sqlite", std::ios::binary) << std::string(size, 'x');
    const auto recordings = Recordings::open(storage_, stopped, core::Log()).value();
    kept.push_back(recordings->catalogue().audit(1).value().at(0).target);
  }

  EXPECT_EQ(std::filesystem::file_size(kept[0]), 100'000U);
  EXPECT_EQ(std::filesystem::file_size(kept[1]), 200'000U);
}

TEST_F(CatalogueTroubleTest, PowerCutWhileACatalogueIsSetAside_LosesNoneOfItsFiles) {
  StoppedClock stopped;
  const std::string damaged = (folder_ / "catalogue.sqlite").string();
  std::ofstream(damaged + "-wal") << "log";  // the database has been renamed, this not yet
  std::ofstream(damaged + ".audit") << "trail";

  const auto recordings = Recordings::open(storage_, stopped, core::Log()).value();

  std::size_t kept = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("catalogue.sqlite.damaged-")) continue;
    EXPECT_EQ(entry.file_size(), name.ends_with("-wal") ? 3U : 5U) << name;
    ++kept;
  }
  EXPECT_EQ(kept, 2U);
  EXPECT_EQ(recordings->catalogue().audit(1).value().at(0).what, "catalogue_rebuilt");
  EXPECT_THAT(recordings->notice(), HasSubstr("catalogue.sqlite is missing, but files that belong to it exist; dtsd kept it as"));
  EXPECT_TRUE(recordings->catalogue().verify_audit());
}

TEST_F(CatalogueTroubleTest, AuditThatTheCatalogueRefuses_IsEnteredLater) {
  start();
  sqlite3* other = hold_catalogue();
  recordings_->enter_audit({.utc_ns = 1, .who = "local", .what = "mark", .target = "floor", .result = "ok"});
  recordings_->enter_audit({.utc_ns = 2, .who = "local", .what = "tare", .target = "floor", .result = "ok"});
  EXPECT_NE(recordings_->audit_problem(), "");
  sqlite3_close(other);

  ASSERT_TRUE(eventually([&] { return recordings_->audit_problem().empty(); }));

  const auto trail = recordings_->catalogue().audit(10).value();
  ASSERT_EQ(trail.size(), 3U);
  EXPECT_EQ(trail[0].who + " " + trail[0].what + " " + trail[0].target + "|" + trail[0].result, "dtsd start |ok");
  EXPECT_EQ(trail[1].what, "mark");
  EXPECT_EQ(trail[2].what, "tare");
  EXPECT_TRUE(recordings_->catalogue().verify_audit());
}

TEST_F(CatalogueTroubleTest, MoreAuditThanIsKept_IsCountedInTheTrail) {
  start();
  std::uint64_t number = 1;  // of the start
  for (const int lost : {7, 3}) {
    sqlite3* other = hold_catalogue();
    for (int entry = 0; entry < 1000 + lost; ++entry)
      recordings_->enter_audit({.utc_ns = entry, .who = "local", .what = "mark", .result = "ok"});
    sqlite3_close(other);

    ASSERT_TRUE(eventually([&] { return recordings_->audit_problem().empty(); }));

    const auto newest = recordings_->catalogue().audit(1).value().at(0);
    EXPECT_EQ(newest.number, number += 1001);
    EXPECT_EQ(newest.what + " " + newest.target + " " + newest.result, "audit_lost " + std::to_string(lost) + " entries failed");
    EXPECT_NEAR(static_cast<double>(newest.utc_ns - clock_.now_ns() - clock_.utc_minus_monotonic_ns()), 0.0, 60e9);
  }
}

TEST_F(CatalogueTroubleTest, WallClockThatIsSetBack_EndsNoSessionBeforeItBegan) {
  start();
  const std::string id = record(100);
  clock_.set_by_ns = -3'600'000'000'000;
  ASSERT_TRUE(stop());
  EXPECT_GT(row(id).ended_utc_ns, row(id).started_utc_ns);
}

}  // namespace
}  // namespace dts::session
