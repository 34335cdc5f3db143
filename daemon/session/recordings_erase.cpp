// SPDX-License-Identifier: Apache-2.0
// Erasing a subject. Its order keeps a crash harmless:
//
//     erasure.json on the disk --> rows --> mentions in other sessions --> files --> audit entry --> erasure.json removed
//
// The next start continues with an erasure.json that it finds, before it looks for recordings.
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "core/thread.h"
#include "session/recordings.h"

namespace dts::session {
namespace {

namespace fs = std::filesystem;
using core::ErrorCode;

constexpr std::size_t kMostSessions = 10'000;
constexpr std::size_t kEntriesToSearch = 1000;

bool is_below(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

/// Returns the correction without the subject ID.
bool remove_mention(record::Correction& correction, const std::string& subject) {
  bool is_changed = false;
  for (std::string* text : {&correction.old_value, &correction.new_value, &correction.reason}) {
    const bool is_id = correction.field == record::CorrectedField::Subject && text != &correction.reason;
    if (is_id && *text != subject) continue;  // another subject ID, which only contains this one
    auto changed = record::without_mention(*text, subject);
    if (!changed) continue;
    *text = std::move(*changed);
    is_changed = true;
  }
  return is_changed;
}

}  // namespace

core::Result<std::vector<std::string>> Recordings::sessions_mentioning(const std::string& subject) const {
  DTS_TRY_ASSIGN(const auto sessions, catalogue_->sessions({.limit = kMostSessions, .shown = record::Shown::Both}));
  std::vector<std::string> ids;
  for (const record::SessionRow& session : sessions) {
    if (session.subject == subject) continue;
    const bool is_recorded = session.recorded_subject == subject || record::without_mention(session.recorded_label, subject);
    const bool is_corrected =
        std::ranges::any_of(session.corrections, [&](record::Correction one) { return remove_mention(one, subject); });
    if (is_recorded || is_corrected) ids.push_back(session.id);
  }
  std::ranges::sort(ids);
  return ids;
}

/// Fails if a recording must not be removed: it is outside the folder of the recordings, or is only reached through a link.
core::Status Recordings::check_erasable(const std::vector<record::SessionRow>& sessions) const {
  std::error_code error;
  const fs::path folder = fs::canonical(sessions_directory(config_), error);
  if (error) return core::fail_errno(error.value(), "the folder of the recordings cannot be read", "is its disk mounted?");
  for (const record::SessionRow& session : sessions) {
    if (corrected(session).state == "running") {
      return core::fail(ErrorCode::WrongState, "a session of this subject is running or being closed: " + session.id,
                        "stop it first: dtsctl session stop --rig " + session.rig);
    }
    for (const record::PartRow& part : session.parts) {
      const fs::path file(part.file);
      const auto status = fs::symlink_status(file, error);
      if (!fs::exists(status)) continue;
      const fs::path place = fs::canonical(file.parent_path(), error);
      if (fs::is_regular_file(status) && !error && is_below(place, folder)) continue;
      return core::fail(ErrorCode::NotAllowed,
                        "the recording " + part.file + " is a link, or is not in " + folder.string() + ": dtsd does not remove it",
                        "move the file itself to " + folder.string() + ", restart dtsd, then erase the subject again");
    }
  }
  return {};
}

/// Removes the subject ID from the corrections of other sessions. Lists in `unerased_` what it must not or cannot change.
core::Status Recordings::remove_mentions(record::Erasure& erasure) {
  DTS_TRY_ASSIGN(const auto ids, sessions_mentioning(erasure.subject));
  erasure.mentions = 0;
  unerased_.clear();
  for (const std::string& id : ids) {
    DTS_TRY_ASSIGN(const auto session, catalogue_->session(id));
    if (session.recorded_subject == erasure.subject || record::without_mention(session.recorded_label, erasure.subject)) {
      unerased_.push_back("the recordings of session " + id + ", which now has another subject ID, were recorded with this one");
    }
    record::Corrections cleaned{.session_id = id, .all = session.corrections};
    bool is_changed = false;
    for (record::Correction& one : cleaned.all) is_changed = remove_mention(one, erasure.subject) || is_changed;
    if (!is_changed) continue;
    if (!session.parts.empty()) {
      DTS_TRY(record::write_corrections(record::corrections_file(session.parts.front().file, id), cleaned));
    }
    DTS_TRY(catalogue_->set_corrections(cleaned));
    ++erasure.mentions;
  }
  return {};
}

core::Status Recordings::erase_rows(record::Erasure& erasure) {
  DTS_TRY(catalogue_->erase(erasure.sessions));
  DTS_TRY(remove_mentions(erasure));
  return catalogue_->erase({});  // overwrites what the corrections were
}

core::Status Recordings::begin_erasure(const std::string& subject, const std::string& who) {
  if (erasing_thread_.joinable()) {
    return core::fail(ErrorCode::WrongState, "another erasure is under way", "wait a minute, then try again");
  }
  erased_.reset();  // of an earlier one whose client did not wait
  if (is_recovering_) {
    return core::fail(ErrorCode::WrongState, "dtsd is making repaired copies of recordings", "wait a minute, then try again");
  }
  collect_recovered();  // after the look: its last copy is among these, and must not be entered after the erasure
  if (!owed_.empty()) {
    return core::fail(ErrorCode::Failed, "the catalogue rejects entries at the moment", "see the log of dtsd, then try again");
  }
  if (erasure_ && erasure_->subject != subject) {
    return core::fail(ErrorCode::WrongState, "an earlier erasure is not complete", "see the log of dtsd, then restart it");
  }
  if (!erasure_) {
    DTS_TRY_ASSIGN(const auto sessions, catalogue_->sessions({.subject = subject, .limit = kMostSessions, .shown = record::Shown::Both}));
    DTS_TRY_ASSIGN(const auto mentioning, sessions_mentioning(subject));
    if (subject.empty() || (sessions.empty() && mentioning.empty())) {
      return core::fail(ErrorCode::NotFound, "no session has this subject ID", "see dtsctl subject list");
    }
    DTS_TRY(check_erasable(sessions));
    record::Erasure erasure{.subject = subject, .who = who, .utc_ns = clock_.now_ns() + clock_.utc_minus_monotonic_ns()};
    for (const record::SessionRow& session : sessions) erasure.sessions.push_back(session.id);
    DTS_TRY(record::write_erasure(config_.directory, erasure));
    erasure_ = std::move(erasure);
  }
  if (auto erased = erase_rows(*erasure_); !erased) {
    finish_erasure(tl::make_unexpected(erased.error()));
    erased_.reset();
    return erased;
  }
  start_erasing();
  return {};
}

void Recordings::start_erasing() {
  erasing_thread_ = std::jthread([this, sessions = erasure_->sessions](const std::stop_token& stop) {
    static_cast<void>(core::configure_this_thread("erase", {}));  // default policy, cannot be rejected
    auto removed = record::remove_session_files(sessions_directory(config_), sessions, [&stop] { return !stop.stop_requested(); });
    const std::lock_guard lock(removed_mutex_);
    removed_ = std::move(removed);
  });
}

void Recordings::collect_erased() {
  std::optional<core::Result<record::Erased>> removed;
  {
    const std::lock_guard lock(removed_mutex_);
    removed = std::exchange(removed_, std::nullopt);
  }
  if (!removed) return;
  if (erasing_thread_.joinable()) erasing_thread_.join();  // `stop` joins it too
  finish_erasure(std::move(*removed));
}

/// Adds what a person must look at.
void Recordings::add_left(record::Erased& erased) const {
  erased.left.insert(erased.left.end(), unerased_.begin(), unerased_.end());
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(config_.directory, error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("catalogue.sqlite.damaged-")) erased.left.push_back("'" + entry.path().string() + "' is an older catalogue");
  }
  std::ranges::sort(erased.left);
}

/// Enters the erasure into the audit trail, once, then forgets it. A failed one stays, and the next start continues it.
void Recordings::finish_erasure(core::Result<record::Erased> erased) {
  if (!erased) {
    log_.error("an erasure is not complete: " + core::to_string(erased.error()) + "; dtsd continues it when it starts again");
    erased_ = std::move(erased);
    return;
  }
  erased->sessions = static_cast<std::uint32_t>(erasure_->sessions.size());
  erased->mentions = erasure_->mentions;
  add_left(*erased);
  const auto entries = catalogue_->audit(kEntriesToSearch);
  const bool is_entered = entries && std::ranges::any_of(*entries, [this](const record::AuditEntry& entry) {
                            return entry.what == "erase_subject" && entry.utc_ns == erasure_->utc_ns && entry.result == "ok";
                          });
  const std::string count = std::to_string(erased->sessions) + (erased->sessions == 1 ? " session" : " sessions");
  if (!is_entered) {
    enter_audit({.utc_ns = erasure_->utc_ns, .who = erasure_->who, .what = "erase_subject", .target = count, .result = "ok"});
  }
  log_.info("a subject was erased: " + count + ", " + std::to_string(erased->files) + " files");
  complain(record::remove_erasure(config_.directory));
  erasure_.reset();
  ++erasures_;
  erased_ = std::move(erased);
}

/// Continues an erasure that the end of the daemon interrupted. Thread: the one that opens the recordings.
void Recordings::continue_erasure() {
  auto found = record::read_erasure(config_.directory);
  if (!found) return complain(tl::make_unexpected(found.error()));
  if (!*found) return;
  erasure_ = std::move(**found);
  auto removed = erase_rows(*erasure_).and_then(
      [this] { return record::remove_session_files(sessions_directory(config_), erasure_->sessions, [] { return true; }); });
  finish_erasure(std::move(removed));
  erased_.reset();  // nobody waits for it
}

}  // namespace dts::session
