// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fault/recorded_raw.h"
#include "pipeline/rig_config.h"

namespace dts::fault {

/// What a simulated device gives, computed without a daemon: scan by scan since its start, the sensors in the order of the rig.
/// A simulated value depends on the number of its scan alone, so that a recording can be held against it bit for bit.
class Reference {
 public:
  /// Throws when the device cannot be made.
  [[nodiscard]] static Reference compute(const pipeline::RigConfig& rig, double seconds);

  /// The first difference, in words; empty: every recorded scan is exactly the simulated one, in order.
  [[nodiscard]] std::string difference(const RecordedRaw& recorded) const;

 private:
  [[nodiscard]] std::span<const double> row(std::size_t scan) const noexcept {
    return std::span(values_).subspan(scan * channels_, channels_);
  }
  [[nodiscard]] std::size_t scans() const noexcept { return channels_ == 0 ? 0 : values_.size() / channels_; }
  /// Scans of `run` that are the simulator's from scan `start` on, before one differs.
  [[nodiscard]] std::size_t same_from(std::size_t start, std::span<const double> run) const noexcept;
  /// Where the whole run stands, at `from` or later. An unloaded plate gives the same scan many times.
  [[nodiscard]] std::optional<std::size_t> find(std::span<const double> run, std::size_t from) const noexcept;

  std::size_t channels_ = 0;
  std::vector<double> values_;
};

}  // namespace dts::fault
