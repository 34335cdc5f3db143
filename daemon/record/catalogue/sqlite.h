// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>
#include <sqlite3.h>

#include <chrono>
#include <concepts>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/result.h"

namespace dts::record {

/// A prepared statement. Values are never part of the SQL text. The database must outlive the statement. All functions throw
/// SQLite::Exception, see `Database`. Thread: one at a time.
class Statement {
 public:
  template <class... Values>
  explicit Statement(const SQLite::Database& database, const std::string& sql, const Values&... values) : statement_(database, sql) {
    bind(values...);
  }

  /// Binds the values in their order, for the first or for another run.
  template <class... Values>
  void bind(const Values&... values) {
    statement_.reset();
    [[maybe_unused]] int index = 0;
    (bind_at(++index, values), ...);
  }
  /// Steps to the next row; returns false if there are no more rows.
  [[nodiscard]] bool step() { return statement_.executeStep(); }

  /// Read a column of the row; `column` counts from 0. They throw SQLITE_CORRUPT if the value has another type or is out of range.
  [[nodiscard]] std::string text(int column) const { return cell(column, SQLite::TEXT).getString(); }
  [[nodiscard]] double number(int column) const { return cell(column, SQLite::FLOAT).getDouble(); }
  [[nodiscard]] std::int64_t integer(int column) const { return cell(column, SQLite::INTEGER).getInt64(); }
  [[nodiscard]] std::uint64_t count(int column) const;
  [[nodiscard]] std::uint32_t count32(int column) const;
  [[nodiscard]] std::int64_t integer_in(int column, std::int64_t minimum, std::int64_t maximum) const;

 private:
  void bind_at(int index, std::string_view text);
  void bind_at(int index, double value) { statement_.bind(index, value); }
  template <std::integral Integer>
  void bind_at(int index, Integer value) {
    if (!std::in_range<std::int64_t>(value)) throw_too_large(index);  // SQLite stores only signed numbers
    statement_.bind(index, static_cast<std::int64_t>(value));
  }
  [[noreturn]] static void throw_too_large(int index);
  [[nodiscard]] SQLite::Column cell(int column, int type) const;

  SQLite::Statement statement_;
};

/// An SQLite file. In this room a failure of SQLite is a SQLite::Exception, also one from `Statement` and `Transaction`. No exception
/// leaves the room: each public function of Catalogue and AuditTrail, and `migrate`, catches it and returns `failure`. Thread: one at a
/// time.
class Database {
 public:
  /// Opens or creates (mode 0640) a database. Fails with DataDamaged if it is damaged. Does not write to an existing file.
  [[nodiscard]] static core::Result<Database> open(const std::string& file);
  /// Opens a further connection to a database that `open` has checked. The check reads the whole file.
  [[nodiscard]] static core::Result<Database> open_again(const std::string& file);

  template <class... Values>
  [[nodiscard]] Statement query(const std::string& sql, const Values&... values) const {
    return Statement(database_, sql, values...);
  }
  /// Runs a statement and ignores its rows.
  template <class... Values>
  void run(const std::string& sql, const Values&... values) const {
    auto statement = query(sql, values...);
    while (statement.step()) continue;
  }
  /// Runs several statements without values, such as a schema.
  void execute(const std::string& sql) const { database_.exec(sql); }
  /// Returns the first column of the first row; 0 if there is no row.
  [[nodiscard]] std::int64_t number(const std::string& sql) const;

  /// Sets how long a statement waits while another connection locks the file.
  void wait_at_most(std::chrono::milliseconds time) const { database_.setBusyTimeout(static_cast<int>(time.count())); }
  /// Ends a statement with SQLITE_INTERRUPT as soon as `is_wanted`, which is called often, returns false. It must outlive this object.
  void interrupt_unless(const std::function<bool()>& is_wanted) const;

  [[nodiscard]] int changes() const noexcept { return database_.getChanges(); }
  [[nodiscard]] const std::string& file() const noexcept { return file_; }
  [[nodiscard]] bool is_in_transaction() const noexcept { return sqlite3_get_autocommit(database_.getHandle()) == 0; }
  /// Returns the error for an exception of this database, and what to do about it.
  [[nodiscard]] tl::unexpected<core::Error> failure(const SQLite::Exception& exception) const;

 private:
  friend class Transaction;
  Database(std::string file, const std::string& path);
  [[nodiscard]] static core::Result<Database> open(const std::string& file, bool is_checked);
  void configure() const;
  void check() const;

  std::string file_;
  mutable SQLite::Database database_;  ///< Its `exec` is not const.
};

/// Undoes all changes since its start unless `commit` succeeds. Inside another transaction it has no effect: the outer one decides.
class Transaction {
 public:
  explicit Transaction(const Database& database);
  void commit();

 private:
  std::optional<SQLite::Transaction> outermost_;
};

}  // namespace dts::record
