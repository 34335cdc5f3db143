// SPDX-License-Identifier: Apache-2.0
#include "core/result.h"

#include <cerrno>
#include <system_error>

namespace dts::core {

std::string_view name(ErrorCode code) noexcept {
  switch (code) {
    case ErrorCode::Failed: return "failed";
    case ErrorCode::InvalidArgument: return "invalid_argument";
    case ErrorCode::Unreachable: return "unreachable";
    case ErrorCode::NotAllowed: return "not_allowed";
    case ErrorCode::NotFound: return "not_found";
    case ErrorCode::WrongState: return "wrong_state";
    case ErrorCode::DataDamaged: return "data_damaged";
    case ErrorCode::Timeout: return "timeout";
    case ErrorCode::DeviceGone: return "device_gone";
    case ErrorCode::Unsupported: return "unsupported";
    case ErrorCode::LimitExceeded: return "limit_exceeded";
    case ErrorCode::Internal: return "internal";
  }
  return "unknown";
}

std::string to_string(const Error& error) { return error.hint.empty() ? error.what : error.what + " (" + error.hint + ")"; }

tl::unexpected<Error> fail_errno(int system_errno, std::string what, std::string hint) {
  const auto code = system_errno == EACCES || system_errno == EPERM ? ErrorCode::NotAllowed
                    : system_errno == ENOENT                        ? ErrorCode::NotFound
                                                                    : ErrorCode::Failed;
  return fail(code, std::move(what) + ": " + std::system_category().message(system_errno), std::move(hint));
}

}  // namespace dts::core
