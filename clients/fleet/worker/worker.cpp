// SPDX-License-Identifier: Apache-2.0
#include "fleet/worker/worker.h"

#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/random.h>
#include <sys/signalfd.h>
#include <sys/stat.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cinttypes>
#include <cstdio>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "core/utf8.h"
#include "fleet/s3/bucket.h"
#include "fleet/worker/job_queue.h"
#include "fleet/worker/kinds.h"
#include "fleet/worker/stored_recording.h"

namespace dts::fleet::worker {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kTableLook = std::chrono::seconds(10);    ///< Between two looks at the table without a notification.
constexpr auto kSlice = std::chrono::milliseconds(500);  ///< Longest delay of a signal.
constexpr Limits kVersionLimits{.time = std::chrono::seconds(10), .output_bytes = 4096};

constexpr const char* kLost = ": another worker has taken the job, or the session was erased";

/// Signals of the user and of systemd that end this process.
class EndSignals {
 public:
  EndSignals() {
    sigset_t wanted{};
    sigemptyset(&wanted);
    for (const int signal : {SIGTERM, SIGINT}) sigaddset(&wanted, signal);
    descriptor_ = ::signalfd(-1, &wanted, SFD_CLOEXEC | SFD_NONBLOCK);
  }
  ~EndSignals() { ::close(descriptor_); }
  EndSignals(const EndSignals&) = delete;
  EndSignals& operator=(const EndSignals&) = delete;
  EndSignals(EndSignals&&) = delete;
  EndSignals& operator=(EndSignals&&) = delete;

  /// Returns whether the process shall end; waits for a signal for this time.
  [[nodiscard]] bool is_end_asked(std::chrono::milliseconds wait = std::chrono::milliseconds(0)) const {
    pollfd item{.fd = descriptor_, .events = POLLIN, .revents = 0};
    return ::poll(&item, 1, static_cast<int>(wait.count())) > 0;  // it stays readable
  }

 private:
  int descriptor_ = -1;
};

/// Which file a program is: changes if a package replaces it.
struct ProgramFile {
  std::uint64_t device = 0;
  std::uint64_t inode = 0;
  std::int64_t changed_s = 0;
  std::int64_t changed_ns = 0;
  friend bool operator==(const ProgramFile&, const ProgramFile&) = default;
};

core::Result<ProgramFile> program_file(const std::string& program) {
  struct stat facts {};
  if (::stat(program.c_str(), &facts) != 0) {
    return core::fail_errno(errno, "cannot find '" + program + "'", "install dtslab, or set 'dtslab' in the configuration to its path");
  }
  return ProgramFile{.device = facts.st_dev, .inode = facts.st_ino, .changed_s = facts.st_ctim.tv_sec, .changed_ns = facts.st_ctim.tv_nsec};
}

/// Returns "0.1.0".
core::Result<std::string> version_of(const std::string& program, const EndSignals& signals) {
  const auto ended = run_confined(program, {"--version"}, kVersionLimits, [&] { return !signals.is_end_asked(); });
  DTS_TRY(ended);
  constexpr std::string_view kName = "dtslab ";
  std::string_view text = ended->out;
  if (!text.empty() && text.back() == '\n') text.remove_suffix(1);
  if (ended->status == 0 && text.starts_with(kName)) text.remove_prefix(kName.size());
  const bool is_version = ended->status == 0 && text.size() != ended->out.size() && !text.empty() && text.size() <= 40 &&
                          text.find_first_not_of("0123456789.abcdefghijklmnopqrstuvwxyz~+-") == std::string_view::npos;
  if (is_version) return std::string(text);
  return core::fail(core::ErrorCode::InvalidArgument, "'" + program + " --version' prints no version of dtslab",
                    "set 'dtslab' in the configuration to the path of dtslab");
}

/// Returns "centre-1-4711-5f3a90c2": no other worker has or had this name.
std::string unique_name() {
  std::array<char, 64> host{};
  if (::gethostname(host.data(), host.size() - 1) != 0) host = {};
  std::uint32_t number = 0;
  if (::getrandom(&number, sizeof number, 0) != sizeof number) number = static_cast<std::uint32_t>(Clock::now().time_since_epoch().count());
  std::array<char, 9> digits{};
  std::snprintf(digits.data(), digits.size(), "%08" PRIx32, number);
  return std::string(host.data()) + "-" + std::to_string(::getpid()) + "-" + digits.data();
}

constexpr const char* kNoRights = "as the owner of the database: CREATE ROLE \"dts-worker\" LOGIN IN ROLE worker";

class Worker {
 public:
  Worker(const WorkerOptions& options, const core::Log& log)
      : options_(options),
        log_(log),
        name_(unique_name()),
        database_({.connection = options.connection, .name = "dts-worker " + name_, .is_durable = true, .rejection_hint = kNoRights}) {}

  [[nodiscard]] core::Status run() {
    if (options_.s3) {
      DTS_TRY_ASSIGN(bucket_, s3::Bucket::open(*options_.s3));
    }
    DTS_TRY(look_at_dtslab());
    database_.listen("job");
    sd_notify(0, "READY=1");
    log_.info("worker " + name_ + ": takes jobs for dtslab " + version_);
    while (!signals_.is_end_asked()) {
      DTS_TRY(look_at_dtslab());
      auto job = queue_->take();
      note_database(job);
      if (job && *job) {
        execute(**job);
      } else {
        wait();
      }
    }
    return {};
  }

 private:
  /// Whose results are written is the version that the program has now.
  [[nodiscard]] core::Status look_at_dtslab() {
    DTS_TRY_ASSIGN(const ProgramFile file, program_file(options_.dtslab));
    if (queue_ && file == file_) return {};
    DTS_TRY_ASSIGN(version_, version_of(options_.dtslab, signals_));
    file_ = file;
    queue_.emplace(database_,
                   QueueOptions{.worker = name_, .version = version_, .lease = options_.lease, .retry_pause = options_.retry_pause});
    return {};
  }

  /// Waits for new jobs, or for the next look at the table.
  void wait() {
    const auto end = Clock::now() + kTableLook;
    while (Clock::now() < end && !signals_.is_end_asked()) {
      const auto notified = database_.wait_notification(kSlice);
      if (notified && *notified) return;
      if (!notified && signals_.is_end_asked(kSlice)) return;
    }
  }

  void execute(const TakenJob& job) {
    renewed_ = Clock::now();
    has_lost_ = false;
    const auto figures = analyse(job);
    if (has_lost_) return log_.warning(title(job) + kLost);
    if (signals_.is_end_asked() && !figures) return give_back(job);
    if (const auto file = program_file(options_.dtslab); !file || *file != file_) {
      return give_back(job);  // which version has computed it is not certain
    }
    if (!figures && figures.error().code == core::ErrorCode::Unreachable) return postpone(job, figures.error());
    const auto problem = figures ? figures->rejection : std::optional(figures.error());
    if (problem) return fail(job, *problem, figures.has_value());
    const std::string message = figures->skipped > 0 ? std::to_string(figures->skipped) + " results of dtslab were not usable" : "";
    const auto written = end_job(job, [&] { return queue_->finish(job, figures->all, message); });
    if (!written) fail(job, written.error(), false);
  }

  void give_back(const TakenJob& job) {
    static_cast<void>(end_job(job, [&] { return queue_->give_back(job); }));
  }

  /// The store does not answer. No job can do better for now.
  void postpone(const TakenJob& job, const core::Error& problem) {
    const std::string message = core::to_string(problem);
    if (!std::exchange(is_store_away_, true)) log_.warning(title(job) + ": " + message + "; this job and others wait for the store");
    static_cast<void>(end_job(job, [&] { return queue_->postpone(job, message); }));
    wait();
  }

  void fail(const TakenJob& job, const core::Error& problem, bool is_rejected) {
    const std::string message = core::to_string(problem);
    log_.warning(title(job) + ", try " + std::to_string(job.tries) + ": " + message);
    // dtslab rejects the same recording again, except for these reasons.
    const bool is_final = is_rejected && problem.code != core::ErrorCode::Failed && problem.code != core::ErrorCode::Internal;
    static_cast<void>(end_job(job, [&] { return queue_->fail(job, message, is_final); }));
  }

  /// Returns a name of the job's recording, whose SHA-256 is that of the catalogue.
  [[nodiscard]] core::Result<RecordingName> recording_of(const TakenJob& job, const std::function<bool()>& keeps_on) {
    if (bucket_) {
      DTS_TRY_ASSIGN(RecordingName name, RecordingName::fetch(*bucket_, job.store_key, keeps_on));
      if (std::exchange(is_store_away_, false)) log_.info("the store answers again");
      DTS_TRY(check_sha256(name.path(), job.sha256, keeps_on));
      return name;
    }
    DTS_TRY_ASSIGN(const std::string file, stored_file(options_.store, job.store_key));
    DTS_TRY(check_sha256(file, job.sha256, keeps_on));
    return RecordingName::create(file);
  }

  /// Returns what dtslab computes from the recording.
  [[nodiscard]] core::Result<Figures> analyse(const TakenJob& job) {
    const auto keeps_on = [&] { return keep(job); };
    DTS_TRY_ASSIGN(const RecordingName name, recording_of(job, keeps_on));
    const auto words = words_of(job.kind, name.path());
    if (!words) return core::fail(core::ErrorCode::Unsupported, "unknown kind of job '" + job.kind + "'");
    DTS_TRY_ASSIGN(const Ended ended, run_confined(options_.dtslab, *words, options_.limits, keeps_on));
    auto figures = figures_of(job.kind, ended.out, job.part);
    // dtslab also exits with other statuses than 0 if its document is complete: a result differs from the recorded one.
    if (!figures && figures.error().code == core::ErrorCode::DataDamaged && !ended.talk.empty()) {
      figures.error().hint = core::printable(ended.talk.substr(0, 300));
    }
    return figures;
  }

  /// Renews the lease in time. Returns false if the job shall end: it is another worker's now, or this process ends.
  [[nodiscard]] bool keep(const TakenJob& job) {
    if (signals_.is_end_asked()) return false;
    if (Clock::now() - renewed_ < options_.lease / 3) return true;
    const auto is_mine = queue_->renew(job);
    note_database(is_mine);
    renewed_ = Clock::now();  // without the database the next try is as far away: the transaction at the end decides
    has_lost_ = is_mine && !*is_mine;
    return !has_lost_;
  }

  /// Ends a job in the database. Tries again until the lease is over: then others have the job. Fails if the database rejects it.
  template <class End>
  [[nodiscard]] core::Status end_job(const TakenJob& job, End end) {
    const auto last = Clock::now() + options_.lease;
    while (true) {
      const auto is_mine = end();
      note_database(is_mine);
      if (is_mine && !*is_mine) log_.warning(title(job) + kLost);
      if (is_mine) return {};
      if (is_mine.error().code != core::ErrorCode::Unreachable) return tl::make_unexpected(is_mine.error());
      if (Clock::now() >= last || signals_.is_end_asked(kSlice)) return {};
    }
  }

  /// Logs when the database goes and when it is back.
  template <class Value>
  void note_database(const core::Result<Value>& result) {
    const std::string problem = result ? std::string() : core::to_string(result.error());
    if (problem == database_problem_) return;
    if (problem.empty()) log_.info("the database answers again");
    if (!problem.empty()) log_.warning("the database: " + problem);
    database_problem_ = problem;
  }

  [[nodiscard]] static std::string title(const TakenJob& job) {
    return "job " + std::to_string(job.id) + ", " + job.kind + " of " + job.clinic + "/" + job.session + " part " +
           std::to_string(job.part);
  }

  const WorkerOptions& options_;
  const core::Log& log_;
  EndSignals signals_{};
  std::string name_;
  database::Database database_;
  std::unique_ptr<s3::Bucket> bucket_{};  ///< nullptr: the store is a folder.
  ProgramFile file_{};
  std::string version_{};
  std::optional<JobQueue> queue_{};
  Clock::time_point renewed_{};
  bool has_lost_ = false;
  bool is_store_away_ = false;
  std::string database_problem_{};
};

}  // namespace

core::Status run_worker(const WorkerOptions& options, const core::Log& log) {
  // dtslab has the same user: it must not read our memory, which holds the way to the database.
  ::prctl(PR_SET_DUMPABLE, 0);
  return Worker(options, log).run();
}

}  // namespace dts::fleet::worker
