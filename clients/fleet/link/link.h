// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/log.h"
#include "core/result.h"

namespace dts::fleet::link {

struct LinkOptions {
  std::vector<std::string>
      servers;                 ///< "tls://centre.example.org:4222", tried in turn. "nats://" (without TLS) only to a loopback address.
  std::string ca_pem{};        ///< Certificates of the authority that signed the server's; required for "tls://".
  std::string name;            ///< Shown in the server's list of connections: "kent bulk".
  std::string seed{};          ///< Of the nkey, see wire/nkey.h.
  std::string inbox_prefix{};  ///< Of replies, see wire/subjects.h.
  std::string rejection{};     ///< Follows "the server rejects the key (REASON): ": what that means and what to do. May be empty.
};

struct Letter {
  std::string subject;
  std::string reply{};  ///< Empty: no answer is expected.
  std::string data{};
  bool has_no_listener = false;  ///< Comes instead of an answer: nobody listens to the subject of the request.
};

/// Letters of a subject, which may have wildcards. They wait here until they are read: at most 4096 or 16 MiB, then the newest are dropped
/// and counted. Thread: one at a time.
class Subscription {
 public:
  ~Subscription();
  Subscription(const Subscription&) = delete;
  Subscription& operator=(const Subscription&) = delete;
  Subscription(Subscription&&) = delete;
  Subscription& operator=(Subscription&&) = delete;

  /// Returns nothing if no letter came within `timeout`.
  [[nodiscard]] std::optional<Letter> next(std::chrono::milliseconds timeout);
  [[nodiscard]] std::uint64_t dropped() const;

 private:
  friend class Link;
  class Implementation;
  explicit Subscription(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

/// A connection to nats-server, with a thread of its own. It connects in the background, and connects again for ever after a failure: after
/// 0.25 s to 4 s, after a rejected key after 1 s to 2 min. A server that is silent for 10 s is a failure, too. What is sent while there is
/// no connection may be lost: every sender repeats until it has an answer. All functions: any thread; none waits for the line, except
/// `request` for its answer.
class Link {
 public:
  /// Fails with InvalidArgument for wrong options; does not wait for the server.
  [[nodiscard]] static core::Result<std::unique_ptr<Link>> open(const LinkOptions& options, const core::Log& log);
  /// Writes what waits, for at most 0.5 s, and ends within 1 s.
  ~Link();
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;
  Link(Link&&) = delete;
  Link& operator=(Link&&) = delete;

  /// Fails with Unreachable while there is no connection, with LimitExceeded for more than the server's limit of a message, and with
  /// Timeout if more than 8 MiB wait already, because the line is slow.
  [[nodiscard]] core::Status publish(const Letter& letter);
  /// Sends and waits for one answer. Fails like `publish`, with Unreachable if nobody listens, and with Timeout.
  [[nodiscard]] core::Result<std::string> request(const std::string& subject, std::string_view data, std::chrono::milliseconds timeout);

  /// With `queue`, each letter goes to one member of the group of that name.
  [[nodiscard]] core::Result<std::unique_ptr<Subscription>> subscribe(const std::string& subject, const std::string& queue = {});
  /// Returns a new subject below the inbox prefix, for replies.
  [[nodiscard]] std::string new_inbox() const;

  [[nodiscard]] bool is_connected() const;
  /// Less than 256 KiB wait to be written: for those who can send later or not at all.
  [[nodiscard]] bool has_room() const;
  /// The server rejected the key twice, and has not accepted it since.
  [[nodiscard]] bool is_rejected() const;
  /// Number of connections so far. It rises with every new one.
  [[nodiscard]] std::uint64_t connections() const;
  /// Why there is no connection; empty: there is one.
  [[nodiscard]] std::string problem() const;

 private:
  class Implementation;
  explicit Link(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace dts::fleet::link
