// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <type_traits>

#include "pipeline/stage_state.h"

namespace dts::pipeline {

/// Saves or loads a state with the same code, so that its members are listed only once: `exchange(self, StateSaver)` and `exchange(self,
/// StateLoader)`.
class StateSaver {
 public:
  explicit StateSaver(StateWriter& writer) noexcept : writer_(writer) {}
  void number(double value, double /*minimum*/, double /*maximum*/) noexcept { writer_.put(value); }
  template <class Whole>
  void count(Whole value, std::uint64_t /*maximum*/) noexcept {
    writer_.put_count(static_cast<std::uint64_t>(value));
  }
  void flag(bool value) noexcept { writer_.put(value ? 1.0 : 0.0); }

 private:
  StateWriter& writer_;
};

class StateLoader {
 public:
  explicit StateLoader(StateReader& reader) noexcept : reader_(reader) {}
  void number(double& value, double minimum, double maximum) noexcept { value = reader_.number(minimum, maximum); }
  template <class Whole>
  void count(Whole& value, std::uint64_t maximum) noexcept {
    value = static_cast<Whole>(reader_.count(maximum));
  }
  void flag(bool& value) noexcept { value = reader_.flag(); }

 private:
  StateReader& reader_;
};

inline constexpr std::uint64_t kAnyCount = std::numeric_limits<std::uint64_t>::max();
inline constexpr double kMostStateMm = 1e6;  ///< Beyond any possible deflection of a seat.

}  // namespace dts::pipeline
