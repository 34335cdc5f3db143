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

/// A prepared statement. Values are bound in the order of their `bind`, never pasted into the text. An error of `bind` is told by the
/// `step` that follows. Outlived by its database. Thread: one at a time.
class Statement {
 public:
  Statement& bind(std::string_view text);
  Statement& bind(double value);
  template <std::integral Integer>
  Statement& bind(Integer value) {
    if (!std::in_range<std::int64_t>(value)) has_bad_value_ = true;  // SQLite knows signed numbers only
    return bind_integer(static_cast<std::int64_t>(value));
  }

  /// True: there is a row; false: there are no more.
  [[nodiscard]] core::Result<bool> step();
  /// Runs what has no rows.
  [[nodiscard]] core::Status run();
  /// For another run with other values.
  void reset() noexcept;

  /// Columns of the row, from 0. What is stored is not trusted: a value of another type, or a number that is negative where it counts or
  /// too large, reads as empty or 0 and makes `sound` fail.
  [[nodiscard]] std::string text(int column);
  [[nodiscard]] double number(int column);
  [[nodiscard]] std::int64_t integer(int column);
  [[nodiscard]] std::uint64_t count(int column);
  [[nodiscard]] std::uint32_t count32(int column);
  [[nodiscard]] std::int64_t integer_in(int column, std::int64_t minimum, std::int64_t maximum);
  /// DataDamaged when a value read since the last `reset` was not what it should be.
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
  /// Opens or creates (mode 0640) and checks that it is sound: DataDamaged when not. Nothing has been written to an existing file when this
  /// returns.
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
  /// Several statements without values: schemas.
  [[nodiscard]] core::Status execute(const std::string& sql) const;
  /// The first column of the first row.
  [[nodiscard]] core::Result<std::int64_t> number(std::string_view sql) const;

  [[nodiscard]] std::uint64_t changes() const noexcept { return static_cast<std::uint64_t>(sqlite3_changes64(handle_.get())); }
  [[nodiscard]] bool is_in_transaction() const noexcept { return sqlite3_get_autocommit(handle_.get()) == 0; }
  [[nodiscard]] const std::string& file() const noexcept { return file_; }
  /// The last error of SQLite, with what to do.
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

/// All or nothing: what was written since `begin` is undone unless it is committed. Within another transaction it is a part of that one.
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
  const Database* database_;  ///< Null: within another, or over.
};

/// Why a catalogue that is damaged cannot be mended here, and what to do.
[[nodiscard]] tl::unexpected<core::Error> damaged_catalogue(const std::string& file, const std::string& why);

}  // namespace dts::record
