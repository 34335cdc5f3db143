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

/// Returns the time since the machine started, including suspend: a login ends overnight even if the lid was closed.
[[nodiscard]] std::chrono::steady_clock::time_point time_since_boot() noexcept;

/// A login, or a rejected attempt, for the daemon's audit trail.
struct LoginNote {
  std::string user;     ///< Empty: the name belongs to no user.
  std::string address;  ///< The full address; limits count the /64 of an IPv6 address.
  bool is_refused = false;
  std::uint64_t more = 0;  ///< Number of logins or attempts of the same kind since the last note that got no note of their own.
};

struct AccessOptions {
  std::string users_file{};                    ///< Empty: nobody can log in.
  v1::Role local_role = v1::ROLE_UNSPECIFIED;  ///< For connections from this machine without a login; UNSPECIFIED: they must log in too.
  bool is_fleet = false;                       ///< Reported by /api/me: the dashboard shows the clinics of a fleet instead of a daemon.
  std::chrono::seconds token_life{12 * 3600};  ///< Longest life of a login; one shift.
  std::chrono::seconds idle_life{2 * 3600};    ///< A login ends after this time without use; an open tab counts as use.
  std::function<std::chrono::steady_clock::time_point()> now = time_since_boot;
  std::function<bool(const std::string& hash, const Secret& password)> is_password =
      gateway::is_password;                                                 ///< Called on the thread "password".
  std::function<void(const std::string&)> log = [](const std::string&) {};  ///< Writes a line; the line never has text that a browser sent.
  std::function<void(const LoginNote&)> note = [](const LoginNote&) {};     ///< At most 20 of each kind at once, then six a minute.
};

/// Identifies who sent a request: by the token in the cookie "dts_token" (HttpOnly, SameSite=Strict, Secure over TLS), or as the local
/// user.
///
/// Logins and rejected attempts are written to the log, with name and address, and to the audit trail as notes. Of each kind a few are
/// written at once, then one line a second and one note in ten seconds, with the number of the others (`report_rest`: also if no login
/// follows). A name that no user has is not written: it may be a password in the wrong field.
/// Passwords are hashed with libsodium (argon2id), on a separate thread, one at a time; a wrong name needs as much time as a wrong
/// password. After five failures from one address, a name must wait at that address; after twenty failures, the name or the address alone
/// must wait. The wait grows with each failure. Tokens are 256 random bits, kept only as hashes and only in memory: a restart logs out all
/// users. A user whose line in the users file changes or disappears is logged out at once; while that file cannot be read, no login
/// is valid. Thread: io, but for the hashing.
class AccessControl {
 public:
  /// Reads the users. Fails with InvalidArgument, naming file and line, if the file is malformed or other users may read it.
  [[nodiscard]] static client::Result<std::unique_ptr<AccessControl>> open(boost::asio::io_context& io, const AccessOptions& options);
  virtual ~AccessControl() = default;
  AccessControl(const AccessControl&) = delete;
  AccessControl& operator=(const AccessControl&) = delete;

  [[nodiscard]] virtual std::optional<Identity> identify(const HttpRequest& request) = 0;
  /// Handles POST /api/login {"user","password"}: 200 and the cookie, 401, or 429 with Retry-After. Same-origin only.
  virtual void log_in(HttpRequest request, Respond respond) = 0;
  /// Handles POST /api/logout: deletes the token. Same-origin only.
  virtual void log_out(const HttpRequest& request, const Respond& respond) = 0;
  /// Handles GET /api/me: {"user","role","can_log_in","fleet"}; role "none" if not logged in.
  virtual void describe_user(const HttpRequest& request, const Respond& respond) = 0;
  /// Returns the number of logins that failed, or were rejected because too many failed or wait.
  [[nodiscard]] virtual std::uint64_t refused_logins_total() const noexcept = 0;
  /// Writes the newest of the delayed logins to log and audit trail, with the number of the others, as soon as the limits allow; with
  /// `is_end` at once. Every login also does this. Call it about every second, and at the end.
  virtual void report_rest(bool is_end) = 0;

 protected:
  AccessControl() = default;
};

}  // namespace dts::gateway
