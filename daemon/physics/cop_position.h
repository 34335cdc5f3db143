// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace dts::physics {

/// A centre of pressure as it is published: mm, ML positive to the subject's right, AP positive forward. Where the origin
/// lies (plate centre, mean stance) is said by whoever gives it.
struct CopPosition {
  double ml_mm = 0.0;
  double ap_mm = 0.0;

  friend bool operator==(const CopPosition&, const CopPosition&) = default;
};

}  // namespace dts::physics
