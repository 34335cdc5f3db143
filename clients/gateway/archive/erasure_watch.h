// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "gateway/bus/carried.h"

namespace dts::gateway {

/// Notices in the daemon's status that a subject was erased. Thread: one.
class ErasureWatch {
 public:
  /// Returns true if an erasure may have ended since the last status: the daemon counted one, or it was restarted. `status` may be nullptr.
  [[nodiscard]] bool has_erased(const CarriedPointer& status);

 private:
  CarriedPointer seen_;
  std::uint64_t instance_id_ = 0;
  std::uint64_t erasures_ = 0;
};

}  // namespace dts::gateway
