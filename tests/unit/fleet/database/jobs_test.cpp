// SPDX-License-Identifier: Apache-2.0
#include "fleet/database/jobs.h"

#include "unit/fleet/database/catalogue_fixture.h"

namespace dts::fleet::database {
namespace {

class JobsTest : public CatalogueTest {
 protected:
  void SetUp() override {
    CatalogueTest::SetUp();
    if (IsSkipped()) return;
    put_session("kent", "s1", "romberg", "2026-11-20");
    put_session("kent", "s2", "reaching", "2026-11-22");
    put_session("york", "s3", "romberg", "2026-11-24");
    put_session("york", "hidden", "romberg", "2026-11-24", true);
    put_part("kent", "s1", 1, sum('1'), "objects/kent/1");
    put_part("kent", "s1", 2, sum('2'), "objects/kent/2");
    put_part("kent", "s2", 1, sum('3'), "objects/kent/3");
    put_part("kent", "s2", 2, sum('4'), "");
    put_part("york", "s3", 1, sum('5'), "objects/york/5");
    put_part("york", "hidden", 1, sum('6'), "objects/york/6");
  }
  static std::string sum(char digit) { return std::string(64, digit); }

  std::uint64_t add(const NewJobs& jobs) {
    const auto added = add_jobs(database(), jobs);
    EXPECT_TRUE(added) << added.error().what;
    return added.value_or(0);
  }
  [[nodiscard]] std::vector<Job> list(const JobFilter& filter = {}) { return list_jobs(database(), filter).value(); }
};

TEST_F(JobsTest, Add_TakesStoredRecordingsOfVisibleSessions_EachOnceForAVersion) {
  EXPECT_EQ(add({.kind = "sway", .version = "0.1.0"}), 4U);
  EXPECT_EQ(add({.kind = "sway", .version = "0.1.0"}), 0U);
  EXPECT_EQ(add({.kind = "sway", .version = "0.2.0"}), 4U);
  EXPECT_EQ(add({.kind = "replay", .version = "0.1.0"}), 4U);
}

TEST_F(JobsTest, Add_LeavesOutTheCompanionsOfALeadingRig) {
  sql("UPDATE part SET leading_part = 1 WHERE part > 1 OR session = 's3'");
  EXPECT_EQ(add({.kind = "sway", .version = "0.1.0"}), 2U);
}

TEST_F(JobsTest, Add_SelectsByClinicProtocolAndDay) {
  EXPECT_EQ(add({.kind = "a", .version = "1", .clinic = "kent"}), 3U);
  EXPECT_EQ(add({.kind = "b", .version = "1", .protocol = "romberg"}), 3U);
  EXPECT_EQ(add({.kind = "c", .version = "1", .since = "2026-11-22"}), 2U);
  EXPECT_EQ(add({.kind = "d", .version = "1", .clinic = "york", .protocol = "reaching"}), 0U);
}

TEST_F(JobsTest, Add_WithAWrongDay_IsRefused) {
  const auto added = add_jobs(database(), {.kind = "sway", .version = "1", .since = "2026-13-40"});
  ASSERT_FALSE(added);
  EXPECT_EQ(added.error().code, core::ErrorCode::InvalidArgument);
  EXPECT_EQ(list().size(), 0U);
}

TEST_F(JobsTest, Add_WakesTheWorkers) {
  Database worker({.connection = connection(), .name = "worker"});
  worker.listen("job");
  ASSERT_TRUE(worker.run("SELECT 1"));
  ASSERT_TRUE(worker.wait_notification(std::chrono::milliseconds(0)).value()) << "a new connection may have missed one";
  add({.kind = "sway", .version = "1"});
  EXPECT_TRUE(worker.wait_notification(std::chrono::seconds(60)).value());
}

TEST_F(JobsTest, Add_LeavesFreshStatistics_WhichTheWorkersStatementNeeds) {
  add({.kind = "sway", .version = "1"});
  EXPECT_EQ(number("SELECT reltuples FROM pg_class WHERE relname = 'job'"), 4);
}

TEST_F(JobsTest, List_ShowsTheNewestFirst_AndFilters) {
  add({.kind = "sway", .version = "0.1.0"});
  sql("UPDATE job SET state = 'failed', worker = 'w', tries = 5, message = 'dtslab crashed' WHERE session = 's3'");
  const auto failed = list({.state = "failed"});
  ASSERT_EQ(failed.size(), 1U);
  EXPECT_EQ(failed[0].clinic, "york");
  EXPECT_EQ(failed[0].session, "s3");
  EXPECT_EQ(failed[0].part, 1);
  EXPECT_EQ(failed[0].kind, "sway");
  EXPECT_EQ(failed[0].version, "0.1.0");
  EXPECT_EQ(failed[0].worker, "w");
  EXPECT_EQ(failed[0].tries, 5);
  EXPECT_EQ(failed[0].message, "dtslab crashed");
  EXPECT_EQ(list({.clinic = "kent"}).size(), 3U);
  EXPECT_EQ(list({.kind = "reach"}).size(), 0U);
  const auto two = list({.limit = 2});
  ASSERT_EQ(two.size(), 2U);
  EXPECT_GT(two[0].id, two[1].id);
}

TEST_F(JobsTest, Retry_MakesFailedJobsNew_AndNoOthers) {
  add({.kind = "sway", .version = "0.1.0"});
  sql("UPDATE job SET state = 'failed', worker = 'w', tries = 5, message = 'x' WHERE session IN ('s2', 's3')");
  sql("UPDATE job SET state = 'done', tries = 1 WHERE session = 's1' AND part = 1");
  EXPECT_EQ(retry_jobs(database(), {.clinic = "york"}).value(), 1U);
  EXPECT_EQ(list({.state = "failed"}).size(), 1U);
  EXPECT_EQ(retry_jobs(database(), {}).value(), 1U);
  EXPECT_EQ(number("SELECT count(*) FROM job WHERE state = 'waiting' AND tries = 0 AND message = '' AND worker IS NULL"), 3);
  EXPECT_EQ(list({.state = "done"}).size(), 1U);
}

}  // namespace
}  // namespace dts::fleet::database
