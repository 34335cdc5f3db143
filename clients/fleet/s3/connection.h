// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "core/result.h"
#include "fleet/s3/settings.h"

namespace dts::fleet::s3 {

/// The body of a request: a part of a file, or a text.
class Body {
 public:
  virtual ~Body() = default;
  [[nodiscard]] virtual std::uint64_t size() const = 0;
  /// Returns how many bytes it has written to `to`; negative: it failed.
  [[nodiscard]] virtual std::int64_t read(char* to, std::size_t most) = 0;
  /// Starts again from the first byte: a connection that was kept open has ended.
  virtual void rewind() = 0;
};

struct Request {
  std::string method;                        ///< GET, HEAD, PUT, POST or DELETE.
  std::string path;                          ///< "/BUCKET/KEY", of characters that need no encoding.
  std::string query{};                       ///< "partNumber=1&uploadId=x": sorted, encoded, each name with "=".
  std::string payload_sha256;                ///< Of the body, hexadecimal.
  Body* body = nullptr;                      ///< nullptr: none.
  std::chrono::seconds longest_silence{30};  ///< After so long with less than 1 kB/s, the request ends.
  /// Receives the body of an answer 200, piece by piece; false: it cannot. Absent: it is in `Answer::body`.
  std::function<bool(std::string_view)> receive{};
};

struct Answer {
  long status = 0;
  std::string body{};       ///< At most `kMostAnswerBytes`.
  std::string etag{};       ///< With its quotation marks; empty: none.
  std::int64_t bytes = -1;  ///< Header Content-Length; -1: unknown.
};

inline constexpr std::size_t kMostAnswerBytes = 2 * 1024 * 1024;  ///< A page of 1000 names has less than 1 MB.

/// Signed requests to one server, through libcurl: signature version 4, TLS verified, no redirect followed. Keeps one connection open.
/// Thread: one at a time.
class Connection {
 public:
  /// `settings` and `credentials` must outlive this object.
  Connection(const Settings& settings, const Credentials& credentials);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  Connection(Connection&&) = delete;
  Connection& operator=(Connection&&) = delete;

  /// Returns the answer, whatever its status. Fails with Unreachable if there is none, or no whole one; see
  /// `Request::longest_silence`.
  [[nodiscard]] core::Result<Answer> perform(const Request& request);

 private:
  struct State;
  const Settings& settings_;
  std::unique_ptr<State> state_;
};

/// Returns a text for the query of an address: all but letters, digits and "-._~" as %XX.
[[nodiscard]] std::string encoded(std::string_view text);

}  // namespace dts::fleet::s3
