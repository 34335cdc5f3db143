// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "cli/json.h"
#include "gateway/http/http_message.h"

namespace dts::gateway {

/// Returns an answer with a JSON document that no cache may store.
[[nodiscard]] HttpResponse json_answer(unsigned status, const cli::Json& document);
/// Returns an answer with {"what","hint"}.
[[nodiscard]] HttpResponse error_answer(unsigned status, std::string_view what, std::string_view hint = {});

/// Returns the HTTP status for an error code, a number of `dts.v1.ErrorCode`.
[[nodiscard]] unsigned http_status(int code) noexcept;
/// Error is dts::client::Error or dts::core::Error: both have `code`, `what` and `hint`, and the same numbers for codes.
template <class Error>
[[nodiscard]] HttpResponse error_answer(const Error& error) {
  return error_answer(http_status(static_cast<int>(error.code)), error.what, error.hint);
}

}  // namespace dts::gateway
