// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/clock.h"
#include "core/result.h"
#include "lab/replay/stream_check.h"
#include "pipeline/rig_config.h"
#include "record/recording.h"

namespace dts::lab::replay {

/// One channel of the centre of pressure over the whole recording; NaN: never a value.
struct ChannelSummary {
  std::string name;
  double last = std::numeric_limits<double>::quiet_NaN();
  double mean = std::numeric_limits<double>::quiet_NaN();
};

struct ComparedStream {
  std::string name;
  std::uint64_t scans = 0;  ///< Number of compared scans.
  std::optional<Difference> difference;
};

struct ReplayReport {
  std::uint64_t scans = 0;  ///< Of the raw stream.
  std::uint64_t segments = 0;
  double duration_s = 0.0;   ///< Duration of the replay itself.
  bool is_restored = false;  ///< The stages started with the recorded state.
  std::vector<ComparedStream> streams;
  std::vector<ChannelSummary> cop;
  std::vector<std::string> notes;  ///< Limits of the comparison.

  /// Returns whether all compared values are equal bit for bit; nothing if nothing was compared.
  [[nodiscard]] std::optional<bool> is_identical() const;
  [[nodiscard]] double scans_per_s() const { return duration_s > 0.0 ? static_cast<double>(scans) / duration_s : 0.0; }
};

/// Processes the raw and aux scans of `recording` with the pipeline of `config`, assembled as in the daemon, and compares every recorded
/// derived stream with the output. `config` is changed to the recorded rate. Fails as reading fails, and if the file lacks the channels of
/// the device.
[[nodiscard]] core::Result<ReplayReport> replay(record::Recording& recording, pipeline::RigConfig config, const std::string& name,
                                                const core::Clock& clock, const std::function<void(double)>& progress);

}  // namespace dts::lab::replay
