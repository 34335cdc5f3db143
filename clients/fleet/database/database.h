// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace dts::fleet::database {

/// The value of one parameter of a statement. Values never become part of the statement's text.
class Parameter {
 public:
  Parameter(std::nullptr_t /*null*/) {}  // NOLINT: a statement is called with plain values
  Parameter(std::string_view text) : bytes_(text) {}
  Parameter(const std::string& text) : bytes_(text) {}
  Parameter(const char* text) : bytes_(text) {}
  Parameter(bool value) : bytes_(value ? "t" : "f") {}
  Parameter(std::integral auto value) : bytes_(std::to_string(value)) {}
  Parameter(double value);
  template <class Value>
  Parameter(const std::optional<Value>& value) : Parameter(value ? Parameter(*value) : Parameter(nullptr)) {}

  /// A value of type bytea.
  [[nodiscard]] static Parameter binary(std::string_view bytes);

  [[nodiscard]] const std::optional<std::string>& bytes() const noexcept { return bytes_; }
  [[nodiscard]] bool is_binary() const noexcept { return is_binary_; }

 private:
  std::optional<std::string> bytes_{};
  bool is_binary_ = false;
};

/// A column of values, for `unnest($1::bigint[])`: many rows with one statement.
class Column {
 public:
  void add(const Parameter& value);
  [[nodiscard]] Parameter parameter() const { return Parameter(text_.empty() ? std::string("{}") : text_ + "}"); }

 private:
  std::string text_;
};

/// The rows that a statement returned.
class Rows {
 public:
  Rows() = default;
  explicit Rows(std::vector<std::vector<std::optional<std::string>>> cells, std::uint64_t changed)
      : cells_(std::move(cells)), changed_(changed) {}

  [[nodiscard]] std::size_t size() const noexcept { return cells_.size(); }
  [[nodiscard]] bool empty() const noexcept { return cells_.empty(); }
  /// Number of rows that an INSERT, UPDATE or DELETE changed.
  [[nodiscard]] std::uint64_t changed() const noexcept { return changed_; }

  /// Row and column must exist. Null is an empty text, 0, false.
  [[nodiscard]] bool is_null(std::size_t row, std::size_t column) const { return !cells_.at(row).at(column); }
  [[nodiscard]] std::string text(std::size_t row, std::size_t column) const { return cells_.at(row).at(column).value_or(""); }
  /// Fail with DataDamaged if the column has another type.
  [[nodiscard]] core::Result<std::int64_t> integer(std::size_t row, std::size_t column) const;
  [[nodiscard]] core::Result<double> number(std::size_t row, std::size_t column) const;
  [[nodiscard]] bool boolean(std::size_t row, std::size_t column) const { return text(row, column) == "t"; }

 private:
  std::vector<std::vector<std::optional<std::string>>> cells_{};
  std::uint64_t changed_ = 0;
};

struct DatabaseOptions {
  std::string connection;  ///< As libpq understands it: "host=/run/postgresql dbname=dts_fleet user=dts_hub".
  std::string name;        ///< Shown in pg_stat_activity: "dts-hub facts".
  bool is_durable = true;  ///< false: a commit does not wait for the disk; the newest rows may be lost with the power.
  std::chrono::milliseconds statement_timeout{10'000};
  std::string rejection_hint{};  ///< What to do if PostgreSQL rejects the user or the user's rights do not suffice.
};

/// One connection to PostgreSQL. Connects at the first statement, and again after a failure, at most once a second. Every statement that
/// fails within a transaction ends it. Thread: one at a time.
///
/// Errors: Unreachable without a connection, with `rejection_hint` as hint if PostgreSQL rejects the user; Timeout, NotAllowed, WrongState
/// for a row that breaks a key or a check, InvalidArgument for a value that its column does not take, else Failed.
class Database {
 public:
  explicit Database(DatabaseOptions options);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;
  Database(Database&&) = delete;
  Database& operator=(Database&&) = delete;

  /// Executes one statement.
  [[nodiscard]] core::Result<Rows> run(const std::string& sql, std::initializer_list<Parameter> parameters = {});
  /// Executes several statements, which are ours and have no parameters.
  [[nodiscard]] core::Status run_script(const std::string& sql);

  /// Executes `work`, which returns a Status or a Result, within a transaction: committed if it succeeds, else rolled back. If the
  /// connection fails at the commit, the caller cannot know whether it was committed: all our transactions may be repeated.
  template <class Work>
  [[nodiscard]] auto transaction(Work work) -> decltype(work()) {
    DTS_TRY(begin());
    try {
      auto result = work();
      if (!result) {
        roll_back();
        return result;
      }
      DTS_TRY(commit());
      return result;
    } catch (...) {  // no memory
      roll_back();
      throw;
    }
  }

  /// Returns how many connections were opened so far. After a new one, the database may be another one: for example an older backup.
  [[nodiscard]] std::uint64_t connections() const noexcept { return connections_; }

  /// Receives notifications of `channel` (LISTEN) from now on, also after a new connection.
  void listen(const std::string& channel);
  /// Waits for a notification, at most `timeout`. Returns true if there was one, or if there is a new connection, so that one may have
  /// been missed.
  [[nodiscard]] core::Result<bool> wait_notification(std::chrono::milliseconds timeout);

 private:
  class Connection;
  [[nodiscard]] core::Status connect();
  /// Returns why there is no connection.
  [[nodiscard]] tl::unexpected<core::Error> unreachable() const;
  /// Returns the error of a statement. Closes a connection that has ended.
  [[nodiscard]] tl::unexpected<core::Error> failed(core::Error error);
  [[nodiscard]] core::Status begin();
  [[nodiscard]] core::Status commit();
  void roll_back();

  DatabaseOptions options_;
  std::string channel_{};
  std::uint64_t connections_ = 0;
  bool may_have_missed_ = false;
  bool is_in_transaction_ = false;
  std::chrono::steady_clock::time_point next_try_{};
  std::string last_problem_{};
  std::unique_ptr<Connection> connection_;
};

}  // namespace dts::fleet::database
