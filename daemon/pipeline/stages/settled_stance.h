// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/rate.h"
#include "pipeline/stage_state.h"

namespace dts::pipeline {

/// Whether a person stands on the plate with the whole weight, for the stage `cop`: not while stepping on or off.
///
///     load within 5 % and position possible for 0.5 s --> settled --load differs by 20 %, position impossible for 0.25 s--> not settled
class SettledStance {
 public:
  static constexpr std::size_t kStateSize = 3;

  void prepare(const core::Rate& rate) noexcept;
  /// Processes one scan with contact; returns whether the person has settled. `is_possible`: a person on two feet can have this position.
  /// Realtime-safe: yes.
  bool update(double load_n, bool is_possible) noexcept;
  /// Nobody is on the plate.
  void reset() noexcept;
  void save(StateWriter& writer) const noexcept;
  /// Restores a state; an impossible value is noted by `reader`.
  void restore(StateReader& reader) noexcept;

 private:
  std::uint64_t settle_ = 50;       ///< Scans.
  std::uint64_t longest_out_ = 25;  ///< Scans.
  bool is_settled_ = false;
  std::uint64_t run_ = 0;     ///< Scans in a row: before settling those of an even load, after it those with an impossible position.
  double reference_n_ = 0.0;  ///< The load with which the present run or stance began.
};

}  // namespace dts::pipeline
