// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "cli/json.h"
#include "gateway/http/http_message.h"

namespace dts::gateway {

/// A JSON document that nobody on the way may keep.
[[nodiscard]] HttpResponse json_answer(unsigned status, const cli::Json& document);
/// {"what","hint"}
[[nodiscard]] HttpResponse error_answer(unsigned status, std::string_view what, std::string_view hint = {});

/// The HTTP status that tells of an error, given by its number in `dts.v1.ErrorCode`.
[[nodiscard]] unsigned http_status(int code) noexcept;
/// dts::client and dts::core each have an Error of `code`, `what` and `hint`, with the same numbers for codes.
template <class Error>
[[nodiscard]] HttpResponse error_answer(const Error& error) {
  return error_answer(http_status(static_cast<int>(error.code)), error.what, error.hint);
}

}  // namespace dts::gateway
