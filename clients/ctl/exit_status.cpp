// SPDX-License-Identifier: Apache-2.0
#include "ctl/exit_status.h"

namespace dts::ctl {

int exit_status(client::ErrorCode code) noexcept {
  using client::ErrorCode;
  switch (code) {
    case ErrorCode::InvalidArgument: return kUsage;
    case ErrorCode::Unreachable: return 3;
    case ErrorCode::NotAllowed: return 4;
    case ErrorCode::NotFound: return 5;
    case ErrorCode::WrongState: return 6;
    case ErrorCode::DataDamaged: return 7;
    case ErrorCode::Failed:
    case ErrorCode::Timeout:
    case ErrorCode::DeviceGone:
    case ErrorCode::Unsupported:
    case ErrorCode::LimitExceeded:
    case ErrorCode::Internal: return kFailed;
  }
  return kFailed;
}

}  // namespace dts::ctl
