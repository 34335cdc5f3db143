// SPDX-License-Identifier: Apache-2.0
#include "fleet/worker/job_queue.h"

#include "fleet/database/jobs.h"
#include "unit/fleet/database/catalogue_fixture.h"

namespace dts::fleet::worker {
namespace {

class JobQueueTest : public database::CatalogueTest {
 protected:
  void SetUp() override {
    CatalogueTest::SetUp();
    if (IsSkipped()) return;
    put_session("kent", "s1");
    put_session("kent", "s2");
    put_part("kent", "s1", 1, std::string(64, 'a'), "objects/kent/a");
    put_part("kent", "s2", 1, std::string(64, 'b'), "objects/kent/b");
    sql("INSERT INTO result (clinic, session, name, analysis, value, unit) VALUES ('kent', 's1', 'eyes-open/MVELO', 'clinic', 8, 'mm/s')");
    ASSERT_EQ(database::add_jobs(database(), {.kind = "sway", .version = "0.1.0"}).value(), 2U);
    first_ = std::make_unique<JobQueue>(database(), QueueOptions{.worker = "first", .version = "0.1.0", .retry_pause = kNone});
    second_ = std::make_unique<JobQueue>(database(), QueueOptions{.worker = "second", .version = "0.1.0", .retry_pause = kNone});
  }

  [[nodiscard]] static TakenJob take(JobQueue& queue) {
    const auto job = queue.take();
    EXPECT_TRUE(job) << job.error().what;
    EXPECT_TRUE(job && *job);
    return job && *job ? **job : TakenJob{};
  }
  [[nodiscard]] static bool has_job(JobQueue& queue) { return queue.take().value().has_value(); }
  void end_leases() { sql("UPDATE job SET lease_until = now() - interval '1 second' WHERE state = 'running'"); }
  [[nodiscard]] std::string state(const TakenJob& job) { return text("SELECT state FROM job WHERE id = " + std::to_string(job.id)); }
  [[nodiscard]] std::int64_t results_of_ours() { return number("SELECT count(*) FROM result WHERE analysis <> 'clinic'"); }

  static constexpr std::chrono::seconds kNone{0};
  const std::vector<Figure> figures_{{.name = "eyes-open/MVELO", .value = 8.5, .unit = "mm/s", .details = R"({"trials": 2})"},
                                     {.name = "quote\"\\,{}", .value = -1.0, .unit = "1", .details = ""}};
  std::unique_ptr<JobQueue> first_;
  std::unique_ptr<JobQueue> second_;
};

TEST_F(JobQueueTest, Take_GivesEachJobToOneWorker_TheOldestFirst) {
  const TakenJob one = take(*first_);
  EXPECT_EQ(one.kind, "sway");
  EXPECT_EQ(one.clinic, "kent");
  EXPECT_EQ(one.session, "s1");
  EXPECT_EQ(one.part, 1U);
  EXPECT_EQ(one.tries, 1);
  EXPECT_EQ(one.sha256, std::string(64, 'a'));
  EXPECT_EQ(one.store_key, "objects/kent/a");
  EXPECT_EQ(take(*second_).session, "s2");
  EXPECT_FALSE(has_job(*first_));
}

TEST_F(JobQueueTest, Take_SkipsAJobThatAnotherTransactionTakes) {
  database::Database other({.connection = connection(), .name = "other"});
  ASSERT_TRUE(other.run_script("BEGIN; SELECT FROM job WHERE session = 's1' FOR UPDATE"));
  EXPECT_EQ(take(*first_).session, "s2");
  ASSERT_TRUE(other.run_script("ROLLBACK"));
}

TEST_F(JobQueueTest, Take_LeavesOtherVersionsAndKinds) {
  JobQueue newer(database(), {.worker = "newer", .version = "0.2.0"});
  EXPECT_FALSE(has_job(newer));
  sql("UPDATE job SET kind = 'thin'");
  EXPECT_FALSE(has_job(*first_));
}

TEST_F(JobQueueTest, Finish_WritesResultsBesideThoseOfTheClinic) {
  const TakenJob job = take(*first_);
  EXPECT_TRUE(first_->finish(job, figures_, "1 was not usable").value());
  EXPECT_EQ(state(job), "done");
  EXPECT_EQ(text("SELECT message FROM job WHERE state = 'done'"), "1 was not usable");
  EXPECT_EQ(number("SELECT value FROM result WHERE analysis = 'clinic'"), 8);
  EXPECT_EQ(text("SELECT c.name || ' ' || o.value - c.value || ' ' || (o.details ->> 'trials') FROM result c JOIN result o "
                 "USING (clinic, session, name) WHERE c.analysis = 'clinic' AND o.analysis = 'sway 0.1.0'"),
            "eyes-open/MVELO 0.5 2");
  EXPECT_EQ(number("SELECT count(*) FROM result WHERE name = 'quote\"\\,{}' AND details IS NULL"), 1);
}

TEST_F(JobQueueTest, Finish_AfterARepeatedJob_ReplacesItsResults) {
  EXPECT_TRUE(first_->finish(take(*first_), figures_, "").value());
  sql("UPDATE job SET state = 'waiting', tries = 0 WHERE session = 's1'");
  EXPECT_TRUE(first_->finish(take(*first_), {{.name = "eyes-open/MVELO", .value = 9.0, .unit = "mm/s", .details = ""}}, "").value());
  EXPECT_EQ(number("SELECT value FROM result WHERE name = 'eyes-open/MVELO' AND analysis = 'sway 0.1.0'"), 9);
}

TEST_F(JobQueueTest, JobThatWasNotRenewed_IsTakenAgain_AndTheFirstWorkerWritesNothing) {
  sql("DELETE FROM job WHERE session = 's2'");
  const TakenJob mine = take(*first_);
  EXPECT_TRUE(first_->renew(mine).value());
  end_leases();
  const TakenJob theirs = take(*second_);
  EXPECT_EQ(theirs.id, mine.id);
  EXPECT_EQ(theirs.tries, 2);
  EXPECT_FALSE(first_->renew(mine).value());
  EXPECT_FALSE(first_->finish(mine, figures_, "").value());
  EXPECT_FALSE(first_->fail(mine, "x", true).value());
  EXPECT_FALSE(first_->postpone(mine, "x").value());
  EXPECT_FALSE(first_->give_back(mine).value());
  EXPECT_EQ(results_of_ours(), 0);
  EXPECT_EQ(state(mine), "running");
  EXPECT_TRUE(second_->finish(theirs, figures_, "").value());
  EXPECT_EQ(results_of_ours(), 2);
}

TEST_F(JobQueueTest, Renewed_IsNotTakenAgain) {
  const TakenJob job = take(*first_);
  end_leases();
  EXPECT_TRUE(first_->renew(job).value());
  EXPECT_EQ(take(*second_).session, "s2");
  EXPECT_FALSE(has_job(*second_));
}

TEST_F(JobQueueTest, SessionThatWasErased_HasNoResults) {
  const TakenJob job = take(*first_);
  for (const char* const table : {"part", "job"}) sql(std::string("DELETE FROM ") + table + " WHERE session = 's1'");
  sql("DELETE FROM session WHERE id = 's1'");
  EXPECT_FALSE(first_->renew(job).value());
  EXPECT_FALSE(first_->finish(job, figures_, "").value());
  EXPECT_EQ(number("SELECT count(*) FROM result"), 0);
}

TEST_F(JobQueueTest, ErasureDuringTheWriting_RemovesTheResults) {
  const TakenJob job = take(*first_);
  database::Database eraser({.connection = connection(), .name = "eraser", .statement_timeout = std::chrono::milliseconds(300)});
  ASSERT_TRUE(database().run_script("BEGIN"));
  ASSERT_TRUE(database().run("UPDATE job SET state = 'done' WHERE id = $1", {job.id}));
  const auto waits = eraser.run("DELETE FROM job WHERE session = 's1'");
  ASSERT_FALSE(waits) << "the erasure waits for the transaction that writes the results";
  sql("INSERT INTO result VALUES ('kent', 's1', 'x', 'sway 0.1.0', 1, '1')");
  ASSERT_TRUE(database().run_script("COMMIT"));
  ASSERT_TRUE(eraser.run("DELETE FROM session WHERE id = 's1'"));
  EXPECT_EQ(number("SELECT count(*) FROM result"), 0);
}

TEST_F(JobQueueTest, JobThatFails_IsTriedFiveTimes) {
  sql("DELETE FROM job WHERE session = 's2'");
  for (int tries = 1; tries <= JobQueue::kMostTries; ++tries) {
    const TakenJob job = take(*first_);
    EXPECT_EQ(job.tries, tries);
    EXPECT_TRUE(first_->fail(job, "dtslab crashed", false).value());
  }
  EXPECT_FALSE(has_job(*first_));
  EXPECT_EQ(text("SELECT state || ': ' || message FROM job"), "failed: dtslab crashed");
}

TEST_F(JobQueueTest, NewJobs_GoBeforeThoseThatFailed) {
  const TakenJob job = take(*first_);
  EXPECT_TRUE(first_->fail(job, "dtslab crashed", false).value());
  EXPECT_EQ(take(*first_).session, "s2");
  EXPECT_EQ(take(*first_).id, job.id);
}

TEST_F(JobQueueTest, JobThatCannotSucceed_FailsAtOnce) {
  const TakenJob job = take(*first_);
  EXPECT_TRUE(first_->fail(job, "no stream cop", true).value());
  EXPECT_EQ(state(job), "failed");
}

TEST_F(JobQueueTest, NextTry_WaitsForThePause) {
  sql("DELETE FROM job WHERE session = 's2'");
  JobQueue patient(database(), {.worker = "patient", .version = "0.1.0", .retry_pause = std::chrono::hours(1)});
  EXPECT_TRUE(patient.fail(take(patient), "x", false).value());
  EXPECT_FALSE(has_job(patient));
  sql("UPDATE job SET lease_until = now() - interval '1 second'");
  EXPECT_TRUE(has_job(patient));
}

TEST_F(JobQueueTest, JobWhoseWorkersAllEnd_Fails) {
  sql("DELETE FROM job WHERE session = 's2'");
  for (int tries = 1; tries <= JobQueue::kMostTries; ++tries) {
    EXPECT_EQ(take(*first_).tries, tries);
    end_leases();
  }
  EXPECT_FALSE(has_job(*second_));
  EXPECT_EQ(text("SELECT state || ': ' || message FROM job"), "failed: the worker ended during each try");
}

TEST_F(JobQueueTest, JobThatIsGivenBack_IsAsNew) {
  EXPECT_TRUE(first_->give_back(take(*first_)).value());
  const TakenJob job = take(*second_);
  EXPECT_EQ(job.session, "s1");
  EXPECT_EQ(job.tries, 1);
}

TEST_F(JobQueueTest, Postpone_IsNoTry_AndLetsOthersTakeATurn) {
  JobQueue queue(database(), {.worker = "patient", .version = "0.1.0", .retry_pause = std::chrono::seconds(100)});
  for (int times = 0; times <= JobQueue::kMostTries; ++times) {
    const TakenJob job = take(queue);
    EXPECT_EQ(job.session, "s1");
    EXPECT_EQ(job.tries, 1);
    EXPECT_TRUE(queue.postpone(job, "the store is away").value());
    EXPECT_EQ(text("SELECT state || tries || message FROM job WHERE session = 's1'"), "waiting0the store is away");
    EXPECT_EQ(number("SELECT count(*) FROM job WHERE lease_until > now() + interval '400 seconds'"), 1);
    const TakenJob next = take(queue);
    EXPECT_EQ(next.session, "s2");
    EXPECT_TRUE(queue.give_back(next).value());
    sql("UPDATE job SET lease_until = now() - interval '1 second' WHERE session = 's1'");
  }
}

TEST_F(JobQueueTest, RecordingThatTheCatalogueLost_HasNoKey) {
  sql("DELETE FROM part WHERE session = 's1'");
  const TakenJob job = take(*first_);
  EXPECT_EQ(job.store_key, "");
  EXPECT_EQ(job.sha256, "");
}

TEST_F(JobQueueTest, RoleWorker_CanDoThis_AndChangesNothingOfTheClinic) {
  sql("DROP ROLE IF EXISTS dts_worker");
  sql("CREATE ROLE dts_worker LOGIN IN ROLE worker");
  database::Database restricted({.connection = connection("dts_worker"), .name = "worker"});
  JobQueue queue(restricted, {.worker = "restricted", .version = "0.1.0"});
  const TakenJob job = take(queue);
  EXPECT_EQ(job.store_key, "objects/kent/a");
  EXPECT_TRUE(queue.renew(job).value());
  const auto finished = queue.finish(job, figures_, "");
  ASSERT_TRUE(finished) << finished.error().what;
  EXPECT_TRUE(*finished);
  EXPECT_TRUE(queue.fail(take(queue), "x", true).value());
  EXPECT_EQ(restricted.run("UPDATE result SET value = 0 WHERE analysis = 'clinic'").value().changed(), 0U);
  EXPECT_EQ(restricted.run("INSERT INTO result VALUES ('kent', 's1', 'x', 'clinic', 1, '1')").error().code, core::ErrorCode::NotAllowed);
  for (const char* const statement : {"DELETE FROM result", "SELECT subject FROM session", "INSERT INTO job (kind) VALUES ('x')",
                                      "UPDATE part SET bytes = 0", "SELECT nkey FROM clinic", "SELECT FROM audit"}) {
    const auto refused = restricted.run(statement);
    ASSERT_FALSE(refused) << statement;
    EXPECT_EQ(refused.error().code, core::ErrorCode::NotAllowed) << statement;
  }
}

}  // namespace
}  // namespace dts::fleet::worker
