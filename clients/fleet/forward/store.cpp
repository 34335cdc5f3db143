// SPDX-License-Identifier: Apache-2.0
#include "fleet/forward/store.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include <sodium.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <type_traits>

#include "core/clock.h"
#include "fleet/wire/messages.h"
#include "record/sha256.h"

namespace dts::fleet::forward {
namespace {

constexpr std::int64_t kVersion = 1;
// Values of session.is_erased; 0: it is not erased.
constexpr int kToErase = 1;  // The centre has not answered yet.
constexpr int kErased = 2;
constexpr int kMissingAndNotErased = -1;  // Value of session.missing_since; 0: it is not missing, otherwise since when.
constexpr std::size_t kHexDigits = 2 * wire::kSha256Bytes;
constexpr const char* kSchema =
    "CREATE TABLE session (id TEXT PRIMARY KEY, listed TEXT NOT NULL, content TEXT NOT NULL, revision INTEGER NOT NULL,"
    " is_sent INTEGER NOT NULL, why_not TEXT NOT NULL, started_utc_ns INTEGER NOT NULL, facts TEXT NOT NULL,"
    " missing_since INTEGER NOT NULL DEFAULT 0, missed_at INTEGER NOT NULL DEFAULT 0, is_erased INTEGER NOT NULL DEFAULT 0);"
    "CREATE TABLE file (session TEXT NOT NULL, part INTEGER NOT NULL, recorded TEXT NOT NULL, sent TEXT NOT NULL DEFAULT '',"
    " file TEXT NOT NULL, bytes INTEGER NOT NULL, started_utc_ns INTEGER NOT NULL, state INTEGER NOT NULL DEFAULT 0,"
    " tries INTEGER NOT NULL DEFAULT 0, receipt_utc_ns INTEGER NOT NULL DEFAULT 0, hub TEXT NOT NULL DEFAULT '',"
    " why_not TEXT NOT NULL DEFAULT '', not_before INTEGER NOT NULL DEFAULT 0, PRIMARY KEY (session, part, recorded));"
    "CREATE INDEX file_waiting ON file (state, started_utc_ns);"
    "CREATE INDEX file_recorded ON file (recorded); CREATE INDEX file_sent ON file (sent);"
    "CREATE TABLE word (name TEXT PRIMARY KEY, value TEXT NOT NULL);";
constexpr const char* kFileColumns =
    "SELECT session, part, recorded, sent, file, bytes, file.started_utc_ns, state, tries, receipt_utc_ns, hub, file.why_not,"
    " coalesce((SELECT is_sent OR why_not != '' FROM session WHERE id = file.session), 0) FROM file ";

FileRow read_file(const record::Statement& row) {
  return {.session = row.text(0),
          .part = row.count32(1),
          .recorded_sha256 = row.text(2),
          .sent_sha256 = row.text(3),
          .file = row.text(4),
          .bytes = row.count(5),
          .started_utc_ns = row.integer(6),
          .state = static_cast<FileState>(row.integer_in(7, 0, 2)),
          .tries = row.count32(8),
          .receipt_utc_ns = row.integer(9),
          .hub = row.text(10),
          .why_not = row.text(11),
          .is_session_sent = row.integer(12) != 0};
}

std::vector<FileRow> files_of(record::Statement rows) {
  std::vector<FileRow> files;
  while (rows.step()) files.push_back(read_file(rows));
  return files;
}

/// Returns the same bytes for the same message: a map has no order of its own.
std::string bytes_of(const google::protobuf::Message& message) {
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream stream(&bytes);
    google::protobuf::io::CodedOutputStream coded(&stream);
    coded.SetSerializationDeterministic(true);
    (void)message.SerializeToCodedStream(&coded);
  }
  return bytes;
}

std::string digest_of(const google::protobuf::Message& message) { return record::sha256_of(bytes_of(message)); }

bool is_closed(const v1::SessionPart& part) {
  const bool has_end =
      part.state() == v1::PART_STATE_COMPLETE || part.state() == v1::PART_STATE_INCOMPLETE || part.state() == v1::PART_STATE_RECOVERED;
  return has_end && part.sha256().size() == kHexDigits;
}

/// A message as text: the database holds only texts and numbers.
std::string text_of(const v1::FleetSession& facts) {
  const std::string bytes = bytes_of(facts);
  std::string text(2 * bytes.size() + 1, '\0');
  sodium_bin2hex(text.data(), text.size(), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  text.pop_back();
  return text;
}

std::optional<v1::FleetSession> facts_of_text(const std::string& text) {
  std::string bytes(text.size() / 2, '\0');
  std::size_t count = 0;
  v1::FleetSession facts;
  const bool is_read = sodium_hex2bin(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(), text.data(), text.size(), nullptr,
                                      &count, nullptr) == 0 &&
                       count == bytes.size() && facts.ParseFromString(bytes);
  return is_read ? std::optional(std::move(facts)) : std::nullopt;
}

}  // namespace

/// Runs the action, which may throw SQLite::Exception, alone.
template <class Action>
auto Store::guarded(Action action) const {
  using Value = decltype(action());
  const std::lock_guard lock(mutex_);
  try {
    if constexpr (std::is_void_v<Value>) {
      record::Transaction transaction(database_);
      action();
      transaction.commit();
      return core::Status();
    } else {
      return core::Result<Value>(action());
    }
  } catch (const SQLite::Exception& exception) {
    core::Error error = database_.failure(exception).value();
    error.hint =
        "check the disk and the folder `state` of forward.toml; keep sent.sqlite in it: it knows which sessions the centre must erase";
    return core::Result<Value>(tl::make_unexpected(std::move(error)));
  }
}

core::Result<std::unique_ptr<Store>> Store::open(const std::string& folder) {
  DTS_TRY_ASSIGN(auto database, record::Database::open(folder + "/sent.sqlite"));
  std::unique_ptr<Store> store(new Store(std::move(database)));
  // Reads the version without a transaction: `dts-forward status` must not wait for the writes of the running service.
  const auto has_tables = [&store] { return store->database_.number("PRAGMA user_version") == kVersion; };
  DTS_TRY_ASSIGN(const bool is_made, store->guarded(has_tables));
  if (!is_made) {
    DTS_TRY(store->guarded([&] {
      if (has_tables()) return;  // another process has just made them
      const record::Database& opened = store->database_;
      opened.execute("DROP TABLE IF EXISTS session; DROP TABLE IF EXISTS file; DROP TABLE IF EXISTS word;");
      opened.execute(kSchema);
      opened.execute("PRAGMA user_version = " + std::to_string(kVersion));
    }));
  }
  try {  // not within a transaction: a receipt that a power failure removes is sent again by the centre
    store->database_.execute("PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL;");
  } catch (const SQLite::Exception& exception) {
    return store->database_.failure(exception);
  }
  return store;
}

core::Result<std::string> Store::set_aside(const std::string& folder) {
  const std::string file = folder + "/sent.sqlite";
  const auto is_there = [](const std::string& name) {
    std::error_code unknown;
    return std::filesystem::exists(std::filesystem::symlink_status(name, unknown));
  };
  // The database comes last: a new one beside the log of this one would be damaged, too.
  constexpr std::array<const char*, 3> kEndings{"-wal", "-shm", ""};
  const auto is_free = [&](const std::string& name) {
    return std::ranges::none_of(kEndings, [&](const char* ending) { return is_there(name + ending); });
  };
  std::string aside = file + ".damaged-1";
  for (int number = 2; !is_free(aside); ++number) aside = file + ".damaged-" + std::to_string(number);
  for (const char* ending : kEndings) {
    if (!is_there(file + ending)) continue;
    std::error_code error;
    std::filesystem::rename(file + ending, aside + ending, error);
    if (error) {
      return core::fail_errno(error.value(), "the damaged " + file + " cannot be renamed",
                              "move it and all files beside it to another folder");
    }
  }
  return aside;
}

core::Status Store::set_rules(const wire::SendRules& rules) {
  return guarded([this, &rules] {
    std::string text = rules.labels ? "labels" : "";
    for (const std::string& field : rules.fields) text += "\n" + field;
    auto row = database_.query("SELECT 1 FROM word WHERE name = 'rules' AND value = ?", text);
    if (row.step()) return;
    database_.run("INSERT OR REPLACE INTO word (name, value) VALUES ('rules', ?)", text);
    database_.run("UPDATE session SET listed = '', content = '', facts = ''");  // the stored facts follow the earlier rules
    database_.run("UPDATE file SET sent = '' WHERE state != ?", static_cast<int>(FileState::Stored));
  });
}

core::Status Store::set_centre(const std::string& clinic, const std::string& ca_pem) {
  return guarded([this, &clinic, &ca_pem] {
    const std::string text = clinic + "\n" + ca_pem;
    auto row = database_.query("SELECT 1 FROM word WHERE name = 'centre' AND value = ?", text);
    if (row.step()) return;
    database_.run("INSERT OR REPLACE INTO word (name, value) VALUES ('centre', ?)", text);
    database_.run("UPDATE session SET is_sent = 0, why_not = '', listed = '', content = ''");
    database_.run("UPDATE file SET state = ?, sent = '', tries = 0, receipt_utc_ns = 0, hub = '', why_not = '', not_before = 0",
                  static_cast<int>(FileState::Waiting));
  });
}

core::Status Store::offer_again() {
  return guarded([this] {
    database_.run("UPDATE session SET is_sent = 0, why_not = '', listed = '', content = ''");
    database_.run("UPDATE session SET is_erased = ? WHERE is_erased = ?", kToErase, kErased);
    database_.run("UPDATE file SET state = ?, tries = 0, receipt_utc_ns = 0, hub = '', why_not = '', not_before = 0",
                  static_cast<int>(FileState::Waiting));
  });
}

core::Status Store::retry_held() {
  return guarded([this] {
    database_.run("UPDATE file SET state = ?, sent = '', why_not = '' WHERE state = ?", static_cast<int>(FileState::Waiting),
                  static_cast<int>(FileState::Held));
    database_.run("UPDATE file SET not_before = 0");
    database_.run("UPDATE session SET why_not = '', listed = '' WHERE why_not != ''");
  });
}

core::Result<bool> Store::is_changed(const v1::SessionRecord& listed) const {
  return guarded([this, &listed] {
    return !database_.query("SELECT 1 FROM session WHERE id = ? AND listed = ?", listed.session_id(), digest_of(listed)).step();
  });
}

/// Stores facts under a new revision if they differ from those that are known. The time as revision needs no memory: after the loss of this
/// file, a new revision is larger than all before. If the clock was wrong, the centre's answer has a larger one.
void Store::put_facts(v1::FleetSession facts, std::int64_t utc_ns) const {
  for (v1::FleetPart& part : *facts.mutable_parts()) {
    part.clear_sha256();
    auto row = database_.query("SELECT sent FROM file WHERE session = ? AND part = ? AND recorded = ? AND sent != ''", facts.session_id(),
                               part.part(), wire::hex_of(part.recorded_sha256()));
    if (!row.step()) continue;
    if (auto sha256 = wire::bytes_of_hex(row.text(0))) part.set_sha256(std::move(*sha256));
  }
  facts.clear_revision();
  const std::string content = digest_of(facts);
  std::int64_t revision = utc_ns / core::kNanosecondsPerMillisecond;
  {
    auto known = database_.query("SELECT content, revision FROM session WHERE id = ?", facts.session_id());
    if (known.step()) {
      if (known.text(0) == content) return;
      revision = std::max(revision, known.integer(1) + 1);
    }
  }
  facts.set_revision(static_cast<std::uint64_t>(std::max<std::int64_t>(revision, 1)));
  database_.run(
      "INSERT INTO session (id, listed, content, revision, is_sent, why_not, started_utc_ns, facts) VALUES (?, '', ?, ?, 0, '', ?, ?)"
      " ON CONFLICT (id) DO UPDATE SET content = excluded.content, revision = excluded.revision, is_sent = 0, why_not = '',"
      " started_utc_ns = excluded.started_utc_ns, facts = excluded.facts",
      facts.session_id(), content, facts.revision(), facts.started_utc_ns(), text_of(facts));
}

core::Status Store::put_session(const v1::SessionRecord& listed, const v1::SessionRecord& shown, const wire::SendRules& rules,
                                std::int64_t utc_ns) {
  return guarded([this, &listed, &shown, &rules, utc_ns] {
    for (const v1::SessionPart& part : shown.parts()) {
      if (!is_closed(part)) continue;
      database_.run("DELETE FROM file WHERE session = ? AND part = ? AND recorded != ? AND state != ?", shown.session_id(), part.part(),
                    part.sha256(), static_cast<int>(FileState::Stored));
      database_.run(
          "INSERT INTO file (session, part, recorded, file, bytes, started_utc_ns) VALUES (?, ?, ?, ?, ?, ?)"
          " ON CONFLICT (session, part, recorded) DO UPDATE SET file = excluded.file, bytes = excluded.bytes",
          shown.session_id(), part.part(), part.sha256(), part.file(), part.bytes(), shown.started_utc_ns());
    }
    put_facts(wire::facts_of(shown, rules), utc_ns);
    database_.run("UPDATE session SET listed = ?, is_erased = 0 WHERE id = ?", digest_of(listed), listed.session_id());
  });
}

core::Result<std::optional<v1::FleetSession>> Store::next_facts(const std::set<std::string>& without) const {
  return guarded([this, &without]() -> std::optional<v1::FleetSession> {
    auto row = database_.query(
        "SELECT id, facts FROM session WHERE is_sent = 0 AND why_not = '' AND is_erased = 0 AND facts != '' ORDER BY started_utc_ns LIMIT "
        "?",
        without.size() + 1);
    while (row.step()) {
      if (!without.contains(row.text(0))) return facts_of_text(row.text(1));
    }
    return std::nullopt;
  });
}

core::Status Store::facts_answered(const v1::FleetSession& sent, std::uint64_t revision) {
  return guarded([this, &sent, revision] {
    if (revision > sent.revision()) {
      v1::FleetSession again = sent;
      again.set_revision(revision + 1);
      database_.run("UPDATE session SET revision = ?, facts = ? WHERE id = ? AND revision = ?", again.revision(), text_of(again),
                    sent.session_id(), sent.revision());
      return;
    }
    // They are kept while a checksum will be added to them.
    database_.run(
        "UPDATE session SET is_sent = 1, facts = CASE WHEN EXISTS (SELECT 1 FROM file WHERE session = ? AND sent = '' AND state = ?) THEN "
        "facts"
        " ELSE '' END WHERE id = ? AND revision = ?",
        sent.session_id(), static_cast<int>(FileState::Waiting), sent.session_id(), sent.revision());
  });
}

core::Status Store::facts_rejected(const v1::FleetSession& sent, const std::string& reason) {
  return guarded([this, &sent, &reason] {
    database_.run("UPDATE session SET why_not = ? WHERE id = ? AND revision = ?", reason.empty() ? "rejected" : reason, sent.session_id(),
                  sent.revision());
  });
}

core::Result<std::vector<MissingSession>> Store::note_list(const std::vector<std::string>& listed, std::int64_t utc_ns) {
  return guarded([this, &listed, utc_ns] {
    record::Transaction transaction(database_);
    database_.execute("CREATE TEMP TABLE IF NOT EXISTS listed (id TEXT PRIMARY KEY); DELETE FROM listed;");
    {
      auto insert = database_.query("INSERT OR IGNORE INTO listed (id) VALUES (?)", std::string());
      for (const std::string& id : listed) {
        insert.bind(id);
        (void)insert.step();
      }
    }
    const std::int64_t before =
        database_.number("SELECT coalesce((SELECT CAST(value AS INTEGER) FROM word WHERE name = 'listed_utc_ns'), 0)");
    database_.run("UPDATE session SET missing_since = 0 WHERE missing_since != 0 AND id IN (SELECT id FROM listed)");
    database_.run("UPDATE session SET missing_since = ?, missed_at = ? WHERE missing_since = 0 AND id NOT IN (SELECT id FROM listed)",
                  before, utc_ns);
    database_.run("INSERT OR REPLACE INTO word (name, value) VALUES ('listed_utc_ns', ?)", std::to_string(utc_ns));
    std::vector<MissingSession> missing;
    {
      auto rows = database_.query("SELECT id, missing_since, missed_at FROM session WHERE missing_since > 0 AND is_erased = 0");
      while (rows.step()) missing.push_back({.id = rows.text(0), .listed_utc_ns = rows.integer(1), .missed_utc_ns = rows.integer(2)});
    }
    transaction.commit();
    return missing;
  });
}

core::Status Store::keep_missing() {
  return guarded(
      [this] { database_.run("UPDATE session SET missing_since = ? WHERE missing_since > 0 AND is_erased = 0", kMissingAndNotErased); });
}

core::Result<std::string> Store::newest_audit() const {
  return guarded([this] {
    auto row = database_.query("SELECT value FROM word WHERE name = 'newest_audit'");
    return row.step() ? row.text(0) : std::string();
  });
}

core::Status Store::set_newest_audit(const std::string& entry) {
  return guarded([this, &entry] { database_.run("INSERT OR REPLACE INTO word (name, value) VALUES ('newest_audit', ?)", entry); });
}

core::Result<std::vector<std::string>> Store::sessions() const {
  return guarded([this] {
    std::vector<std::string> ids;
    auto rows = database_.query("SELECT id FROM session WHERE is_erased = 0");
    while (rows.step()) ids.push_back(rows.text(0));
    return ids;
  });
}

core::Status Store::set_erased(const std::string& session) {
  return guarded(
      [this, &session] { database_.run("UPDATE session SET is_erased = ?, facts = '', why_not = '' WHERE id = ?", kToErase, session); });
}

core::Result<std::optional<std::string>> Store::next_erased(const std::set<std::string>& without) const {
  return guarded([this, &without]() -> std::optional<std::string> {
    auto row = database_.query("SELECT id FROM session WHERE is_erased = ?", kToErase);
    while (row.step()) {
      if (!without.contains(row.text(0))) return row.text(0);
    }
    return std::nullopt;
  });
}

core::Status Store::erasure_answered(const std::string& session) {
  return guarded([this, &session] {
    database_.run("DELETE FROM file WHERE session = ?", session);
    database_.run("UPDATE session SET is_erased = ? WHERE id = ? AND is_erased = ?", kErased, session, kToErase);
  });
}

core::Result<std::optional<FileRow>> Store::next_file(std::int64_t utc_ns) const {
  return guarded([this, utc_ns]() -> std::optional<FileRow> {
    for (const char* const whose : {"AND (is_sent = 1 OR session.why_not != '')", ""}) {
      auto files = files_of(database_.query(
          std::string(kFileColumns) + "JOIN session ON session.id = file.session WHERE state = ? AND not_before <= ? AND is_erased = 0 " +
              whose + " ORDER BY file.started_utc_ns, session, part LIMIT 1",
          static_cast<int>(FileState::Waiting), utc_ns));
      if (!files.empty()) return std::move(files.front());
    }
    return std::nullopt;
  });
}

core::Status Store::set_sent_sha256(const FileRow& file, const Hashes& hashes, std::int64_t utc_ns) {
  return guarded([this, &file, &hashes, utc_ns] {
    database_.run("UPDATE file SET sent = ?, bytes = ?, why_not = '' WHERE session = ? AND part = ? AND recorded = ?",
                  wire::hex_of(hashes.sent_sha256), hashes.bytes, file.session, file.part, file.recorded_sha256);
    std::optional<v1::FleetSession> facts;
    {
      auto row = database_.query("SELECT facts FROM session WHERE id = ? AND facts != ''", file.session);
      if (row.step()) facts = facts_of_text(row.text(0));
    }
    if (facts) put_facts(std::move(*facts), utc_ns);
  });
}

core::Status Store::set_stored(const FileRow& file, const v1::Receipt& receipt) {
  return guarded([this, &file, &receipt] {
    database_.run("UPDATE file SET state = ?, receipt_utc_ns = ?, hub = ?, why_not = '' WHERE session = ? AND part = ? AND recorded = ?",
                  static_cast<int>(FileState::Stored), receipt.stored_utc_ns(), receipt.hub(), file.session, file.part,
                  file.recorded_sha256);
  });
}

core::Status Store::hold(const FileRow& file, const std::string& why_not) {
  return guarded([this, &file, &why_not] {
    database_.run("UPDATE file SET state = ?, why_not = ? WHERE session = ? AND part = ? AND recorded = ? AND state = ?",
                  static_cast<int>(FileState::Held), why_not, file.session, file.part, file.recorded_sha256,
                  static_cast<int>(FileState::Waiting));
  });
}

core::Status Store::postpone(const FileRow& file, std::int64_t until_utc_ns, const std::string& why_not) {
  return guarded([this, &file, until_utc_ns, &why_not] {
    database_.run("UPDATE file SET not_before = ?, why_not = ? WHERE session = ? AND part = ? AND recorded = ?", until_utc_ns, why_not,
                  file.session, file.part, file.recorded_sha256);
  });
}

core::Status Store::add_tries(const FileRow& file, std::uint32_t tries) {
  return guarded([this, &file, tries] {
    database_.run("UPDATE file SET tries = tries + ? WHERE session = ? AND part = ? AND recorded = ?", tries, file.session, file.part,
                  file.recorded_sha256);
  });
}

core::Result<bool> Store::is_wanted(const FileRow& file) const {
  return guarded([this, &file] {
    return database_
        .query(
            "SELECT 1 FROM file JOIN session ON session.id = file.session WHERE session = ? AND part = ? AND recorded = ? AND state = ?"
            " AND is_erased = 0",
            file.session, file.part, file.recorded_sha256, static_cast<int>(FileState::Waiting))
        .step();
  });
}

core::Result<v1::Backlog> Store::backlog() const {
  return guarded([this] {
    v1::Backlog out;
    auto row = database_.query(
        "SELECT count(*) FILTER (WHERE state = 0), coalesce(sum(bytes) FILTER (WHERE state = 0), 0), coalesce(min(started_utc_ns) FILTER "
        "(WHERE state = 0), 0), coalesce(max(receipt_utc_ns), 0), count(*) FILTER (WHERE state = 2) FROM file");
    if (!row.step()) return out;
    out.set_files(row.count32(0));
    out.set_bytes(row.count(1));
    out.set_oldest_utc_ns(row.integer(2));
    out.set_last_receipt_utc_ns(row.integer(3));
    out.set_held_files(row.count32(4));
    return out;
  });
}

core::Result<std::vector<FileRow>> Store::find(const std::string& sha256) const {
  return guarded(
      [this, &sha256] { return files_of(database_.query(std::string(kFileColumns) + "WHERE recorded = ? OR sent = ?", sha256, sha256)); });
}

core::Result<std::vector<FileRow>> Store::held() const {
  return guarded([this] {
    return files_of(database_.query(std::string(kFileColumns) + "WHERE why_not != '' ORDER BY file.started_utc_ns LIMIT 1000"));
  });
}

core::Result<std::vector<std::pair<std::string, std::string>>> Store::rejected_facts() const {
  return guarded([this] {
    std::vector<std::pair<std::string, std::string>> found;
    auto rows = database_.query("SELECT id, why_not FROM session WHERE why_not != '' ORDER BY started_utc_ns LIMIT 1000");
    while (rows.step()) found.emplace_back(rows.text(0), rows.text(1));
    return found;
  });
}

core::Status Store::set_words(const std::map<std::string, std::string>& words) {
  return guarded([this, &words] {
    for (const auto& [name, value] : words) database_.run("INSERT OR REPLACE INTO word (name, value) VALUES (?, ?)", name, value);
  });
}

core::Result<std::map<std::string, std::string>> Store::words() const {
  return guarded([this] {
    std::map<std::string, std::string> words;
    auto rows = database_.query("SELECT name, value FROM word");
    while (rows.step()) words[rows.text(0)] = rows.text(1);
    return words;
  });
}

}  // namespace dts::fleet::forward
