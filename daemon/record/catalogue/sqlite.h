// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sqlite3.h>

#include <concepts>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "core/result.h"

namespace dts::record {

class Database;

/// A prepared statement. `bind` binds values in the order of its calls; values are never part of the SQL text. If a `bind` failed, the next
/// `step` fails. The database must outlive the statement. Thread: one at a time.
class Statement {
 public:
  Statement& bind(std::string_view text);
  Statement& bind(double value);
  template <std::integral Integer>
  Statement& bind(Integer value) {
    if (!std::in_range<std::int64_t>(value)) has_bad_value_ = true;  // SQLite stores only signed numbers
    return bind_integer(static_cast<std::int64_t>(value));
  }

  /// Steps to the next row; returns false if there are no more rows.
  [[nodiscard]] core::Result<bool> step();
  /// Runs a statement that returns no rows.
  [[nodiscard]] core::Status run();
  /// Prepares the statement for another run with new values.
  void reset() noexcept;

  /// Read a column of the row; `column` counts from 0. If a stored value has another type or is out of range, they return an empty value,
  /// and `sound` fails.
  [[nodiscard]] std::string text(int column);
  [[nodiscard]] double number(int column);
  [[nodiscard]] std::int64_t integer(int column);
  [[nodiscard]] std::uint64_t count(int column);
  [[nodiscard]] std::uint32_t count32(int column);
  [[nodiscard]] std::int64_t integer_in(int column, std::int64_t minimum, std::int64_t maximum);
  /// Fails with DataDamaged if a value read since the last `reset` had the wrong type or was out of range.
  [[nodiscard]] core::Status sound() const;

 private:
  friend class Database;
  struct Finalise {
    void operator()(sqlite3_stmt* statement) const noexcept { sqlite3_finalize(statement); }
  };
  Statement(const Database& database, sqlite3_stmt* statement) : database_(&database), statement_(statement) {}
  Statement& bind_integer(std::int64_t value);
  [[nodiscard]] bool has_type(int column, int type);

  const Database* database_;
  std::unique_ptr<sqlite3_stmt, Finalise> statement_;
  int bound_ = 0;
  bool has_bad_value_ = false;
  std::string damage_;
};

/// An SQLite file. Thread: one at a time.
class Database {
 public:
  /// Opens or creates (mode 0640) a database. Fails with DataDamaged if it is damaged. Does not write to an existing file.
  [[nodiscard]] static core::Result<Database> open(const std::string& file);

  [[nodiscard]] core::Result<Statement> prepare(std::string_view sql) const;
  template <class... Values>
  [[nodiscard]] core::Result<Statement> query(std::string_view sql, const Values&... values) const {
    auto statement = prepare(sql);
    if (statement) (statement->bind(values), ...);
    return statement;
  }
  template <class... Values>
  [[nodiscard]] core::Status run(std::string_view sql, const Values&... values) const {
    auto statement = query(sql, values...);
    return statement ? statement->run() : core::Status(tl::make_unexpected(statement.error()));
  }
  /// Runs several statements without values, such as a schema.
  [[nodiscard]] core::Status execute(const std::string& sql) const;
  /// Returns the first column of the first row.
  [[nodiscard]] core::Result<std::int64_t> number(std::string_view sql) const;

  [[nodiscard]] std::uint64_t changes() const noexcept { return static_cast<std::uint64_t>(sqlite3_changes64(handle_.get())); }
  [[nodiscard]] bool is_in_transaction() const noexcept { return sqlite3_get_autocommit(handle_.get()) == 0; }
  [[nodiscard]] const std::string& file() const noexcept { return file_; }
  /// Returns the last error of SQLite and what to do about it.
  [[nodiscard]] tl::unexpected<core::Error> failure(const std::string& doing) const;

 private:
  struct Close {
    void operator()(sqlite3* handle) const noexcept { sqlite3_close_v2(handle); }
  };
  Database(std::string file, sqlite3* handle) : file_(std::move(file)), handle_(handle) {}
  [[nodiscard]] core::Status configure() const;
  [[nodiscard]] core::Status check() const;

  std::string file_;
  std::unique_ptr<sqlite3, Close> handle_;
};

/// Undoes all changes since `begin` unless `commit` succeeds. Inside another transaction it has no effect: the outer one decides.
class Transaction {
 public:
  [[nodiscard]] static core::Result<Transaction> begin(const Database& database);
  ~Transaction();
  Transaction(Transaction&& other) noexcept : database_(std::exchange(other.database_, nullptr)) {}
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  Transaction& operator=(Transaction&&) = delete;
  [[nodiscard]] core::Status commit();

 private:
  explicit Transaction(const Database* database) : database_(database) {}
  const Database* database_;  ///< Null: inside another transaction, or ended.
};

/// Returns the error for a damaged catalogue, with what to do.
[[nodiscard]] tl::unexpected<core::Error> damaged_catalogue(const std::string& file, const std::string& why);

}  // namespace dts::record
