// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <deque>
#include <filesystem>
#include <functional>
#include <limits>
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
#include "record/catalogue/erasure.h"
#include "record/catalogue/subject_notes.h"
#include "session/record_thread.h"
#include "session/rig.h"
#include "session/storage.h"

namespace dts::session {

/// Sessions that have a subject ID somewhere, but are not sessions of this subject.
struct Mentions {
  std::vector<std::string> sessions{};  ///< Their IDs.
  std::size_t unsearched = 0;           ///< Further sessions that may be among them.
};

/// A rig whose recording begins.
struct RecordingStart {
  Rig& rig;
  record::SessionFacts facts;
};

/// Manages all recordings of a daemon: the folder, the catalogue, the record thread, and the recovery of recordings interrupted by a crash.
///
///     open: folder, catalogue, rebuild --> begin (file on the disk) --> note ... note --> end --> take_finished
///                       interrupted parts --> recovery thread --> catalogue
///
/// Thread: control, all of it.
class Recordings {
 public:
  /// Prepares folder and catalogue, enters recordings that are missing in the catalogue, and lists interrupted ones. Sets a damaged
  /// catalogue aside together with its audit trail and rebuilds it from the recordings; `notice` then reports this. An error says what
  /// failed and what to do. `clock` outlives the object.
  [[nodiscard]] static core::Result<std::unique_ptr<Recordings>> open(const StorageConfig& config, core::Clock& clock, core::Log log);
  ~Recordings() { stop(); }
  Recordings(const Recordings&) = delete;
  Recordings& operator=(const Recordings&) = delete;

  /// Call before `start`. The rig must exist until `stop` or the end of this object.
  void add(Rig& rig);
  /// Starts the record thread, the recovery of interrupted recordings, and the rest of an interrupted erasure.
  void start();
  void stop() noexcept;

  /// Creates the files of a session's first or next parts, one for each of its rigs; they are on the disk when this returns. Fails with
  /// LimitExceeded if the disk has too little room, and with WrongState while an erasure writes the catalogue again. After an error, no rig
  /// records and nothing is left on the disk.
  [[nodiscard]] core::Status begin(const std::vector<RecordingStart>& starts);
  /// Ends the recording: queued data are written, then the file is closed. The recording is incomplete if the device is away at this
  /// moment.
  void end(Rig& rig);
  /// Marks the current recording of a rig as incomplete for a reason that its frames do not show.
  void mark_incomplete(const std::string& rig, std::string reason);
  void note(const std::string& rig, v1::Event event) { thread_.post(rig, std::move(event)); }

  /// Enters a row into the catalogue. If the catalogue fails, the error is logged and the entry is retried about every second. The
  /// recording has the same content.
  void enter_trial(const record::TrialRow& trial) {
    enter_or_owe([this, trial] { return catalogue_->put_trial(trial); });
  }
  /// Notes that an attempt of a trial has begun.
  void enter_attempt(const std::string& session_id, std::uint32_t trial, std::uint32_t attempt) {
    enter_or_owe([=, this] { return catalogue_->begin_attempt(session_id, trial, attempt); });
  }
  void enter_marker(const record::MarkerRow& marker) {
    enter_or_owe([this, marker] { return catalogue_->put_marker(marker); });
  }
  /// Removes the row of a trial that is under way again.
  void remove_trial(const record::TrialRow& trial) {
    enter_or_owe([this, trial] { return catalogue_->remove_trial(trial); });
  }
  void enter_result(const record::ResultRow& result) {
    enter_or_owe([this, result] { return catalogue_->put_result(result); });
  }
  /// Enters a line into the audit trail, with the same retries. Beyond 1000 waiting entries, only the number of further ones
  /// reaches the trail.
  void enter_audit(record::AuditEntry entry);
  /// Returns why entries are missing in the audit trail at the moment; empty: none is missing.
  [[nodiscard]] const std::string& audit_problem() const noexcept { return audit_problem_; }
  /// Returns what users must know about the catalogue (it was rebuilt); empty: nothing.
  [[nodiscard]] const std::string& notice() const noexcept { return notice_; }
  void end_session(const std::string& id, const std::string& state, const std::string& message, std::int64_t utc_ns);
  /// Returns the catalogue's row, corrected by entries that still wait for a retry. A session whose file is still open is "running".
  [[nodiscard]] record::SessionRow corrected(record::SessionRow row) const;

  // recordings_edit.cpp
  /// Returns a session of the catalogue that nobody writes to. Fails with NotFound, with WrongState while it runs or its recording is being
  /// closed, or while entries wait for the end of an erasure, and with Failed while the catalogue rejects entries for another reason.
  [[nodiscard]] core::Result<record::SessionRow> closed_session(const std::string& id) const;
  /// Adds corrections to a session that `closed_session` has returned: to the file beside its recordings, then to the catalogue. Sets
  /// number and time. If an outcome was corrected, computes the session's results again, which needs the files of reaches. Fails with
  /// LimitExceeded above `kMostCorrections`, and with DataDamaged or WrongState if the file cannot be read or has other corrections than
  /// the catalogue, and with WrongState while an erasure writes the catalogue again. After an error nothing was changed.
  [[nodiscard]] core::Status correct(const record::SessionRow& session, std::vector<record::Correction> corrections);

  // recordings_erase.cpp
  /// Returns the other sessions whose corrections, markers, recorded subject ID or recorded label have this subject ID. Searches at most
  /// `most_searched` of the sessions that have its text somewhere.
  [[nodiscard]] core::Result<Mentions> sessions_mentioning(const std::string& subject,
                                                           std::size_t most_searched = std::numeric_limits<std::size_t>::max()) const;
  /// Returns what people wrote about a subject. Fails with DataDamaged, naming the file.
  [[nodiscard]] core::Result<record::SubjectNotes> subject_notes(const std::string& subject) const;
  /// Returns the IDs of all subjects that have notes or a plan, sorted.
  [[nodiscard]] core::Result<std::vector<std::string>> subjects_with_notes() const;
  /// Replaces what people wrote about a subject. Fails with WrongState while the subject is erased.
  [[nodiscard]] core::Status keep_notes(const record::SubjectNotes& notes);
  /// Begins to erase a subject: its sessions are in no list any more when this returns; a thread removes the files. Fails with NotFound if
  /// no session has or had this subject ID, with WrongState while one of its sessions runs or a file of its recordings is missing, while
  /// repaired copies are made or during another erasure, and with NotAllowed if a recording is a link or outside the folder of the
  /// recordings. After these errors nothing was removed. An erasure that failed half-way continues, with the sessions that the subject has
  /// now.
  [[nodiscard]] core::Status begin_erasure(const std::string& subject, const std::string& who);
  /// Returns the result of an erasure that ended since the last call. The audit trail then has it.
  [[nodiscard]] std::optional<core::Result<record::Erased>> take_erased() { return std::exchange(erased_, std::nullopt); }
  /// Returns the number of erasures that ended since the start.
  [[nodiscard]] std::uint64_t erasures() const noexcept { return erasures_; }

  /// Waits until no recording is open, at most `limit`.
  void wait_until_closed(std::chrono::milliseconds limit) { thread_.wait_until_closed(limit); }
  /// Returns the sessions that a crash interrupted, at most one per rig, within the configured time.
  [[nodiscard]] std::vector<std::string> take_resumable() { return std::exchange(resumable_, {}); }
  /// Returns the recordings that ended since the last call. Their catalogue entries are made first.
  [[nodiscard]] std::vector<FinishedRecording> take_finished();
  [[nodiscard]] RecordingView view(const std::string& rig) { return thread_.view(rig); }
  /// The last session of the rig was erased: `view` does not show its recording any more.
  void forget(const std::string& rig) { thread_.forget(rig); }
  [[nodiscard]] DiskView disk() const { return look_at_disk(config_, bytes_per_s_); }
  [[nodiscard]] record::Catalogue& catalogue() noexcept { return *catalogue_; }
  /// Returns the part number of the current or last recording.
  [[nodiscard]] std::uint32_t part(const std::string& rig) const;

 private:
  static constexpr std::chrono::milliseconds kWaitOtherwise{1000};  ///< For the catalogue, while it is not written again.

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
  [[nodiscard]] bool lacks_room(std::uint64_t bytes) const;
  void collect_recovered();
  [[nodiscard]] core::Status enter(const record::FoundRecording& found);
  void enter(const FinishedRecording& finished);
  /// Returns whether a file of the session's newest parts is still open.
  [[nodiscard]] bool is_being_closed(const record::SessionRow& row) const;
  void complain(const core::Status& status);
  void enter_or_owe(std::function<core::Status()> entry);
  void enter_owed();
  void enter_owed_now();
  [[nodiscard]] bool is_written_again(const core::Error& error) const;
  [[nodiscard]] static tl::unexpected<core::Error> written_again();
  [[nodiscard]] core::Status explained(core::Status status) const;
  [[nodiscard]] core::Status sum_up(const std::string& session_id);
  void sum_up_corrected();
  [[nodiscard]] core::Status check_erasable(const std::vector<record::SessionRow>& sessions);
  [[nodiscard]] core::Status check_part(const record::PartRow& part, const std::filesystem::path& folder);
  core::Status remove_mentions(record::Erasure& erasure);
  [[nodiscard]] core::Status erase_rows(record::Erasure& erasure);
  void continue_erasure();
  void end_continued_erasure();
  [[nodiscard]] core::Status enter_erasure(const std::string& count);
  void start_erasing();
  [[nodiscard]] core::Result<record::Erased> overwritten(record::Erased removed, const std::function<bool()>& is_wanted) const;
  void collect_erased();
  void finish_erasure(core::Result<record::Erased> erased);
  void add_left(record::Erased& erased) const;
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
  std::deque<std::function<core::Status()>> owed_;  ///< Entries that wait for a retry, oldest first.
  int calls_to_retry_ = 0;                          ///< Calls of `take_finished` until the next retry.
  std::deque<record::AuditEntry> owed_audit_;       ///< Audit entries that wait for a retry.
  std::uint64_t unwritten_audit_ = 0;               ///< Number of audit entries that did not fit into `owed_audit_`.
  std::string audit_problem_;
  std::string notice_;
  bool is_started_ = false;
  std::map<std::string, record::SessionRow> owed_ends_;  ///< The ends of sessions within `owed_`, by session ID.
  std::map<std::string, record::PartRow> under_way_;     ///< The current or last part, by rig.

  std::optional<record::Erasure> erasure_;  ///< Under way, or failed half-way.
  std::uint32_t erased_notes_ = 0;          ///< Files with notes that the erasure removed.
  std::vector<std::string> unerased_;       ///< What an erasure could not clean, for its answer.
  std::optional<core::Result<record::Erased>> erased_;
  std::uint64_t erasures_ = 0;
  std::mutex removed_mutex_;
  std::optional<core::Result<record::Erased>> removed_;    ///< By the erasing thread.
  std::optional<core::Result<record::Erased>> continued_;  ///< What `continue_erasure` removed; `start` continues with the catalogue.
  std::jthread erasing_thread_;

  std::atomic<bool> is_recovering_ = false;
  std::vector<record::PartRow> interrupted_;  ///< Used by the recovery thread only, once it runs.
  std::mutex recovered_mutex_;
  std::vector<record::FoundRecording> recovered_;  ///< A part that could not be recovered has no facts.
  std::jthread recovery_thread_;
};

}  // namespace dts::session
