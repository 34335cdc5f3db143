// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace dts::sim {

/// A published centre of pressure: mm, ML positive to the subject's right, AP positive forward. The source of the position defines the
/// origin (plate centre or mean stance).
struct CopPosition {
  double ml_mm = 0.0;
  double ap_mm = 0.0;

  friend bool operator==(const CopPosition&, const CopPosition&) = default;
};

}  // namespace dts::sim
