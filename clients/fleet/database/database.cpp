// SPDX-License-Identifier: Apache-2.0
#include "fleet/database/database.h"

#include <libpq-fe.h>
#include <poll.h>

#include <array>
#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

namespace dts::fleet::database {
namespace {

constexpr auto kRetryPause = std::chrono::seconds(1);

struct EndResult {
  void operator()(PGresult* result) const noexcept { PQclear(result); }
};
using ResultPointer = std::unique_ptr<PGresult, EndResult>;

std::string without_line_end(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  return text;
}

core::ErrorCode code_of(std::string_view state) {
  if (state.starts_with("23")) return core::ErrorCode::WrongState;
  if (state.starts_with("22")) return core::ErrorCode::InvalidArgument;
  if (state == "42501") return core::ErrorCode::NotAllowed;
  if (state == "57014") return core::ErrorCode::Timeout;
  // Without a state the message is of libpq: the connection failed, even if libpq has not noticed its end. 57P: the server ends.
  if (state.empty() || state.starts_with("57P")) return core::ErrorCode::Unreachable;
  return core::ErrorCode::Failed;
}

/// Returns true if PostgreSQL has answered and does not let this user in. libpq gives no code for it.
bool is_rejection(std::string_view problem) {
  const auto has = [problem](std::string_view text) { return problem.find(text) != std::string_view::npos; };
  return has("FATAL:") && (has("does not exist") || has("authentication failed") || has("permission denied") || has("pg_hba.conf") ||
                           has("not permitted to log in"));
}

template <class Number>
core::Result<Number> number_of(const std::string& text) {
  Number value{};
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && stop == text.data() + text.size()) return value;
  return core::fail(core::ErrorCode::DataDamaged, "PostgreSQL: '" + text + "' is not a number of the expected type");
}

}  // namespace

Parameter::Parameter(double value) {
  std::array<char, 32> digits{};  // the shortest text of a double has at most 24 characters
  const auto [stop, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  bytes_ = std::isfinite(value) && error == std::errc() ? std::string(digits.data(), stop) : std::string("NaN");
}

Parameter Parameter::binary(std::string_view bytes) {
  Parameter parameter(bytes);
  parameter.is_binary_ = true;
  return parameter;
}

void Column::add(const Parameter& value) {
  text_ += text_.empty() ? '{' : ',';
  if (!value.bytes()) {
    text_ += "NULL";
    return;
  }
  text_ += '"';
  for (const char letter : *value.bytes()) {
    if (letter == '"' || letter == '\\') text_ += '\\';
    text_ += letter;
  }
  text_ += '"';
}

core::Result<std::int64_t> Rows::integer(std::size_t row, std::size_t column) const {
  return is_null(row, column) ? 0 : number_of<std::int64_t>(text(row, column));
}

core::Result<double> Rows::number(std::size_t row, std::size_t column) const {
  return is_null(row, column) ? 0.0 : number_of<double>(text(row, column));
}

/// A connection of libpq and the errors of its statements.
class Database::Connection {
 public:
  explicit Connection(PGconn* connection) : connection_(connection) {}
  ~Connection() { PQfinish(connection_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  Connection(Connection&&) = delete;
  Connection& operator=(Connection&&) = delete;

  [[nodiscard]] PGconn* get() const noexcept { return connection_; }
  [[nodiscard]] bool is_sound() const noexcept { return PQstatus(connection_) == CONNECTION_OK; }
  [[nodiscard]] std::string problem() const { return without_line_end(PQerrorMessage(connection_)); }

  [[nodiscard]] core::Error failure(const PGresult* result) const {
    const char* state = result == nullptr ? nullptr : PQresultErrorField(result, PG_DIAG_SQLSTATE);
    const char* text = result == nullptr ? nullptr : PQresultErrorField(result, PG_DIAG_MESSAGE_PRIMARY);
    return {.code = is_sound() ? code_of(state == nullptr ? "" : state) : core::ErrorCode::Unreachable,
            .what = "PostgreSQL: " + (text == nullptr ? problem() : std::string(text)),
            .hint = {}};
  }

 private:
  PGconn* connection_;
};

Database::Database(DatabaseOptions options) : options_(std::move(options)) {}
Database::~Database() = default;

core::Status Database::connect() {
  if (connection_ && connection_->is_sound()) return {};
  // The rest of a transaction must not be executed by a new connection, one statement after the other.
  if (is_in_transaction_) return core::fail(core::ErrorCode::Unreachable, "PostgreSQL: the connection was lost");
  connection_.reset();
  const auto now = std::chrono::steady_clock::now();
  if (now < next_try_) return unreachable();
  next_try_ = now + kRetryPause;
  const std::string settings = "-c statement_timeout=" + std::to_string(options_.statement_timeout.count()) +
                               " -c lock_timeout=" + std::to_string(options_.statement_timeout.count()) +
                               " -c idle_in_transaction_session_timeout=60000 -c client_min_messages=warning -c timezone=UTC" +
                               " -c synchronous_commit=" + (options_.is_durable ? "on" : "off");
  // The user's text expands within "dbname", so that all else holds unless the user's text says otherwise.
  const std::array<const char*, 8> keys = {"connect_timeout",  "tcp_user_timeout", "keepalives_idle", "client_encoding",
                                           "application_name", "options",          "dbname",          nullptr};
  const std::array<const char*, 8> values = {
      "2", "5000", "10", "UTF8", options_.name.c_str(), settings.c_str(), options_.connection.c_str(), nullptr};
  auto opened = std::make_unique<Connection>(PQconnectdbParams(keys.data(), values.data(), 1));
  if (!opened->is_sound()) {
    last_problem_ = "PostgreSQL: " + opened->problem();
    return unreachable();
  }
  PQsetNoticeProcessor(
      opened->get(), [](void* /*unused*/, const char* /*text*/) {}, nullptr);
  connection_ = std::move(opened);
  ++connections_;
  if (!channel_.empty()) {
    may_have_missed_ = true;
    return run_script("LISTEN " + channel_);
  }
  return {};
}

core::Result<Rows> Database::run(const std::string& sql, std::initializer_list<Parameter> parameters) {
  DTS_TRY(connect());
  std::vector<const char*> values;
  std::vector<int> lengths;
  std::vector<int> formats;
  for (const Parameter& parameter : parameters) {
    values.push_back(parameter.bytes() ? parameter.bytes()->c_str() : nullptr);
    lengths.push_back(parameter.bytes() ? static_cast<int>(parameter.bytes()->size()) : 0);
    formats.push_back(parameter.is_binary() ? 1 : 0);
  }
  const ResultPointer result(PQexecParams(connection_->get(), sql.c_str(), static_cast<int>(values.size()), nullptr, values.data(),
                                          lengths.data(), formats.data(), 0));
  const ExecStatusType status = PQresultStatus(result.get());
  if (status != PGRES_TUPLES_OK && status != PGRES_COMMAND_OK) return failed(connection_->failure(result.get()));
  std::vector<std::vector<std::optional<std::string>>> cells(static_cast<std::size_t>(PQntuples(result.get())));
  for (std::size_t row = 0; row < cells.size(); ++row) {
    for (int column = 0; column < PQnfields(result.get()); ++column) {
      const int number = static_cast<int>(row);
      if (PQgetisnull(result.get(), number, column) != 0) {
        cells[row].emplace_back(std::nullopt);
      } else {
        cells[row].emplace_back(
            std::string(PQgetvalue(result.get(), number, column), static_cast<std::size_t>(PQgetlength(result.get(), number, column))));
      }
    }
  }
  std::uint64_t changed = 0;
  const std::string_view count = PQcmdTuples(result.get());
  std::from_chars(count.data(), count.data() + count.size(), changed);
  return Rows(std::move(cells), changed);
}

core::Status Database::run_script(const std::string& sql) {
  DTS_TRY(connect());
  const ResultPointer result(PQexec(connection_->get(), sql.c_str()));
  const ExecStatusType status = PQresultStatus(result.get());
  if (status != PGRES_TUPLES_OK && status != PGRES_COMMAND_OK) return failed(connection_->failure(result.get()));
  return {};
}

tl::unexpected<core::Error> Database::unreachable() const {
  return core::fail(core::ErrorCode::Unreachable, last_problem_, is_rejection(last_problem_) ? options_.rejection_hint : "");
}

tl::unexpected<core::Error> Database::failed(core::Error error) {
  if (error.code == core::ErrorCode::NotAllowed) error.hint = options_.rejection_hint;
  if (error.code == core::ErrorCode::Unreachable) {
    connection_.reset();
    last_problem_ = error.what;
  }
  return tl::make_unexpected(std::move(error));
}

core::Status Database::begin() {
  DTS_TRY(run_script("BEGIN"));
  is_in_transaction_ = true;
  return {};
}

core::Status Database::commit() {
  const auto ended = run("COMMIT");
  is_in_transaction_ = false;
  DTS_TRY(ended);
  return {};
}

void Database::roll_back() {
  static_cast<void>(run_script("ROLLBACK"));
  is_in_transaction_ = false;
}

void Database::listen(const std::string& channel) { channel_ = channel; }

core::Result<bool> Database::wait_notification(std::chrono::milliseconds timeout) {
  DTS_TRY(connect());
  if (std::exchange(may_have_missed_, false)) return true;
  pollfd item{.fd = PQsocket(connection_->get()), .events = POLLIN, .revents = 0};
  static_cast<void>(::poll(&item, 1, static_cast<int>(timeout.count())));
  if (PQconsumeInput(connection_->get()) == 0) return failed(connection_->failure(nullptr));
  bool has_some = false;
  while (PGnotify* notification = PQnotifies(connection_->get())) {
    PQfreemem(notification);
    has_some = true;
  }
  return has_some;
}

}  // namespace dts::fleet::database
