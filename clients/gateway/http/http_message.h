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

using Query = std::map<std::string, std::string>;  ///< "?clinic=kent" is {clinic: kent}.

/// A request as the routes receive it: complete, within all limits, with an accepted host name.
struct HttpRequest {
  std::string method;  ///< "GET", "HEAD", "POST"
  std::string path;    ///< Percent-decoded, UTF-8, begins with '/', no ".." segment, no NUL.
  Query query{};
  std::map<std::string, std::string> headers{};  ///< Names in lower case.
  std::string body{};
  std::string remote_address{};  ///< Without port.
  std::string local_address{};   ///< The address of this machine that the client connected to; without port.
  bool is_secure = false;        ///< Received over TLS.
  bool is_same_origin = false;   ///< It has an Origin header, and that header names this gateway.

  /// Returns a header or cookie; "" if it is absent.
  [[nodiscard]] std::string header(const std::string& lower_case_name) const;
  [[nodiscard]] std::string cookie(const std::string& name) const;
};

/// A file on the disk as the body of an answer; read in pieces while it is sent.
struct FileBody {
  std::filesystem::path path;
  std::function<void()> when_done = [] {};  ///< Called when the file was sent or sending was aborted.
};

struct HttpResponse {
  unsigned status = 200;
  std::string content_type = "text/plain; charset=utf-8";
  std::variant<std::string, FileBody> body{};
  std::vector<std::pair<std::string, std::string>>
      headers{};  ///< Additional headers. The transport adds security headers that are not set here.
};

/// Answers a request on the io thread, now or later; call it once.
using Respond = std::function<void(HttpResponse)>;

}  // namespace dts::gateway
