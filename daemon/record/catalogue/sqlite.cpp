// SPDX-License-Identifier: Apache-2.0
#include "record/catalogue/sqlite.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <limits>
#include <system_error>

namespace dts::record {
namespace {

using core::ErrorCode;

constexpr int kBusyTimeoutMs = 1000;         // the control thread waits so long if another program locks the file
constexpr int kLongestValueBytes = 4 << 20;  // texts of recordings are at most 1 MiB

/// Creates the file with mode 0640 (SQLite would use 0644). Fails with the system's reason if the path is no usable file.
core::Status create_private(const std::string& file) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK, 0640);
  if (descriptor < 0) {
    return core::fail_errno(errno, "cannot open the catalogue " + file,
                            "does the folder exist, and may dtsd write there? see directory under [storage] in dtsd.toml");
  }
  struct stat facts {};
  const bool is_file = ::fstat(descriptor, &facts) == 0 && S_ISREG(facts.st_mode);
  ::close(descriptor);
  if (is_file) return {};
  return damaged_catalogue(file, "it is no ordinary file");
}

ErrorCode code_of(int result) {
  switch (result & 0xff) {
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB: return ErrorCode::DataDamaged;
    case SQLITE_PERM:
    case SQLITE_READONLY:
    case SQLITE_AUTH: return ErrorCode::NotAllowed;
    case SQLITE_BUSY:
    case SQLITE_LOCKED: return ErrorCode::Timeout;
    case SQLITE_TOOBIG:
    case SQLITE_RANGE: return ErrorCode::LimitExceeded;
    case SQLITE_CONSTRAINT: return ErrorCode::InvalidArgument;
    case SQLITE_MISUSE: return ErrorCode::Internal;
    default: return ErrorCode::Failed;
  }
}

std::string hint_of(int result) {
  switch (result & 0xff) {
    case SQLITE_FULL: return "make room on the disk of the state folder";
    case SQLITE_READONLY:
    case SQLITE_PERM: return "the state folder must be writable for dtsd";
    case SQLITE_BUSY:
    case SQLITE_LOCKED: return "does another program hold it? only one dtsd may use a state folder";
    case SQLITE_IOERR:
    case SQLITE_CANTOPEN: return "is the disk of the state folder full, read-only or failing?";
    default: return "";
  }
}

}  // namespace

tl::unexpected<core::Error> damaged_catalogue(const std::string& file, const std::string& why) {
  return core::fail(ErrorCode::DataDamaged, "the catalogue " + file + " is damaged: " + why,
                    "start dtsd again: it sets the catalogue aside and makes it anew from the recordings, all but the audit trail");
}

Statement& Statement::bind(std::string_view text) {
  const char* bytes = text.data() == nullptr ? "" : text.data();  // SQLite would store a null pointer as NULL
  has_bad_value_ |= sqlite3_bind_text64(statement_.get(), ++bound_, bytes, text.size(), SQLITE_TRANSIENT, SQLITE_UTF8) != SQLITE_OK;
  return *this;
}

Statement& Statement::bind(double value) {
  has_bad_value_ |= sqlite3_bind_double(statement_.get(), ++bound_, value) != SQLITE_OK;
  return *this;
}

Statement& Statement::bind_integer(std::int64_t value) {
  has_bad_value_ |= sqlite3_bind_int64(statement_.get(), ++bound_, value) != SQLITE_OK;
  return *this;
}

core::Result<bool> Statement::step() {
  if (has_bad_value_)
    return core::fail(ErrorCode::LimitExceeded, "value " + std::to_string(bound_) + " or one before it is too large for the catalogue");
  const int result = sqlite3_step(statement_.get());
  if (result == SQLITE_ROW) return true;
  if (result == SQLITE_DONE) return false;
  return database_->failure("the catalogue");
}

core::Status Statement::run() {
  while (true) {
    const auto row = step();
    if (!row) return tl::make_unexpected(row.error());
    if (!*row) return {};
  }
}

void Statement::reset() noexcept {
  sqlite3_reset(statement_.get());
  sqlite3_clear_bindings(statement_.get());
  bound_ = 0;
  has_bad_value_ = false;
  damage_.clear();
}

bool Statement::has_type(int column, int type) {
  if (sqlite3_column_type(statement_.get(), column) == type) return true;
  if (damage_.empty()) damage_ = std::string(sqlite3_column_name(statement_.get(), column)) + " is of the wrong type";
  return false;
}

std::string Statement::text(int column) {
  if (!has_type(column, SQLITE_TEXT)) return {};
  const void* bytes = sqlite3_column_blob(statement_.get(), column);  // the whole text, even if it contains NUL characters
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
  return bytes == nullptr ? std::string() : std::string(static_cast<const char*>(bytes), size);
}

double Statement::number(int column) { return has_type(column, SQLITE_FLOAT) ? sqlite3_column_double(statement_.get(), column) : 0.0; }

std::int64_t Statement::integer(int column) {
  return has_type(column, SQLITE_INTEGER) ? sqlite3_column_int64(statement_.get(), column) : 0;
}

std::int64_t Statement::integer_in(int column, std::int64_t minimum, std::int64_t maximum) {
  const std::int64_t value = integer(column);
  if (value >= minimum && value <= maximum) return value;
  if (damage_.empty()) damage_ = std::string(sqlite3_column_name(statement_.get(), column)) + " = " + std::to_string(value);
  return minimum;
}

std::uint64_t Statement::count(int column) {
  return static_cast<std::uint64_t>(integer_in(column, 0, std::numeric_limits<std::int64_t>::max()));
}

std::uint32_t Statement::count32(int column) {
  return static_cast<std::uint32_t>(integer_in(column, 0, std::numeric_limits<std::uint32_t>::max()));
}

core::Status Statement::sound() const {
  if (damage_.empty()) return {};
  return damaged_catalogue(database_->file(), damage_);
}

core::Result<Database> Database::open(const std::string& file) {
  if (auto created = create_private(file); !created) return tl::make_unexpected(created.error());
  std::error_code error;
  const auto path = std::filesystem::absolute(file, error);  // SQLite gives some relative names a special meaning, such as ":memory:"
  if (error) return core::fail_errno(error.value(), "cannot open the catalogue " + file);
  sqlite3* handle = nullptr;
  const int result = sqlite3_open_v2(path.c_str(), &handle, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE, nullptr);
  Database database(file, handle);  // closes the handle even if opening failed
  if (result != SQLITE_OK) return database.failure("cannot open the catalogue");
  if (auto configured = database.configure(); !configured) return tl::make_unexpected(configured.error());
  if (auto sound = database.check(); !sound) return tl::make_unexpected(sound.error());
  return database;
}

/// Restricts what the file's schema can do, because the file may be from an untrusted person.
core::Status Database::configure() const {
  sqlite3_busy_timeout(handle_.get(), kBusyTimeoutMs);
  sqlite3_limit(handle_.get(), SQLITE_LIMIT_LENGTH, kLongestValueBytes);
  sqlite3_db_config(handle_.get(), SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(handle_.get(), SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(handle_.get(), SQLITE_DBCONFIG_DQS_DDL, 0, nullptr);
  sqlite3_db_config(handle_.get(), SQLITE_DBCONFIG_DQS_DML, 0, nullptr);
  return execute("PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON;");
}

core::Status Database::check() const {
  auto statement = prepare("PRAGMA quick_check(1)");
  if (!statement) return tl::make_unexpected(statement.error());
  const auto row = statement->step();
  if (!row) return tl::make_unexpected(row.error());
  const std::string found = *row ? statement->text(0) : "no answer";
  if (found == "ok") return {};
  return damaged_catalogue(file_, found);
}

core::Result<Statement> Database::prepare(std::string_view sql) const {
  sqlite3_stmt* statement = nullptr;
  const int result = sqlite3_prepare_v2(handle_.get(), sql.data(), static_cast<int>(sql.size()), &statement, nullptr);
  if (result != SQLITE_OK) return failure("the catalogue");
  return Statement(*this, statement);
}

core::Status Database::execute(const std::string& sql) const {
  if (sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK) return {};
  return failure("the catalogue");
}

core::Result<std::int64_t> Database::number(std::string_view sql) const {
  auto statement = prepare(sql);
  if (!statement) return tl::make_unexpected(statement.error());
  const auto row = statement->step();
  if (!row) return tl::make_unexpected(row.error());
  return *row ? statement->integer(0) : 0;
}

tl::unexpected<core::Error> Database::failure(const std::string& doing) const {
  const int result = handle_ ? sqlite3_extended_errcode(handle_.get()) : SQLITE_NOMEM;
  const std::string why = handle_ ? sqlite3_errmsg(handle_.get()) : "out of memory";
  if (code_of(result) == ErrorCode::DataDamaged) return damaged_catalogue(file_, why);
  const int error = handle_ ? sqlite3_system_errno(handle_.get()) : 0;
  const bool is_of_the_system = (result & 0xff) == SQLITE_IOERR || (result & 0xff) == SQLITE_CANTOPEN;
  const std::string system = is_of_the_system && error != 0 ? " (" + std::system_category().message(error) + ")" : "";
  return core::fail(code_of(result), doing + " (" + file_ + "): " + why + system, hint_of(result));
}

core::Result<Transaction> Transaction::begin(const Database& database) {
  if (database.is_in_transaction()) return Transaction(nullptr);
  // IMMEDIATE locks the file for writing now: the caller reads before it writes, and no other program may write in between.
  if (auto begun = database.execute("BEGIN IMMEDIATE"); !begun) return tl::make_unexpected(begun.error());
  return Transaction(&database);
}

Transaction::~Transaction() {
  if (database_ != nullptr && database_->is_in_transaction()) static_cast<void>(database_->execute("ROLLBACK"));
}

core::Status Transaction::commit() {
  if (database_ == nullptr) return {};
  auto committed = database_->execute("COMMIT");
  if (committed) database_ = nullptr;
  return committed;
}

}  // namespace dts::record
