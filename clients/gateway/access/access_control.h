// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "dts/error.h"
#include "gateway/access/identity.h"
#include "gateway/access/password.h"
#include "gateway/http/http_message.h"

namespace dts::gateway {

/// Time since the machine started, with the time it slept: who closes the lid for the night is logged out in the morning.
[[nodiscard]] std::chrono::steady_clock::time_point time_since_boot() noexcept;

/// A login, or a refused attempt, for the daemon's audit trail.
struct LoginNote {
  std::string user;     ///< Empty: a name that no user has.
  std::string address;  ///< As it is: limits count the /64 of an IPv6 address.
  bool is_refused = false;
  std::uint64_t more = 0;  ///< Of the same kind since the last note, which have none of their own.
};

struct AccessOptions {
  std::string users_file{};                    ///< Empty: nobody can log in.
  v1::Role local_role = v1::ROLE_UNSPECIFIED;  ///< Of whoever connects from this machine without a login; UNSPECIFIED: they log in too.
  std::chrono::seconds token_life{12 * 3600};  ///< Of a login that is used; a shift.
  std::chrono::seconds idle_life{2 * 3600};    ///< Of a login that is not; an open tab is a use.
  std::function<std::chrono::steady_clock::time_point()> now = time_since_boot;
  std::function<bool(const std::string& hash, const Secret& password)> is_password =
      gateway::is_password;                                                 ///< Called on the thread "password".
  std::function<void(const std::string&)> log = [](const std::string&) {};  ///< Takes a line; what a browser sent is not in it.
  std::function<void(const LoginNote&)> note = [](const LoginNote&) {};     ///< 20 of each kind at once and six a minute.
};

/// Tells who somebody is: by the token in the cookie "dts_token" (HttpOnly, SameSite=Strict, Secure over TLS), or as the local user.
///
/// Logins and refused attempts are lines of the log, with name and address, and notes for the audit trail: of each kind a few at once, then
/// a line a second, a note in ten seconds, with the number of the others (`report_rest`: also when no login follows). A name that no user
/// has is not told: it may be a password in the wrong field.
/// Passwords are hashed with libsodium (argon2id), on a thread of their own, one at a time; a wrong name costs as much time as a wrong
/// password. After five failures a name waits at the address they came from, after twenty the name or the address alone, longer each time.
/// Tokens are 256 random bits, kept as hashes, in memory only: a restart logs everybody out. Whose line in the users file is changed or
/// gone is logged out at once; while that file cannot be read, nobody is let in. Thread: io, but for the hashing.
class AccessControl {
 public:
  /// Reads the users. Fails with InvalidArgument, naming file and line, for a file that is not one, or that others may read.
  [[nodiscard]] static client::Result<std::unique_ptr<AccessControl>> open(boost::asio::io_context& io, const AccessOptions& options);
  virtual ~AccessControl() = default;
  AccessControl(const AccessControl&) = delete;
  AccessControl& operator=(const AccessControl&) = delete;

  [[nodiscard]] virtual std::optional<Identity> identify(const HttpRequest& request) = 0;
  /// POST /api/login {"user","password"}: 200 and the cookie, 401, or 429 with Retry-After. Only same-origin.
  virtual void log_in(HttpRequest request, Respond respond) = 0;
  /// POST /api/logout: forgets the token. Only same-origin.
  virtual void log_out(const HttpRequest& request, const Respond& respond) = 0;
  /// GET /api/me: {"user","role","can_log_in"}; role "none" when not logged in.
  virtual void tell_who(const HttpRequest& request, const Respond& respond) = 0;
  /// Logins that failed, or came too soon after those that did.
  [[nodiscard]] virtual std::uint64_t refused_logins_total() const noexcept = 0;
  /// Logs and notes the newest of the logins that were kept back, with the number of the others, as soon as the limits allow it; `is_end`:
  /// at once. Every login does the same. Call it about every second, and at the end.
  virtual void report_rest(bool is_end) = 0;

 protected:
  AccessControl() = default;
};

}  // namespace dts::gateway
