// SPDX-License-Identifier: Apache-2.0
#include "dts/error.h"

#include "dts/v1/control.pb.h"

namespace dts::client {

static_assert(static_cast<int>(ErrorCode::Failed) == v1::ERROR_CODE_FAILED);
static_assert(static_cast<int>(ErrorCode::DataDamaged) == v1::ERROR_CODE_DATA_DAMAGED);
static_assert(static_cast<int>(ErrorCode::Internal) == v1::ERROR_CODE_INTERNAL);

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
  return "failed";
}

std::string_view version() noexcept { return DTS_VERSION; }

}  // namespace dts::client
