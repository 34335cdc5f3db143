// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"
#include "dts/v1/fleet.pb.h"
#include "dts/v1/sessions.pb.h"
#include "fleet/forward/sent_bytes.h"
#include "fleet/wire/facts.h"
#include "record/catalogue/sqlite.h"

namespace dts::fleet::forward {

enum class FileState : std::uint8_t {
  Waiting = 0,  ///< To be sent.
  Stored = 1,   ///< The centre has it: there is a receipt.
  Held = 2,     ///< Cannot be sent: see `why_not`.
};

/// A recording of the clinic. Checksums are hexadecimal.
struct FileRow {
  std::string session;
  std::uint32_t part = 0;
  std::string recorded_sha256;  ///< Of the file, as dtsd has it.
  std::string sent_sha256{};    ///< Of the bytes that leave; empty: not known yet.
  std::string file{};
  std::uint64_t bytes = 0;
  std::int64_t started_utc_ns = 0;
  FileState state = FileState::Waiting;
  std::uint32_t tries = 0;
  std::int64_t receipt_utc_ns = 0;
  std::string hub{};
  std::string why_not{};
  bool is_session_sent = false;  ///< The centre has the newest facts of its session, or does not want them.
};

/// A session that dtsd does not list any more.
struct MissingSession {
  std::string id;
  std::int64_t listed_utc_ns = 0;  ///< The last complete list that had it,
  std::int64_t missed_utc_ns = 0;  ///< and the first that had not.
};

/// What is known of the outbox: which facts and files the centre has. dtsd, the recordings and the centre's answers restore all of it
/// except the erasures: without it, sessions whose erasure the centre has not confirmed stay there. Thread: any.
class Store {
 public:
  /// Opens or creates FOLDER/sent.sqlite. Fails with DataDamaged if it is damaged. Drops what another version of this program wrote.
  [[nodiscard]] static core::Result<std::unique_ptr<Store>> open(const std::string& folder);

  /// Renames a damaged store and its files; replaces nothing that was set aside before. Returns the new name.
  [[nodiscard]] static core::Result<std::string> set_aside(const std::string& folder);

  /// If the rules have changed, all sessions are looked at again, and the files without a receipt are read again.
  [[nodiscard]] core::Status set_rules(const wire::SendRules& rules);

  /// Receipts count for one clinic at one centre. If the name of the clinic or the authority of the centre has changed, all facts and files
  /// are offered again.
  [[nodiscard]] core::Status set_centre(const std::string& clinic, const std::string& ca_pem);

  /// The centre may have lost what it had: all facts and files are offered again, and all erasures are sent again.
  [[nodiscard]] core::Status offer_again();

  /// Tries again what was held or rejected: a person may have corrected the reason.
  [[nodiscard]] core::Status retry_held();

  /// Returns true if the session was listed differently, or not at all, when `put_session` stored it.
  [[nodiscard]] core::Result<bool> is_changed(const v1::SessionRecord& listed) const;
  /// Stores the facts of a session and its closed recordings. `listed`: as in the list, `shown`: with trials. `utc_ns`: now.
  [[nodiscard]] core::Status put_session(const v1::SessionRecord& listed, const v1::SessionRecord& shown, const wire::SendRules& rules,
                                         std::int64_t utc_ns);
  /// Returns facts that the centre does not have, those of the oldest session first; nothing if there are none. `without`: not of these
  /// sessions, as in `next_erased`.
  [[nodiscard]] core::Result<std::optional<v1::FleetSession>> next_facts(const std::set<std::string>& without = {}) const;
  /// The centre has these facts, as its `revision`. If that is a larger one, the facts are sent again with the next.
  [[nodiscard]] core::Status facts_answered(const v1::FleetSession& sent, std::uint64_t revision);
  [[nodiscard]] core::Status facts_rejected(const v1::FleetSession& sent, const std::string& reason);

  /// Notes which sessions dtsd has, from a complete list that was asked for at `utc_ns`. Returns those that are missing, with the time when
  /// dtsd last listed them.
  [[nodiscard]] core::Result<std::vector<MissingSession>> note_list(const std::vector<std::string>& listed, std::int64_t utc_ns);
  /// The sessions that are missing now were not erased: `note_list` does not return them before dtsd has listed them again.
  [[nodiscard]] core::Status keep_missing();
  /// Returns the entry of dtsd's audit trail that was the newest when it was last read; empty: none was.
  [[nodiscard]] core::Result<std::string> newest_audit() const;
  [[nodiscard]] core::Status set_newest_audit(const std::string& entry);
  /// Returns all sessions that are known and not erased.
  [[nodiscard]] core::Result<std::vector<std::string>> sessions() const;
  /// The clinic has erased this session: the centre must do so too.
  [[nodiscard]] core::Status set_erased(const std::string& session);
  [[nodiscard]] core::Result<std::optional<std::string>> next_erased(const std::set<std::string>& without = {}) const;
  /// The centre has erased it. Its ID is kept for `offer_again`.
  [[nodiscard]] core::Status erasure_answered(const std::string& session);

  /// Returns the file to send next: of the oldest session whose facts the centre has, otherwise of the oldest. Not before its time, see
  /// `postpone`.
  [[nodiscard]] core::Result<std::optional<FileRow>> next_file(std::int64_t utc_ns) const;
  /// Stores the checksum of the bytes that leave; the facts of the session get it, too.
  [[nodiscard]] core::Status set_sent_sha256(const FileRow& file, const Hashes& hashes, std::int64_t utc_ns);
  [[nodiscard]] core::Status set_stored(const FileRow& file, const v1::Receipt& receipt);
  [[nodiscard]] core::Status hold(const FileRow& file, const std::string& why_not);
  [[nodiscard]] core::Status postpone(const FileRow& file, std::int64_t until_utc_ns, const std::string& why_not);
  [[nodiscard]] core::Status add_tries(const FileRow& file, std::uint32_t tries);
  /// Returns true unless its session was erased, or another file has replaced it.
  [[nodiscard]] core::Result<bool> is_wanted(const FileRow& file) const;

  [[nodiscard]] core::Result<v1::Backlog> backlog() const;
  /// Returns the files with this checksum, of the recording or of what was sent, in hexadecimal.
  [[nodiscard]] core::Result<std::vector<FileRow>> find(const std::string& sha256) const;
  [[nodiscard]] core::Result<std::vector<FileRow>> held() const;
  [[nodiscard]] core::Result<std::vector<std::pair<std::string, std::string>>> rejected_facts() const;

  /// What `dts-forward status` shows besides: words and values of the running program.
  [[nodiscard]] core::Status set_words(const std::map<std::string, std::string>& words);
  [[nodiscard]] core::Result<std::map<std::string, std::string>> words() const;

 private:
  explicit Store(record::Database database) : database_(std::move(database)) {}
  template <class Action>
  auto guarded(Action action) const;
  void put_facts(v1::FleetSession facts, std::int64_t utc_ns) const;

  mutable std::mutex mutex_;
  record::Database database_;
};

}  // namespace dts::fleet::forward
