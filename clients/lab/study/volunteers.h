// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "core/reach.h"
#include "physics/body/person.h"

namespace dts::lab::study {

/// A volunteer of the thesis: printed body measures and camera measurements. Nothing else is known.
struct Volunteer {
  std::string_view name;
  physics::Person person;
  bool is_healthy = true;
  /// Mean trunk angle of reaches to 120 %, 150 % and the maximum, deg (Table 6.3).
  std::optional<std::array<double, 3>> measured_deg{};
  /// Mean trunk angle of reaches to the critical boundary, deg, and the condition that the thesis assigns to it (Table 6.4).
  std::optional<double> boundary_deg{};
  core::TrunkClass boundary_class = core::TrunkClass::None;
};

/// A, B and C (Table 5.1): the training data of the networks.
[[nodiscard]] std::span<const Volunteer> teachers() noexcept;
/// H1 to H10 (Tables 6.1 and 6.3).
[[nodiscard]] std::span<const Volunteer> healthy() noexcept;
/// S1 to S5 (Tables 6.1 and 6.4), after a stroke.
[[nodiscard]] std::span<const Volunteer> stroke() noexcept;

}  // namespace dts::lab::study
