// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "core/reach.h"

namespace dts::lab::study {

/// Returns the class of a reach with this trunk flexion.
[[nodiscard]] core::TrunkClass true_class(double flexion_deg) noexcept;

/// Counts the answers to reaches of a known class.
class Confusion {
 public:
  /// Columns: rejected or no reach found, none, minor, moderate, maximum.
  static constexpr std::size_t kAnswers = 5;
  static constexpr std::size_t kWanted = 4;  ///< Rows: none, minor, moderate, maximum.

  void add(core::TrunkClass wanted, core::TrunkClass answer) noexcept;
  void add(const Confusion& other) noexcept;

  [[nodiscard]] std::size_t count(core::TrunkClass wanted, core::TrunkClass answer) const noexcept;
  [[nodiscard]] std::size_t of(core::TrunkClass wanted) const noexcept;
  [[nodiscard]] std::size_t correct(core::TrunkClass wanted) const noexcept { return count(wanted, wanted); }
  [[nodiscard]] std::size_t correct() const noexcept;
  [[nodiscard]] std::size_t total() const noexcept;
  /// Returns the counts without arm-only reaches, which the thesis's networks do not distinguish.
  [[nodiscard]] Confusion of_trunk() const noexcept;
  /// Returns the number of reaches that were not rejected.
  [[nodiscard]] std::size_t kept() const noexcept;
  /// Returns the correct fraction; NaN without reaches.
  [[nodiscard]] double accuracy() const noexcept;
  [[nodiscard]] double kept_share() const noexcept;
  [[nodiscard]] double kept_accuracy() const noexcept;

 private:
  std::array<std::array<std::size_t, kAnswers>, kWanted> counts_{};
};

inline constexpr std::array<core::TrunkClass, Confusion::kAnswers> kEveryAnswer = {
    core::TrunkClass::Rejected, core::TrunkClass::None, core::TrunkClass::Minor, core::TrunkClass::Moderate, core::TrunkClass::Maximum};

}  // namespace dts::lab::study
