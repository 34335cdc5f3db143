// SPDX-License-Identifier: Apache-2.0
#include "gateway/access/access_control.h"

#include <sodium.h>

#include <algorithm>
#include <ctime>
#include <deque>
#include <string_view>
#include <utility>

#include "cli/try.h"
#include "core/token_bucket.h"
#include "gateway/access/back_off.h"
#include "gateway/access/login_request.h"
#include "gateway/access/password_thread.h"
#include "gateway/access/token_store.h"
#include "gateway/access/user_list.h"
#include "gateway/access/visitor.h"
#include "gateway/http/connection_limits.h"
#include "gateway/http/json_answer.h"

namespace dts::gateway {
namespace {

using std::chrono::seconds;

constexpr std::string_view kCookie = "dts_token";
constexpr std::size_t kMostWaiting = 16;
constexpr seconds kQueueIsShorterIn{2};
// For a name at one address the wait is long: it stops guesses, but neither colleagues behind the same router nor the user elsewhere.
constexpr seconds kLongestForBoth{900};
constexpr unsigned kFreeForBoth = 5;
// For an address or a name alone the wait is short, because it also locks out others while somebody guesses: half a minute still allows
// only few guesses (2880 a day).
constexpr seconds kLongestForOne{30};
constexpr unsigned kFreeForOne = 20;

constexpr double kLinesPerSecond = 1.0;
constexpr double kRejectedLinesAtOnce = 1.0;
constexpr double kLoginLinesAtOnce = 20.0;  // many users log in when a shift begins
// The audit trail cannot be erased, so its size must be limited: the same limits as for the daemon's entries about failed commands.
constexpr double kNotesPerSecond = 0.1;
constexpr double kNotesAtOnce = 20.0;

/// Lets some items pass and counts the others.
struct Thinned {
  core::TokenBucket bucket;
  std::uint64_t others = 0;

  /// Returns how many items were held back since the last one that passed; nothing if this item is held back too.
  [[nodiscard]] std::optional<std::uint64_t> pass(core::TokenBucket::Time now) noexcept {
    if (bucket.take(now)) return std::exchange(others, 0);
    ++others;
    return std::nullopt;
  }
  /// Returns true if the newest item held back may pass now; `others` then counts those before it.
  [[nodiscard]] bool follows(core::TokenBucket::Time now, bool is_end) noexcept {
    if (others == 0 || !(is_end || bucket.take(now))) return false;
    --others;
    return true;
  }
};

/// What is reported about logins of one kind.
struct LoginReports {
  Thinned lines;
  Thinned notes{.bucket = core::TokenBucket(kNotesPerSecond, kNotesAtOnce)};
  std::string newest_line{};
  LoginNote newest_note{};
};

/// Where an attempt came from.
struct Stranger {
  std::string address;     ///< For log and audit trail.
  std::string counted_as;  ///< For the limits: see `gateway::counted_as`.
};

Stranger stranger_of(const HttpRequest& request) {
  return {.address = request.remote_address, .counted_as = counted_as(request.remote_address)};
}

struct Attempt {
  LoginRequest login;
  Stranger stranger;
  bool is_secure = false;
  Respond respond;
};

std::string cookie_text(std::string_view value, seconds life, bool is_secure) {
  return std::string(kCookie) + "=" + std::string(value) + "; Path=/; Max-Age=" + std::to_string(life.count()) +
         "; HttpOnly; SameSite=Strict" + (is_secure ? "; Secure" : "");
}

std::string pair_of(const std::string& name, const Stranger& stranger) { return name + " " + stranger.counted_as; }

HttpResponse come_later(seconds wait) {
  HttpResponse answer = error_answer(429, "too many failed or waiting logins", "try again in " + std::to_string(wait.count()) + " s");
  answer.headers.emplace_back("Retry-After", std::to_string(wait.count()));
  return answer;
}

/// Returns nothing if the request is acceptable. Another page in the same browser cannot send our Origin, nor this content type without a
/// CORS permission.
std::optional<HttpResponse> refuse_foreign(const HttpRequest& request) {
  if (!request.is_same_origin)
    return error_answer(403, "rejected: the request comes from a page of another site", "log in on the dashboard's own page");
  const std::string type = request.header("content-type");
  if (type.substr(0, type.find(';')) != "application/json") return error_answer(415, "the Content-Type must be application/json");
  return std::nullopt;
}

class AccessControlImpl final : public AccessControl {
 public:
  AccessControlImpl(boost::asio::io_context& io, const AccessOptions& options)
      : options_(options),
        users_(options.users_file, [this](const std::string& user) { tokens_.revoke_all_of(user); }),
        tokens_(options.token_life, options.idle_life),
        passwords_(io, options_.is_password) {}

  [[nodiscard]] client::Result<void> refresh() { return options_.users_file.empty() ? client::Result<void>() : users_.refresh(); }

  std::optional<Identity> identify(const HttpRequest& request) override {
    const std::string token = request.cookie(std::string(kCookie));
    if (!token.empty() && refresh()) {
      if (auto known = tokens_.use(token, options_.now())) return known;
    }
    if (options_.local_role == v1::ROLE_UNSPECIFIED || !is_local(request)) return std::nullopt;
    return Identity{.user = std::string(kLocalUser), .role = options_.local_role};
  }

  void log_in(HttpRequest request, Respond respond) override {
    if (auto refused = refuse_foreign(request)) return respond(std::move(*refused));
    auto login = read_login(request.body);
    if (!login) return respond(error_answer(login.error()));
    if (options_.users_file.empty())
      return respond(error_answer(403, "no login is set up on this gateway", "start the gateway with --users FILE"));
    if (waiting_.size() == kMostWaiting) {
      note_rejection(login->user, stranger_of(request));
      return respond(come_later(kQueueIsShorterIn));
    }
    waiting_.push_back(
        {.login = std::move(*login), .stranger = stranger_of(request), .is_secure = request.is_secure, .respond = std::move(respond)});
    compare_next();
  }

  void log_out(const HttpRequest& request, const Respond& respond) override {
    if (auto refused = refuse_foreign(request)) return respond(std::move(*refused));
    tokens_.revoke(request.cookie(std::string(kCookie)));
    HttpRequest without = request;
    without.headers.erase("cookie");
    HttpResponse answer = describe(identify(without));
    answer.headers.emplace_back("Set-Cookie", cookie_text("", seconds{0}, request.is_secure));
    respond(std::move(answer));
  }

  void describe_user(const HttpRequest& request, const Respond& respond) override { respond(describe(identify(request))); }
  [[nodiscard]] std::uint64_t refused_logins_total() const noexcept override { return refused_logins_total_; }

  void report_rest(bool is_end) override {
    const auto now = options_.now();
    for (LoginReports* kind : {&logins_, &rejections_}) {
      if (kind->lines.follows(now, is_end)) write_line(*kind, std::exchange(kind->lines.others, 0));
      if (kind->notes.follows(now, is_end)) write_note(*kind, std::exchange(kind->notes.others, 0));
    }
  }

 private:
  [[nodiscard]] HttpResponse describe(const std::optional<Identity>& identity) const {
    return json_answer(200, {{"user", identity ? identity->user : ""},
                             {"role", role_name(identity ? identity->role : v1::ROLE_UNSPECIFIED)},
                             {"can_log_in", !options_.users_file.empty()},
                             {"fleet", options_.is_fleet}});
  }

  [[nodiscard]] seconds wait_of(const Attempt& attempt) const {
    const auto now = options_.now();
    return std::max({pairs_.wait(pair_of(attempt.login.user, attempt.stranger), now), addresses_.wait(attempt.stranger.counted_as, now),
                     names_.wait(attempt.login.user, now)});
  }

  /// Checks the waiting time only when an attempt is next in the queue: otherwise many attempts at once would all pass as the first.
  void compare_next() {
    while (!is_comparing_ && !waiting_.empty()) {
      Attempt attempt = std::move(waiting_.front());
      waiting_.pop_front();
      if (const seconds wait = wait_of(attempt); wait > seconds{0}) {
        note_rejection(attempt.login.user, attempt.stranger);
        attempt.respond(come_later(wait));
      } else if (!refresh()) {
        attempt.respond(error_answer(503, "cannot read the list of users", "see the reason: dts-gateway user list"));
      } else {
        compare(std::move(attempt));
      }
    }
  }

  void compare(Attempt attempt) {
    is_comparing_ = true;
    const User* user = users_.find(attempt.login.user);
    const User asked{.name = attempt.login.user,
                     .role = user == nullptr ? v1::ROLE_UNSPECIFIED : user->role,
                     .password_hash = user == nullptr ? "" : user->password_hash};
    passwords_.compare(asked.password_hash, std::move(attempt.login.password),
                       [this, asked, stranger = std::move(attempt.stranger), is_secure = attempt.is_secure,
                        respond = std::move(attempt.respond)](bool is_right) {
                         is_comparing_ = false;
                         const User* still = refresh() ? users_.find(asked.name) : nullptr;
                         const bool is_in = is_right && still != nullptr && *still == asked;
                         respond(is_in ? welcome(asked, stranger, is_secure) : turn_away(asked.name, stranger));
                         compare_next();
                       });
  }

  [[nodiscard]] HttpResponse welcome(const User& user, const Stranger& stranger, bool is_secure) {
    // Failures of the address are kept: otherwise an attacker with a login could reset them and guess other users' passwords without limit.
    names_.forgive(user.name);
    pairs_.forgive(pair_of(user.name, stranger));
    const Identity identity{.user = user.name, .role = user.role};
    report(logins_, "login: " + user.name + " (" + std::string(role_name(user.role)) + ") from " + stranger.address,
           {.user = user.name, .address = stranger.address});
    HttpResponse answer = describe(identity);
    const std::string token = tokens_.issue(identity, options_.now());
    answer.headers.emplace_back("Set-Cookie", cookie_text(token, options_.token_life, is_secure));
    return answer;
  }

  [[nodiscard]] HttpResponse turn_away(const std::string& name, const Stranger& stranger) {
    note_rejection(name, stranger);
    addresses_.add_failure(stranger.counted_as, options_.now());
    if (is_user_name(name)) {
      names_.add_failure(name, options_.now());
      pairs_.add_failure(pair_of(name, stranger), options_.now());
    }
    return error_answer(401, "name or password is wrong");
  }

  void note_rejection(const std::string& name, const Stranger& stranger) {
    ++refused_logins_total_;
    const bool is_known = users_.find(name) != nullptr;
    report(rejections_, "login rejected: " + (is_known ? name : "a name that no user has") + " from " + stranger.address,
           {.user = is_known ? name : "", .address = stranger.address, .is_refused = true});
  }

  void report(LoginReports& kind, const std::string& line, const LoginNote& note) {
    const auto now = options_.now();
    kind.newest_line = line;
    kind.newest_note = note;
    if (const auto others = kind.lines.pass(now)) write_line(kind, *others);
    if (const auto others = kind.notes.pass(now)) write_note(kind, *others);
    report_rest(false);
  }

  void write_line(const LoginReports& kind, std::uint64_t others) const {
    options_.log(kind.newest_line + (others == 0 ? "" : ", and " + std::to_string(others) + " more since the line before"));
  }
  void write_note(LoginReports& kind, std::uint64_t others) const {
    kind.newest_note.more = others;
    options_.note(kind.newest_note);
  }

  AccessOptions options_;
  UserList users_;
  TokenStore tokens_;
  BackOff pairs_{kLongestForBoth, kFreeForBoth};
  BackOff addresses_{kLongestForOne, kFreeForOne};
  BackOff names_{kLongestForOne, kFreeForOne};
  std::deque<Attempt> waiting_;
  bool is_comparing_ = false;
  std::uint64_t refused_logins_total_ = 0;
  LoginReports logins_{.lines = {.bucket = core::TokenBucket(kLinesPerSecond, kLoginLinesAtOnce)}};
  LoginReports rejections_{.lines = {.bucket = core::TokenBucket(kLinesPerSecond, kRejectedLinesAtOnce)}};
  PasswordThread passwords_;  // last: its thread ends before the other members are destroyed
};

}  // namespace

std::chrono::steady_clock::time_point time_since_boot() noexcept {
  timespec now{};
  ::clock_gettime(CLOCK_BOOTTIME, &now);
  return std::chrono::steady_clock::time_point(std::chrono::seconds(now.tv_sec) + std::chrono::nanoseconds(now.tv_nsec));
}

client::Result<std::unique_ptr<AccessControl>> AccessControl::open(boost::asio::io_context& io, const AccessOptions& options) {
  if (sodium_init() < 0) return client::fail(client::ErrorCode::Failed, "libsodium cannot be used: no random numbers");
  auto access = std::make_unique<AccessControlImpl>(io, options);
  DTS_TRY(access->refresh());
  return access;
}

}  // namespace dts::gateway
