// SPDX-License-Identifier: Apache-2.0
// Erasing a subject. Its order keeps a crash harmless:
//
//     erasure.json on the disk --> rows --> mentions in other sessions --> files --> bytes of rows --> audit entry --> erasure.json removed
//                                           control thread <-- | --> thread "erase"              | --> control thread
//
// The next start continues with an erasure.json that it finds: rows, mentions and files before it looks for recordings, the rest after it.
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <span>
#include <utility>

#include "core/thread.h"
#include "session/recordings.h"

namespace dts::session {
namespace {

namespace fs = std::filesystem;
using core::ErrorCode;

constexpr std::size_t kMostSessions = 10'000;
constexpr std::size_t kEntriesToSearch = 1000;
/// How long the control thread waits for the catalogue. While removed rows are overwritten, it cannot write; it retries later.
constexpr std::chrono::milliseconds kWaitWhileErasing{50};

bool is_below(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

/// Removes the subject ID from a correction. Other values than these have words of dtsd ("done", "yes"), not of people.
bool remove_mention(record::Correction& correction, const std::string& subject) {
  using enum record::CorrectedField;
  std::vector<std::string*> texts{&correction.reason};
  if (record::is_text(correction.field)) texts.insert(texts.end(), {&correction.old_value, &correction.new_value});
  if (correction.field == Subject) {  // another subject ID may contain this one
    for (std::string* value : {&correction.old_value, &correction.new_value}) {
      if (*value == subject) texts.push_back(value);
    }
  }
  bool is_changed = false;
  for (std::string* text : texts) {
    auto changed = record::without_mention(*text, subject);
    if (!changed) continue;
    *text = std::move(*changed);
    is_changed = true;
  }
  return is_changed;
}

/// Returns the numbers within the session of the markers that were recorded with the subject ID in their text and were not removed.
std::vector<std::size_t> markers_with(const record::SessionRow& session, const std::string& subject) {
  std::vector<std::size_t> numbers;
  for (std::size_t index = 0; index < session.markers.size(); ++index) {
    const record::MarkerRow& marker = session.markers[index];
    if (record::without_mention(marker.recorded_text.empty() ? marker.text : marker.recorded_text, subject)) numbers.push_back(index + 1);
  }
  return numbers;
}

/// Returns whether a session was recorded with this subject ID, or had it.
bool had_subject(const record::SessionRow& session, const std::string& subject) {
  return session.recorded_subject == subject || std::ranges::any_of(session.corrections, [&](const record::Correction& one) {
           return one.field == record::CorrectedField::Subject && (one.old_value == subject || one.new_value == subject);
         });
}

}  // namespace

core::Result<Mentions> Recordings::sessions_mentioning(const std::string& subject, std::size_t most_searched) const {
  if (subject.empty()) return Mentions{};
  DTS_TRY_ASSIGN(const auto candidates, catalogue_->sessions_with(subject));
  const std::size_t searched = std::min(candidates.size(), most_searched);
  Mentions found{.unsearched = candidates.size() - searched};
  for (const std::string& id : std::span(candidates).first(searched)) {
    DTS_TRY_ASSIGN(const auto session, catalogue_->session_texts(id));
    const bool is_recorded = session.recorded_subject == subject || record::without_mention(session.recorded_label, subject) ||
                             !markers_with(session, subject).empty();
    const bool is_corrected =
        std::ranges::any_of(session.corrections, [&](record::Correction one) { return remove_mention(one, subject); });
    if (is_recorded || is_corrected) found.sessions.push_back(id);
  }
  return found;
}

/// Fails if a recording must not or cannot be removed.
core::Status Recordings::check_erasable(const std::vector<record::SessionRow>& sessions) {
  std::error_code error;
  const fs::path folder = fs::canonical(sessions_directory(config_), error);
  if (error) return core::fail_errno(error.value(), "the folder of the recordings cannot be read", "is its disk mounted?");
  for (const record::SessionRow& session : sessions) {
    if (corrected(session).state == "running") {
      return core::fail(ErrorCode::WrongState, "a session of this subject is running or being closed: " + session.id,
                        "stop it first: dtsctl session stop --rig " + session.rig);
    }
    for (const record::PartRow& part : session.parts) DTS_TRY(check_part(part, folder));
  }
  return {};
}

/// Fails if the file is missing from the folder of the recordings (if its disk comes back later, the next start would enter it again), is
/// reached through a link only, or is outside. Lists a missing file outside in `unerased_`: no start looks there.
core::Status Recordings::check_part(const record::PartRow& part, const fs::path& folder) {
  std::error_code error;
  fs::path file(part.file);
  auto status = fs::symlink_status(file, error);
  if (!fs::exists(status) && part.state == record::PartState::Recording) {  // the catalogue knows it by its final name
    file += ".part";
    status = fs::symlink_status(file, error);
  }
  if (!fs::exists(status)) {
    const bool is_ours = is_below(file.lexically_normal(), fs::path(sessions_directory(config_)).lexically_normal()) ||
                         is_below(file.lexically_normal(), folder);
    if (is_ours) {
      return core::fail(ErrorCode::WrongState, "the recording " + part.file + " is missing, so it cannot be removed",
                        "mount its disk or put the file back; if it is gone for ever, make an empty file with this name; then erase again");
    }
    unerased_.push_back("the recording '" + part.file + "' is missing; if it is elsewhere, remove it there");
    return {};
  }
  const fs::path place = fs::canonical(file.parent_path(), error);
  if (fs::is_regular_file(status) && !error && is_below(place, folder)) return {};
  return core::fail(ErrorCode::NotAllowed,
                    "the recording " + part.file + " is a link, or is not in " + folder.string() + ": dtsd does not remove it",
                    "move the file itself to " + folder.string() + ", restart dtsd, then erase the subject again");
}

/// Removes the subject ID from the corrections of other sessions. Lists in `unerased_` the recordings that have it: they are not changed.
core::Status Recordings::remove_mentions(record::Erasure& erasure) {
  DTS_TRY_ASSIGN(const auto mentioning, sessions_mentioning(erasure.subject));
  for (const std::string& id : mentioning.sessions) {
    DTS_TRY_ASSIGN(const auto session, catalogue_->session(id));
    if (session.recorded_subject == erasure.subject) {
      unerased_.push_back("the recordings of session " + id + " were recorded with this subject ID, and the session now has " +
                          (session.subject.empty() ? "none" : "another one") +
                          ": to erase them, give this session an ID of its own (dtsctl session edit " + id +
                          " --subject ID --reason TEXT), then erase that ID");
    } else if (record::without_mention(session.recorded_label, erasure.subject)) {
      unerased_.push_back("the recordings of session " + id + " have this subject ID in their label");
    }
    if (const auto markers = markers_with(session, erasure.subject); !markers.empty()) {
      const std::string number = std::to_string(markers.front());
      const std::string more = markers.size() > 1 ? " and in " + std::to_string(markers.size() - 1) + " more" : "";
      unerased_.push_back("the recordings of session " + id + " have this subject ID in marker " + number + more +
                          ": remove the text (dtsctl session edit " + id + " --marker " + number +
                          " --remove --reason TEXT), so that lists and exports do not show it; the recordings keep it");
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

core::Result<record::SubjectNotes> Recordings::subject_notes(const std::string& subject) const {
  return record::read_subject_notes(sessions_directory(config_), subject);
}

core::Result<std::vector<std::string>> Recordings::subjects_with_notes() const {
  return record::subjects_with_notes(sessions_directory(config_));
}

core::Status Recordings::keep_notes(const record::SubjectNotes& notes) {
  if (erasure_ && erasure_->subject == notes.subject) {
    return core::fail(ErrorCode::WrongState, "this subject is being erased", "wait a minute, then see dtsctl subject list");
  }
  return record::write_subject_notes(sessions_directory(config_), notes);
}

core::Status Recordings::erase_rows(record::Erasure& erasure) {
  DTS_TRY(catalogue_->erase(erasure.sessions));
  DTS_TRY_ASSIGN(const auto removed, record::remove_subject_notes(sessions_directory(config_), erasure.subject));
  erased_notes_ += removed;
  DTS_TRY_ASSIGN(const auto unread, record::remove_mentions_in_notes(sessions_directory(config_), erasure.subject));
  for (const std::string& file : unread) unerased_.push_back("the notes in '" + file + "' cannot be read; look there for this subject ID");
  return remove_mentions(erasure);
}

core::Status Recordings::begin_erasure(const std::string& subject, const std::string& who) {
  if (erasing_thread_.joinable()) {
    return core::fail(ErrorCode::WrongState, "another erasure is under way", "wait a minute, then try again");
  }
  erased_.reset();  // of an earlier one whose client did not wait
  continued_.reset();
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
  DTS_TRY_ASSIGN(const auto sessions, catalogue_->sessions({.subject = subject, .limit = kMostSessions, .shown = record::Shown::Both}));
  DTS_TRY_ASSIGN(const auto mentioning, sessions_mentioning(subject));
  DTS_TRY_ASSIGN(const auto noted, subjects_with_notes());
  bool is_known = erasure_ || !sessions.empty() || std::ranges::binary_search(noted, subject);
  for (const std::string& id : mentioning.sessions) {
    DTS_TRY_ASSIGN(const auto session, catalogue_->session_texts(id));
    is_known = is_known || had_subject(session, subject);
  }
  if (subject.empty() || !is_known) return core::fail(ErrorCode::NotFound, "no session has this subject ID", "see dtsctl subject list");
  unerased_.clear();
  DTS_TRY(check_erasable(sessions));
  record::Erasure erasure =
      erasure_.value_or(record::Erasure{.subject = subject, .who = who, .utc_ns = clock_.now_ns() + clock_.utc_minus_monotonic_ns()});
  for (const record::SessionRow& session : sessions) {
    if (std::ranges::find(erasure.sessions, session.id) == erasure.sessions.end()) erasure.sessions.push_back(session.id);
  }
  DTS_TRY(record::write_erasure(config_.directory, erasure));
  erasure_ = std::move(erasure);
  if (auto erased = erase_rows(*erasure_); !erased) {
    finish_erasure(tl::make_unexpected(erased.error()));
    erased_.reset();
    return erased;
  }
  start_erasing();
  return {};
}

/// Removes the bytes of removed rows too. This comes after the files: their removal makes the room that this needs, and a full disk must
/// not keep them. Fails with LimitExceeded if recordings would lack room meanwhile. Thread: any.
core::Result<record::Erased> Recordings::overwritten(record::Erased removed, const std::function<bool()>& is_wanted) const {
  const std::string file = catalogue_file(config_);
  const std::uint64_t needed = 2 * (size_of(file) + size_of(file + "-wal"));  // a copy, and the log with all pages
  if (lacks_room(needed)) {
    return core::fail(ErrorCode::LimitExceeded,
                      "the catalogue still has bytes of removed rows; to write it again, the disk of " + config_.directory + " needs " +
                          std::to_string(needed / 1'000'000 + 1) + " MB of free space, and the room that a session needs",
                      "make room, then restart dtsd or erase the subject again");
  }
  const auto is_emptied = record::Catalogue::overwrite_removed(file, config_.directory, is_wanted);
  if (!is_wanted()) return core::fail(ErrorCode::Failed, "dtsd is stopping: it continues the erasure when it starts again");
  if (!is_emptied) {
    return core::fail(is_emptied.error().code, "the catalogue still has bytes of removed rows: " + is_emptied.error().what,
                      is_emptied.error().hint);
  }
  if (!*is_emptied) {
    removed.left.emplace_back(
        "the log of the catalogue still has removed rows, because another program reads it: end that program and restart dtsd");
  }
  return removed;
}

/// Starts the thread that removes the files, unless `continue_erasure` has removed them, then the bytes of removed rows.
void Recordings::start_erasing() {
  catalogue_->wait_at_most(kWaitWhileErasing);
  erasing_thread_ =
      std::jthread([this, sessions = erasure_->sessions, continued = std::exchange(continued_, std::nullopt)](const std::stop_token& stop) {
        static_cast<void>(core::configure_this_thread("erase", {}));  // default policy, cannot be rejected
        const auto is_wanted = [&stop] { return !stop.stop_requested(); };
        auto removed = continued ? *continued : record::remove_session_files(sessions_directory(config_), sessions, is_wanted);
        if (removed) removed = overwritten(std::move(*removed), is_wanted);
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
  catalogue_->wait_at_most(kWaitOtherwise);
  enter_owed_now();
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

/// Enters the erasure into the audit trail, once. The entry must not wait in memory: the note of the erasure is removed next.
core::Status Recordings::enter_erasure(const std::string& count) {
  enter_owed_audit();
  DTS_TRY_ASSIGN(const auto entries, catalogue_->audit(kEntriesToSearch));
  const bool is_entered = std::ranges::any_of(entries, [this](const record::AuditEntry& entry) {
    return entry.what == "erase_subject" && entry.utc_ns == erasure_->utc_ns && entry.result == "ok";
  });
  if (is_entered) return {};
  return append_audit({.utc_ns = erasure_->utc_ns, .who = erasure_->who, .what = "erase_subject", .target = count, .result = "ok"});
}

/// Enters the erasure into the audit trail, then forgets it. A failed one stays, and the next start continues it.
void Recordings::finish_erasure(core::Result<record::Erased> erased) {
  const std::size_t sessions = erasure_->sessions.size();
  const std::string count = std::to_string(sessions) + (sessions == 1 ? " session" : " sessions");
  if (erased) {
    if (auto entered = enter_erasure(count); !entered) erased = tl::make_unexpected(entered.error());
  }
  const auto for_log = [this](std::string message) { return record::without_subjects(sessions_directory(config_), std::move(message)); };
  if (!erased) {
    log_.error("an erasure is not complete: " + for_log(core::to_string(erased.error())) + "; dtsd continues it when it starts again");
    erased_ = std::move(erased);
    return;
  }
  erased->sessions = static_cast<std::uint32_t>(sessions);
  erased->mentions = erasure_->mentions;
  erased->files += std::exchange(erased_notes_, 0);
  add_left(*erased);
  log_.info("a subject was erased: " + count + ", " + std::to_string(erased->files) + " files");
  // Perhaps nobody waits for the answer any more.
  for (const std::string& left : erased->left) log_.warning("not erased: " + for_log(left));
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
  continued_ = erase_rows(*erasure_).and_then(
      [this] { return record::remove_session_files(sessions_directory(config_), erasure_->sessions, [] { return true; }); });
}

/// Removes the rows again that came back while the recordings were looked for: files that could not be removed were entered again, and if
/// the catalogue was damaged, the mentions came from the files of other sessions. `start` then continues with the bytes of the rows.
void Recordings::end_continued_erasure() {
  if (!continued_) return;
  unerased_.clear();
  auto erased = erase_rows(*erasure_);
  if (erased && *continued_) return;
  finish_erasure(tl::make_unexpected(erased ? continued_->error() : erased.error()));
  continued_.reset();
  erased_.reset();  // nobody waits for it
}

}  // namespace dts::session
