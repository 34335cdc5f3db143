// SPDX-License-Identifier: Apache-2.0
// The program dts-worker in processes of their own, with scripts in the place of dtslab.
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <optional>
#include <random>
#include <thread>
#include <vector>

#include "files/whole_file.h"
#include "fleet/database/jobs.h"
#include "fleet/worker/job_queue.h"
#include "record/sha256.h"
#include "support/s3_server.h"
#include "support/sanitized.h"
#include "unit/fleet/database/catalogue_fixture.h"
#include "unit/fleet/worker/script_fixture.h"

namespace dts::fleet::worker {
namespace {

using ::testing::HasSubstr;

/// A process of dts-worker. Its end kills it.
class Process {
 public:
  /// `log`: file of its stderr; empty: ours.
  explicit Process(const std::string& configuration, const std::string& log = {}) : pid_(::fork()) {
    if (pid_ != 0) return;
    if (!log.empty() && std::freopen(log.c_str(), "w", stderr) == nullptr) ::_exit(126);
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    ::setenv("TMPDIR", std::filesystem::path(configuration).parent_path().c_str(), 1);  // a worker that is killed leaves a folder there
    ::execl(DTS_WORKER, "dts-worker", "run", "--config", configuration.c_str(), static_cast<char*>(nullptr));
    ::_exit(127);
  }
  ~Process() { static_cast<void>(end(SIGKILL)); }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// Returns its status, as of waitpid.
  int end(int signal) {
    if (pid_ <= 0) return status_;
    ::kill(pid_, signal);
    ::waitpid(pid_, &status_, 0);
    pid_ = 0;
    return status_;
  }
  /// Waits for its end.
  int wait() {
    ::waitpid(pid_, &status_, 0);
    pid_ = 0;
    return status_;
  }

 private:
  pid_t pid_;
  int status_ = 0;
};

class WorkerTest : public database::CatalogueTest {
 protected:
  void SetUp() override {
    CatalogueTest::SetUp();
    if (IsSkipped()) return;
    std::filesystem::create_directories(folder_.path() + "/objects/kent");
  }

  /// A recording whose content is `text`, and which is therefore what the script does.
  void store(const std::string& session, const std::string& text) {
    const std::string sum = record::sha256_of(text);
    std::ofstream(folder_.path() + "/objects/kent/" + sum) << text;
    put_session("kent", session);
    put_part("kent", session, 1, sum, "objects/kent/" + sum);
  }
  void add_jobs(const std::string& kind = "sway") {
    const auto added = database::add_jobs(database(), {.kind = kind, .version = "9.9"});
    ASSERT_TRUE(added) << added.error().what;
  }
  /// The first line of a recording is a command for the script.
  std::string configuration(const std::string& limits = "time_s = 60", const std::optional<s3::Settings>& bucket = std::nullopt) {
    write_script(folder_.path() + "/dtslab",
                 "[ \"$1\" = --version ] && echo 'dtslab 9.9' && exit\n"
                 "result() { echo '{\"summary\": [{\"name\": \"eyes-open/MVELO\", \"value\": 8.5, \"unit\": \"mm/s\"}]}'; }\n"
                 "read -r command rest < \"$2\"\n"
                 "case $command in\n"
                 "  result) result;;\n"
                 "  wait) while [ ! -e \"" +
                     folder_.path() +
                     "/go\" ]; do :; done; result;;\n"
                     "  crash) kill -SEGV $$;;\n"
                     "  hang) exec sleep 1000;;\n"
                     "  garbage) echo '{\"summary\": ['; echo 'out of luck' >&2; exit 1;;\n"
                     "  flood) exec head -c 1000000000 /dev/zero;;\n"
                     "  refuse) echo '{\"error\": {\"code\": \"not_found\", \"message\": \"no stream cop\"}}'; exit 5;;\n"
                     "esac");
    const std::string file = folder_.path() + "/worker.toml";
    std::ofstream(file) << "dtslab = \"dtslab\"\n[database]\nconnection = \"" << connection() << "\"\n[store]\ndirectory = \".\"\n"
                        << "[limits]\n"
                        << limits << "\n[jobs]\nlease_s = 2\nretry_pause_s = 0\n";
    if (bucket) {
      std::ofstream(file, std::ios::app) << "[store.s3]\nendpoint = \"" << bucket->endpoint << "\"\nbucket = \"" << bucket->bucket
                                         << "\"\nregion = \"" << bucket->region << "\"\ncredentials = \"" << bucket->credentials_file
                                         << "\"\n";
    }
    return file;
  }
  /// Waits until the statement's number is at least this one; not after a minute without progress.
  void wait_for(const std::string& statement, std::int64_t least) {
    std::int64_t last = number(statement);
    for (int looks = 0; looks < 6000 && last < least; ++looks) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      const std::int64_t now = number(statement);
      if (now != last) looks = 0;
      last = now;
    }
    ASSERT_GE(last, least) << statement;
  }
  void wait_for_state(const std::string& session, const std::string& state) {
    wait_for("SELECT count(*) FROM job WHERE session = '" + session + "' AND state = '" + state + "'", 1);
  }
  void go() { std::ofstream(folder_.path() + "/go") << "go"; }
  [[nodiscard]] std::string message(const std::string& session) {
    return text("SELECT message FROM job WHERE session = '" + session + "'");
  }
  [[nodiscard]] std::int64_t results(const std::string& session) {
    return number("SELECT count(*) FROM result WHERE session = '" + session + "'");
  }

  test::TemporaryFolder folder_{};
};

/// DTS_WORKER_JOBS=10000: the number of jobs.
TEST_F(WorkerTest, WorkersThatAreKilled_EachResultOnce_NoJobLost) {
  const char* const asked = std::getenv("DTS_WORKER_JOBS");
  const std::int64_t jobs = asked == nullptr ? 200 : std::atoll(asked);
  constexpr int kKills = 10;
  const std::string sum = record::sha256_of("result");
  std::ofstream(folder_.path() + "/objects/kent/" + sum) << "result";
  sql("INSERT INTO session (clinic, id, revision, rig, protocol, state, started, planned_trials, is_deleted, fields) "
      "SELECT 'kent', 's' || n, 1, 'floor', 'romberg', 'complete', now(), 4, false, '{}' FROM generate_series(1, $1) n",
      {jobs});
  sql("ALTER TABLE part DROP CONSTRAINT part_clinic_sha256_key");  // the same file is enough here
  sql("INSERT INTO part (clinic, session, part, sha256, bytes, store_key) SELECT 'kent', 's' || n, 1, decode($2, 'hex'), 1, $3 "
      "FROM generate_series(1, $1) n",
      {jobs, sum, "objects/kent/" + sum});
  ASSERT_TRUE(
      database().run_script("CREATE TABLE written (session text); CREATE FUNCTION note() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN "
                            "INSERT INTO written VALUES (NEW.session); RETURN NEW; END $$; "
                            "CREATE TRIGGER note AFTER INSERT OR UPDATE ON result FOR EACH ROW EXECUTE FUNCTION note()"));
  add_jobs();

  const auto begin = std::chrono::steady_clock::now();
  const std::string file = configuration();
  std::vector<std::unique_ptr<Process>> workers(4);
  for (auto& worker : workers) worker = std::make_unique<Process>(file);
  std::mt19937 random(1);
  for (int kill = 1; kill <= kKills; ++kill) {
    wait_for("SELECT count(*) FROM job WHERE state = 'done'", kill * jobs / (kKills + 1));
    auto& worker = workers.at(random() % workers.size());
    worker = nullptr;
    worker = std::make_unique<Process>(file);
  }
  wait_for("SELECT count(*) FROM job WHERE state = 'done'", jobs);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;

  EXPECT_EQ(number("SELECT count(*) FROM job"), jobs);
  EXPECT_EQ(number("SELECT count(*) FROM result WHERE analysis = 'sway 9.9' AND value = 8.5"), jobs);
  EXPECT_EQ(number("SELECT count(*) FROM written"), jobs);
  EXPECT_EQ(number("SELECT count(DISTINCT session) FROM written"), jobs);
  std::cout << jobs << " jobs, 4 workers, " << kKills << " killed: " << time.count() << " s, "
            << number("SELECT count(*) FROM job WHERE tries > 1") << " jobs taken again\n";
}

TEST_F(WorkerTest, RecordingsOnWhichDtslabFails_EndWithAMessage_AndTheWorkerGoesOn) {
  for (const char* const what : {"crash", "hang", "garbage", "flood", "refuse"}) store(what, what);
  store("damaged", "result of a damaged disk");
  std::ofstream(folder_.path() + "/objects/kent/" + record::sha256_of("result of a damaged disk")) << "other";
  store("good", "result");
  add_jobs();
  Process worker(configuration("time_s = 1"));
  for (const char* const what : {"crash", "hang", "garbage", "flood", "refuse", "damaged"}) wait_for_state(what, "failed");
  wait_for_state("good", "done");

  EXPECT_THAT(message("crash"), HasSubstr("Segmentation fault"));
  EXPECT_THAT(message("hang"), HasSubstr("did not end within 1 s"));
  EXPECT_THAT(message("garbage"), HasSubstr("no JSON document (out of luck"));
  EXPECT_THAT(message("flood"), HasSubstr("more than 16777216 bytes"));
  EXPECT_THAT(message("refuse"), HasSubstr("no stream cop"));
  EXPECT_THAT(message("damaged"), HasSubstr("SHA-256 differs"));
  EXPECT_EQ(number("SELECT tries FROM job WHERE session = 'crash'"), 5);
  EXPECT_EQ(number("SELECT tries FROM job WHERE session = 'refuse'"), 1);
  EXPECT_EQ(number("SELECT count(*) FROM result"), 1);
  EXPECT_EQ(results("good"), 1);
}

TEST_F(WorkerTest, SessionThatIsErasedWhileItsJobRuns_HasNoResult) {
  store("erased", "wait");
  add_jobs();
  Process worker(configuration());
  wait_for_state("erased", "running");
  for (const char* const table : {"part", "job"}) sql(std::string("DELETE FROM ") + table + " WHERE session = 'erased'");
  sql("DELETE FROM session WHERE id = 'erased'");
  go();
  store("next", "result");
  add_jobs();
  wait_for_state("next", "done");

  EXPECT_EQ(number("SELECT count(*) FROM result"), 1);
  EXPECT_EQ(results("next"), 1);
}

TEST_F(WorkerTest, WorkerThatLostItsJob_WritesNothing_AndGoesOn) {
  store("lost", "wait");
  add_jobs();
  Process worker(configuration());
  wait_for_state("lost", "running");
  sql("UPDATE job SET worker = 'other', tries = tries + 1, lease_until = now() + interval '1 hour'");
  go();
  store("next", "result");
  add_jobs();
  wait_for_state("next", "done");

  EXPECT_EQ(results("lost"), 0);
  EXPECT_EQ(text("SELECT state || worker FROM job WHERE session = 'lost'"), "runningother");
}

TEST_F(WorkerTest, LongJob_IsRenewed) {
  store("long", "wait");
  add_jobs();
  Process worker(configuration());
  wait_for_state("long", "running");
  const std::string first = text("SELECT lease_until FROM job");
  wait_for("SELECT count(*) FROM job WHERE lease_until > '" + first + "'::timestamptz + interval '2 seconds'", 1);
  EXPECT_EQ(number("SELECT tries FROM job"), 1);
  go();
  wait_for_state("long", "done");
}

TEST_F(WorkerTest, Signal_EndsTheWorker_AndGivesItsJobBack) {
  store("long", "wait");
  add_jobs();
  Process worker(configuration());
  wait_for_state("long", "running");
  EXPECT_EQ(worker.end(SIGTERM), 0);
  EXPECT_EQ(text("SELECT state || tries FROM job"), "waiting0");
}

TEST_F(WorkerTest, DatabaseThatEndsMeanwhile_HasTheResultAfterwards) {
  store("long", "wait");
  add_jobs();
  Process worker(configuration());
  wait_for_state("long", "running");
  server()->stop(SIGQUIT);
  go();
  server()->start();
  while (!database().run("SELECT 1")) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  wait_for_state("long", "done");
  EXPECT_EQ(results("long"), 1);
}

TEST_F(WorkerTest, StoreThatDoesNotAnswer_CostsNoTry) {
  const test::S3Server s3;
  store("patient", "result");
  const std::string key = "objects/kent/" + record::sha256_of("result");
  std::filesystem::copy_file(folder_.path() + "/" + key, s3.object(key));
  add_jobs();
  s3.set_fault("GET 503");
  const std::string file = configuration("time_s = 60", s3.settings());
  Process worker(file);
  const auto gets = [&] {
    const std::string text = s3.requests();
    int count = 0;
    for (std::size_t at = text.find("GET /"); at != std::string::npos; at = text.find("GET /", at + 1)) ++count;
    return count;
  };
  for (int before = 0; before <= JobQueue::kMostTries; before = gets()) {
    ASSERT_EQ(text("SELECT state FROM job WHERE state <> 'running' UNION ALL SELECT 'waiting' LIMIT 1"), "waiting") << before;
    sql("NOTIFY job");  // else it looks 10 s later
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  wait_for("SELECT count(*) FROM job WHERE message LIKE '%S3 answers 503%'", 1);
  EXPECT_EQ(number("SELECT count(*) FROM job WHERE state = 'failed' OR tries > 1"), 0);
  s3.set_fault("");
  for (int looks = 0; looks < 6000 && results("patient") == 0; ++looks) {
    sql("NOTIFY job");
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_EQ(results("patient"), 1);
}

TEST_F(WorkerTest, OtherKinds_HaveTheirOwnResults) {
  store("part", "{\"is_identical\": true}");
  const std::string file = configuration();
  write_script(folder_.path() + "/dtslab",
               "[ \"$1\" = --version ] && echo 'dtslab 9.9' && exit\n"
               "[ \"$1\" = replay ] && { read -r text < \"$2\"; echo \"$text\"; exit; }\n"
               "[ \"$1 $2\" = 'reach results' ] && echo '{\"summary\": [{\"name\": \"trials\", \"value\": 9, \"unit\": \"1\"}]}'");
  add_jobs("replay");
  add_jobs("reach");
  Process worker(file);
  wait_for("SELECT count(*) FROM job WHERE state = 'done'", 2);
  EXPECT_EQ(text("SELECT name || ' ' || value FROM result WHERE analysis = 'replay 9.9'"), "replay/is_identical 1");
  EXPECT_EQ(text("SELECT name || ' ' || value FROM result WHERE analysis = 'reach 9.9'"), "trials 9");
}

TEST_F(WorkerTest, RealDtslab_RunsWithinItsLimits) {
  if (test::kIsSanitized) GTEST_SKIP() << "the sanitizers need more address space than any limit allows";
  const std::string recording = folder_.path() + "/simulated.xdf";
  const std::string simulate = std::string(DTS_LAB) + " simulate floor --duration 12 --out " + recording + " > /dev/null";
  ASSERT_EQ(std::system(simulate.c_str()), 0);
  const std::string bytes = files::read_whole_file(recording, 100 << 20).value();
  store("simulated", bytes);
  const std::string file = configuration();
  std::filesystem::remove(folder_.path() + "/dtslab");
  std::filesystem::create_symlink(DTS_LAB, folder_.path() + "/dtslab");
  for (const char* const kind : {"sway", "reach", "replay"}) {
    ASSERT_TRUE(database::add_jobs(database(), {.kind = kind, .version = DTS_VERSION}));
  }
  Process worker(file);
  wait_for("SELECT count(*) FROM job WHERE state IN ('done', 'failed')", 3);
  EXPECT_EQ(text("SELECT string_agg(kind || ' ' || state || message, ', ' ORDER BY kind) FROM job"), "reach done, replay done, sway done");
  EXPECT_EQ(text("SELECT name || ' ' || value FROM result WHERE analysis = 'replay " DTS_VERSION "'"), "replay/is_identical 1");
}

TEST_F(WorkerTest, NewDtslab_TakesTheJobsOfItsVersion) {
  store("new", "result");
  add_jobs();
  const std::string file = configuration();
  const std::string real = folder_.path() + "/dtslab";
  std::filesystem::rename(real, real + ".9");
  write_script(real, "[ \"$1\" = --version ] && echo 'dtslab 9.8' && exit");
  store("old", "wait");
  ASSERT_TRUE(database::add_jobs(database(), {.kind = "sway", .version = "9.8"}));
  Process worker(file);
  wait_for("SELECT count(*) FROM job WHERE version = '9.8' AND state = 'failed'", 2);
  EXPECT_EQ(number("SELECT count(*) FROM job WHERE version = '9.9' AND state = 'waiting'"), 1);
  std::filesystem::rename(real + ".9", real);
  sql("NOTIFY job");  // else it looks 10 s later
  wait_for("SELECT count(*) FROM job WHERE version = '9.9' AND state = 'done'", 1);
}

TEST_F(WorkerTest, WithoutItsRole_TheLogSaysWhatToDo) {
  const auto content_of = [](const std::string& path) { return files::read_whole_file(path, 1U << 20U).value_or(""); };
  const std::string file = configuration();
  std::string text = content_of(file);
  text.replace(text.find(connection()), connection().size(), connection() + " user=nobody_of_ours");
  std::ofstream(file) << text;
  const std::string log = folder_.path() + "/log";
  const Process worker(file, log);
  const auto is_said = [&] { return content_of(log).find("CREATE ROLE \"dts-worker\" LOGIN IN ROLE worker") != std::string::npos; };
  for (int tries = 0; tries < 1000 && !is_said(); ++tries) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_TRUE(is_said()) << content_of(log);
}

TEST_F(WorkerTest, WrongConfiguration_EndsTheWorker) {
  const std::string file = configuration();
  write_script(folder_.path() + "/dtslab", "echo 'something else 1.0'");
  EXPECT_EQ(WEXITSTATUS(Process(file).wait()), 2);
  std::filesystem::remove(folder_.path() + "/dtslab");
  EXPECT_EQ(WEXITSTATUS(Process(file).wait()), 5);
  const test::S3Server s3;
  s3::Settings bucket = s3.settings();
  bucket.bucket = "recordingz";
  EXPECT_EQ(WEXITSTATUS(Process(configuration("time_s = 60", bucket)).wait()), 5);
  std::ofstream(file) << "[database]\n";
  EXPECT_EQ(WEXITSTATUS(Process(file).wait()), 2);
}

}  // namespace
}  // namespace dts::fleet::worker
