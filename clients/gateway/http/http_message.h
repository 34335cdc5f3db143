// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace dts::gateway {

/// A request as the routes see it: complete, within all limits, from a host name that is ours.
struct HttpRequest {
  std::string method;  ///< "GET", "HEAD", "POST"
  std::string path;    ///< Percent-decoded, UTF-8, begins with '/', no ".." segment, no NUL.
  std::map<std::string, std::string> query{};
  std::map<std::string, std::string> headers{};  ///< Names in lower case.
  std::string body{};
  std::string remote_address{};  ///< Without port.
  std::string local_address{};   ///< Of this machine, the one that was connected to; without port.
  bool is_secure = false;        ///< Came over TLS.
  bool is_same_origin = false;   ///< Its Origin header is there and ours.

  /// A header or cookie, or "".
  [[nodiscard]] std::string header(const std::string& lower_case_name) const;
  [[nodiscard]] std::string cookie(const std::string& name) const;
};

/// A file on the disk as the body of an answer; read as it is sent, never as a whole.
struct FileBody {
  std::filesystem::path path;
  std::function<void()> when_done = [] {};  ///< Sent, or given up.
};

struct HttpResponse {
  unsigned status = 200;
  std::string content_type = "text/plain; charset=utf-8";
  std::variant<std::string, FileBody> body{};
  std::vector<std::pair<std::string, std::string>>
      headers{};  ///< Further ones. Security headers are added by the transport, unless set here.
};

/// Answers a request, now or later, on the io thread; once.
using Respond = std::function<void(HttpResponse)>;

}  // namespace dts::gateway
