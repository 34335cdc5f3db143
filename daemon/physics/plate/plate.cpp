// SPDX-License-Identifier: Apache-2.0
#include "physics/plate/plate.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "physics/conversions.h"

namespace dts::physics {
namespace {

// Far wider than any rig: the limits reject typing errors (metres for millimetres, GPa for Pa) and meaningless plates.
constexpr double kMinSideMm = 10.0;
constexpr double kMaxSideMm = 10'000.0;
constexpr double kMaxSideRatio = 20.0;
constexpr double kMinThicknessMm = 0.01;
constexpr double kMaxThicknessPerSide = 0.2;  ///< Above this, thin-plate theory is not valid.
constexpr double kMinModulusPa = 1e5;
constexpr double kMaxModulusPa = 1e13;

core::Status out_of_range(const std::string& what, double value, const std::string& range) {
  std::ostringstream message;
  message << what << " is " << value << ", outside " << range;
  return core::fail(core::ErrorCode::InvalidArgument, message.str());
}

/// Returns true for NaN too.
bool is_outside(double value, double lowest, double highest) { return !(value >= lowest && value <= highest); }

std::string text(double value) {
  std::ostringstream stream;
  stream << value;
  return stream.str();
}

}  // namespace

double Plate::rigidity_nm() const noexcept {
  // Thesis eq. 3.2 prints 1 - nu; plate theory and the thesis's own FEM columns have 1 - nu^2.
  const double h_m = h.value / kMillimetresPerMetre;
  return e_pa * h_m * h_m * h_m / (12.0 * (1.0 - nu * nu));
}

core::Status check_plate(const Plate& plate) {
  const auto sides = text(kMinSideMm) + ".." + text(kMaxSideMm) + " mm";
  if (is_outside(plate.a.value, kMinSideMm, kMaxSideMm)) return out_of_range("plate length a", plate.a.value, sides);
  if (is_outside(plate.b.value, kMinSideMm, kMaxSideMm)) return out_of_range("plate length b", plate.b.value, sides);
  const double shorter = std::min(plate.a.value, plate.b.value);
  const double ratio = std::max(plate.a.value, plate.b.value) / shorter;
  if (ratio > kMaxSideRatio) return out_of_range("ratio of the plate's sides", ratio, "1.." + text(kMaxSideRatio));
  if (is_outside(plate.h.value, kMinThicknessMm, kMaxThicknessPerSide * shorter)) {
    const auto range = text(kMinThicknessMm) + ".." + text(kMaxThicknessPerSide * shorter) + " mm (a fifth of the shorter side)";
    return out_of_range("plate thickness h", plate.h.value, range);
  }
  if (is_outside(plate.e_pa, kMinModulusPa, kMaxModulusPa)) {
    return out_of_range("Young's modulus", plate.e_pa, text(kMinModulusPa) + ".." + text(kMaxModulusPa) + " Pa");
  }
  if (!(plate.nu > -1.0 && plate.nu < 0.5)) return out_of_range("Poisson's ratio", plate.nu, "-1..0.5 (ends excluded)");
  return {};
}

core::Status check_support(const Plate& plate, const Support& support) {
  if (static_cast<int>(support.kind) > static_cast<int>(SupportKind::Clamped)) {
    return out_of_range("support kind", static_cast<double>(support.kind), "0 (corner) to 3 (clamped)");
  }
  if (support.kind != SupportKind::Corner) return {};
  const double limit = 0.5 * std::min(plate.a.value, plate.b.value);
  if (support.inset.value >= 0.0 && support.inset.value < limit) return {};
  return out_of_range("support inset", support.inset.value, "0.." + text(limit) + " mm (end excluded)");
}

core::Status check_on_plate(const Plate& plate, Point point, const std::string& name) {
  if (is_outside(point.x.value, 0.0, plate.a.value)) {
    return out_of_range(name + ": x", point.x.value, "the plate, 0.." + text(plate.a.value) + " mm");
  }
  if (is_outside(point.y.value, 0.0, plate.b.value)) {
    return out_of_range(name + ": y", point.y.value, "the plate, 0.." + text(plate.b.value) + " mm");
  }
  return {};
}

core::Status check_divisions(int divisions, int lowest, int highest) {
  if (divisions >= lowest && divisions <= highest) return {};
  return out_of_range("number of divisions", divisions, std::to_string(lowest) + ".." + std::to_string(highest));
}

}  // namespace dts::physics
