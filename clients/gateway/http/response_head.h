// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "gateway/http/http_message.h"

namespace dts::gateway {

/// What the transport knows of an answer besides what the route said.
struct AnswerFrame {
  std::string path{};  ///< Asked for.
  bool is_secure = false;
  bool keeps_alive = false;
  std::uint64_t body_bytes = 0;
};

/// False for answers that never have a body (RFC 9110, 15.3.5 and 15.4.5).
[[nodiscard]] bool may_have_body(unsigned status) noexcept;

/// Status line, headers and empty line. Security headers are added unless the route set them; what a route may not say (a name or value
/// with a line break, a length) is left out.
[[nodiscard]] std::string response_head(const HttpResponse& response, const AnswerFrame& frame);

}  // namespace dts::gateway
