// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/clock.h"
#include "core/log.h"
#include "record/catalogue/catalogue.h"
#include "session/record_thread.h"
#include "session/rig.h"
#include "session/storage.h"

namespace dts::session {

/// All recordings of a daemon: the folder, the catalogue, the record thread, and the recovery of what an earlier daemon left behind.
///
///     open: folder, catalogue, rebuild --> begin (file on the disk) --> note ... note --> end --> take_finished
///                       interrupted parts --> recovery thread --> catalogue
///
/// Thread: control, all of it.
class Recordings {
 public:
  /// Prepares folder and catalogue, enters recordings that the catalogue does not know, and lists what was interrupted. A damaged catalogue
  /// is set aside with its audit trail, and made anew from the recordings: `notice` says so. Fails with what is wrong and what to do.
  /// `clock` outlives the object.
  [[nodiscard]] static core::Result<std::unique_ptr<Recordings>> open(const StorageConfig& config, core::Clock& clock, core::Log log);
  ~Recordings() { stop(); }
  Recordings(const Recordings&) = delete;
  Recordings& operator=(const Recordings&) = delete;

  /// Before `start`; the rig outlives the object or its `stop`.
  void add(Rig& rig);
  /// Starts the record thread and the recovery of interrupted recordings.
  void start();
  void stop() noexcept;

  /// Creates the file of a session's (next) part. It is on the disk when this returns. LimitExceeded: too little room.
  [[nodiscard]] core::Status begin(Rig& rig, record::SessionFacts facts);
  /// Ends it: what is on its way is written, then it is closed; as incomplete when the device is away at that moment.
  void end(Rig& rig);
  void note(const std::string& rig, record::RecordedEvent event) { thread_.post(rig, std::move(event)); }

  /// Into the catalogue; what it refuses is logged and tried again every second or so. The recording says the same.
  void enter_trial(const record::TrialRow& trial) {
    enter_or_owe([this, trial] { return catalogue_->put_trial(trial); });
  }
  void enter_result(const record::ResultRow& result) {
    enter_or_owe([this, result] { return catalogue_->put_result(result); });
  }
  /// The same for the audit trail. Of entries that found no room in a thousand the trail gets the number.
  void enter_audit(record::AuditEntry entry);
  /// Why the trail lacks entries at the moment; empty: it does not.
  [[nodiscard]] const std::string& audit_problem() const noexcept { return audit_problem_; }
  /// What everybody should know about the catalogue; empty: nothing.
  [[nodiscard]] const std::string& notice() const noexcept { return notice_; }
  void end_session(const std::string& id, const std::string& state, const std::string& message, std::int64_t utc_ns);
  /// Returns the catalogue's row with the entries that the catalogue has refused so far. A session whose file is still open is "running".
  [[nodiscard]] record::SessionRow corrected(record::SessionRow row) const;

  /// Waits until no recording is open any more, or for `limit`.
  void wait_until_closed(std::chrono::milliseconds limit) { thread_.wait_until_closed(limit); }
  /// Sessions that a crash ended, at most one for each rig, no longer ago than the configuration says.
  [[nodiscard]] std::vector<std::string> take_resumable() { return std::exchange(resumable_, {}); }
  /// Recordings that ended since the last call, entered into the catalogue already.
  [[nodiscard]] std::vector<FinishedRecording> take_finished();
  [[nodiscard]] RecordingView view(const std::string& rig) { return thread_.view(rig); }
  [[nodiscard]] DiskView disk() const { return look_at_disk(config_, bytes_per_s_); }
  [[nodiscard]] record::Catalogue& catalogue() noexcept { return *catalogue_; }
  /// Part of the recording under way, or of the last.
  [[nodiscard]] std::uint32_t part(const std::string& rig) const;

 private:
  Recordings(StorageConfig config, core::Clock& clock, core::Log log, std::unique_ptr<record::Catalogue> catalogue)
      : config_(std::move(config)), clock_(clock), log_(std::move(log)), catalogue_(std::move(catalogue)), thread_(clock, config_) {}
  [[nodiscard]] static core::Result<std::unique_ptr<Recordings>> open_catalogue(const StorageConfig& config, core::Clock& clock,
                                                                                const core::Log& log);
  core::Status enter_interrupted();
  void end_left_running(record::SessionRow& session);
  void find_resumable(const std::vector<record::SessionRow>& sessions);
  [[nodiscard]] static std::optional<std::int64_t> cut_off_utc_ns(const record::PartRow& part);
  [[nodiscard]] bool is_recent(const record::PartRow& part) const;
  [[nodiscard]] static bool is_suspicious(const record::SessionRow& session);
  void recover_all(const std::stop_token& stop);
  [[nodiscard]] std::string lacks_room(const record::PartRow& part) const;
  void collect_recovered();
  [[nodiscard]] core::Status enter(const record::FoundRecording& found);
  void enter(const FinishedRecording& finished);
  /// Returns whether the file of the session's newest part is still open.
  [[nodiscard]] bool is_being_closed(const record::SessionRow& row) const;
  void complain(const core::Status& status);
  void enter_or_owe(std::function<core::Status()> entry);
  void enter_owed();
  void audit(const std::string& what, const std::string& target, const std::string& result);
  [[nodiscard]] core::Status append_audit(const record::AuditEntry& entry);
  void enter_owed_audit();

  StorageConfig config_;
  core::Clock& clock_;
  core::Log log_;
  std::unique_ptr<record::Catalogue> catalogue_;
  std::vector<std::string> resumable_;
  RecordThread thread_;
  double bytes_per_s_ = 0.0;                        ///< Of all rigs together.
  std::deque<std::function<core::Status()>> owed_;  ///< Entries that the catalogue has refused, oldest first.
  int calls_to_retry_ = 0;                          ///< Of `take_finished`, until they are tried again.
  std::deque<record::AuditEntry> owed_audit_;       ///< The same of the audit trail.
  std::uint64_t unwritten_audit_ = 0;               ///< Entries that found no room among them.
  std::string audit_problem_;
  std::string notice_;
  bool is_started_ = false;
  std::map<std::string, record::SessionRow> owed_ends_;  ///< Ends of sessions among them, by id.
  std::map<std::string, record::PartRow> under_way_;     ///< By rig; the last one stays.

  std::vector<record::PartRow> interrupted_;  ///< The recovery thread's, once it runs.
  std::mutex recovered_mutex_;
  std::vector<record::FoundRecording> recovered_;  ///< A part that could not be recovered has no facts.
  std::jthread recovery_thread_;
};

}  // namespace dts::session
