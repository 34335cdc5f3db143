// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "gateway/http/http_message.h"

namespace dts::gateway {

/// What the transport knows about an answer, in addition to the route's response.
struct AnswerFrame {
  std::string path{};  ///< The requested path.
  bool is_secure = false;
  bool keeps_alive = false;
  std::uint64_t body_bytes = 0;
};

/// Returns false for answers that never have a body (RFC 9110, 15.3.5 and 15.4.5).
[[nodiscard]] bool may_have_body(unsigned status) noexcept;

/// Returns status line, headers and empty line. Adds security headers that the route did not set. Omits headers that a route must not set:
/// names or values with a line break, lengths.
[[nodiscard]] std::string response_head(const HttpResponse& response, const AnswerFrame& frame);

}  // namespace dts::gateway
