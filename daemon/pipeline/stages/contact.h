// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/stage_state.h"

namespace dts::pipeline {

/// Whether a person is on the plate: from a load of `threshold_n` until the load falls below 80 % of it, so that the contact does not
/// flicker near the threshold. Thread: rig. Realtime-safe: yes.
class Contact {
 public:
  explicit Contact(double threshold_n) noexcept : threshold_n_(threshold_n) {}

  /// Returns whether there is contact under `load_n`.
  bool update(double load_n) noexcept {
    is_on_ = load_n >= (is_on_ ? kReleaseRatio : 1.0) * threshold_n_;
    return is_on_;
  }
  void reset() noexcept { is_on_ = false; }

  static constexpr std::size_t kStateSize = 1;
  void save(StateWriter& writer) const noexcept { writer.put(is_on_ ? 1.0 : 0.0); }
  void restore(StateReader& reader) noexcept { is_on_ = reader.flag(); }

 private:
  static constexpr double kReleaseRatio = 0.8;

  double threshold_n_;
  bool is_on_ = false;
};

}  // namespace dts::pipeline
