// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "core/result.h"

namespace dts::session {

/// Where recordings go, and how much room there must be.
struct StorageConfig {
  std::string directory;           ///< State folder: catalogue.sqlite, and sessions/ with the recordings.
  double refuse_below_min = 10.0;  ///< No session starts with room for less.
  double warn_below_min = 60.0;
  double resume_within_min = 0.0;  ///< A session that a crash interrupted is gone on with at start when it is not older; 0: never.
  double stop_below_mib = 64.0;  ///< Recordings are closed in order before the disk is full to the last byte.
};

enum class DiskState : std::uint8_t { Fine = 1, Low, Full, Unusable };
[[nodiscard]] std::string_view name(DiskState state) noexcept;

/// How the state folder's disk stands.
struct DiskView {
  DiskState state = DiskState::Fine;
  std::uint64_t free_bytes = 0;
  double recordable_s = 0.0;  ///< With every rig recording.
  std::string directory;
  std::string problem;  ///< What is wrong and what to do; empty: nothing.
};

/// Looks at the disk. `bytes_per_s`: what all rigs together write.
[[nodiscard]] DiskView look_at_disk(const StorageConfig& config, double bytes_per_s);

/// Makes `<directory>/sessions` (0750) and tries whether files can be written there. Fails with what is wrong and what to do.
[[nodiscard]] core::Status prepare_storage(const StorageConfig& config);
[[nodiscard]] std::string sessions_directory(const StorageConfig& config);

}  // namespace dts::session
