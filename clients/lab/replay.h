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
#include "lab/stream_check.h"
#include "pipeline/rig_config.h"
#include "record/recording.h"

namespace dts::lab {

/// One channel of the centre of pressure over the whole recording; NaN: it never had a value.
struct ChannelSummary {
  std::string name;
  double last = std::numeric_limits<double>::quiet_NaN();
  double mean = std::numeric_limits<double>::quiet_NaN();
};

struct ComparedStream {
  std::string name;
  std::uint64_t scans = 0;  ///< Compared.
  std::optional<Difference> difference;
};

struct ReplayReport {
  std::uint64_t scans = 0;  ///< Of the raw stream.
  std::uint64_t segments = 0;
  double duration_s = 0.0;   ///< Of the replay.
  bool is_restored = false;  ///< The stages began where the recording began.
  std::vector<ComparedStream> streams;
  std::vector<ChannelSummary> cop;
  std::vector<std::string> notes;  ///< What limits the comparison.

  /// Whatever was compared is the same bit for bit; nothing when nothing was compared.
  [[nodiscard]] std::optional<bool> is_identical() const;
  [[nodiscard]] double scans_per_s() const { return duration_s > 0.0 ? static_cast<double>(scans) / duration_s : 0.0; }
};

/// The rig that made a recording, as it says itself. Fails with InvalidArgument when it does not.
[[nodiscard]] core::Result<pipeline::RigConfig> rig_of(const record::Recording& recording, const std::string& name);

/// Pushes the raw and aux scans of `recording` through the pipeline that `config` describes, as the daemon assembles it, and compares every
/// recorded derived stream with what comes out. `config` is given the recorded rate. Fails as the reading does, and when the file does not
/// say where the device had its channels.
[[nodiscard]] core::Result<ReplayReport> replay(record::Recording& recording, pipeline::RigConfig config, const std::string& name,
                                                const core::Clock& clock, const std::function<void(double)>& progress);

}  // namespace dts::lab
