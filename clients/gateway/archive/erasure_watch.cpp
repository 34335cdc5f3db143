// SPDX-License-Identifier: Apache-2.0
#include "gateway/archive/erasure_watch.h"

#include "dts/v1/control.pb.h"

namespace dts::gateway {

bool ErasureWatch::has_erased(const CarriedPointer& status) {
  if (status == nullptr || status == seen_) return false;
  seen_ = status;
  v1::StatusSnapshot snapshot;
  if (!snapshot.ParseFromString(status->bytes)) return false;
  const bool is_other = instance_id_ != 0 && (snapshot.instance_id() != instance_id_ || snapshot.erasures_total() != erasures_);
  instance_id_ = snapshot.instance_id();
  erasures_ = snapshot.erasures_total();
  return is_other;
}

}  // namespace dts::gateway
