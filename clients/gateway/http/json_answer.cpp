// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/json_answer.h"

#include "dts/error.h"

namespace dts::gateway {

HttpResponse json_answer(unsigned status, const cli::Json& document) {
  return {.status = status,
          .content_type = "application/json",
          .body = cli::one_line(document) + "\n",
          .headers = {{"Cache-Control", "no-store"}}};
}

HttpResponse error_answer(unsigned status, std::string_view what, std::string_view hint) {
  return json_answer(status, {{"what", what}, {"hint", hint}});
}

unsigned http_status(int code) noexcept {
  switch (static_cast<client::ErrorCode>(code)) {
    case client::ErrorCode::InvalidArgument: return 400;
    case client::ErrorCode::NotAllowed: return 403;
    case client::ErrorCode::NotFound: return 404;
    case client::ErrorCode::WrongState: return 409;
    case client::ErrorCode::DataDamaged: return 422;
    case client::ErrorCode::LimitExceeded: return 429;
    case client::ErrorCode::Unsupported: return 501;
    case client::ErrorCode::Unreachable:
    case client::ErrorCode::DeviceGone: return 503;
    case client::ErrorCode::Timeout: return 504;
    case client::ErrorCode::Failed:
    case client::ErrorCode::Internal: break;
  }
  return 500;
}

}  // namespace dts::gateway
