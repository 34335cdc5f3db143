// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

namespace dts::posturography {

/// Sample covariance (1/(N-1)) of a planar series.
struct Covariance {
  double ml_ml = 0.0;
  double ml_ap = 0.0;
  double ap_ap = 0.0;
};

/// 95 % prediction ellipse by the F distribution (Schubert & Kirchner 2014, Duarte 2015; posturography sheet 3.1).
struct PredictionEllipse {
  double sd1_mm = 0.0;  ///< Square roots of the eigenvalues of the covariance; `sd1_mm` is the larger.
  double sd2_mm = 0.0;
  double angle_deg = 0.0;  ///< Of the major axis from +ML: 0.5 atan2(2 s_xy, s_xx - s_yy).
  double factor = 0.0;     ///< Semi-axes are sqrt(factor) times the sds; 2 (N-1)(N+1) / (N (N-2)) F_0.95(2, N-2).
  double area_mm2 = 0.0;
};

/// Returns nothing for fewer than three samples or an invalid covariance (negative, not finite). Thread: any. Realtime-safe: yes.
[[nodiscard]] std::optional<PredictionEllipse> prediction_ellipse(const Covariance& covariance, std::size_t samples) noexcept;

}  // namespace dts::posturography
