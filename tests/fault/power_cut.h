// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "fault/reference.h"

namespace dts::fault {

/// What one power cut cost.
struct PowerCut {
  double recorded_s = 0.0;  ///< From the session's start to the cut.
  double lost_s = 0.0;      ///< From the recovered file's last time stamp to the cut.
  double told_lost_s_at_most = 0.0;
  std::string problem;
};

/// Records the floor with 16 sensors at 1500 Hz for `seconds` in this process and takes the power away at `cuts` random moments, by the
/// model of durable_model.h: what would have survived is put back and recovered.
[[nodiscard]] std::vector<PowerCut> cut_power(double seconds, std::size_t cuts, std::uint32_t seed, const Reference& reference);

/// The same on a file system ("ext4" or "xfs") of this machine's kernel, on a LoggedDisk. Throws std::runtime_error if there can be none.
[[nodiscard]] std::vector<PowerCut> cut_power_of_disk(std::string_view file_system, double seconds, std::size_t cuts, std::uint32_t seed,
                                                      const Reference& reference);

}  // namespace dts::fault
