// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "core/result.h"

namespace dts::session {

/// Where recordings are stored, and how much free space they need.
struct StorageConfig {
  std::string directory;           ///< State folder: catalogue.sqlite, and sessions/ with the recordings.
  double refuse_below_min = 10.0;  ///< Minimum free space to start a session, in minutes of recording.
  double warn_below_min = 60.0;
  double resume_within_min = 0.0;  ///< The daemon's start resumes a session that was interrupted less than this ago; 0: never.
  double stop_below_mib = 64.0;    ///< Below this free space, recordings are closed properly before the disk is full.
};

enum class DiskState : std::uint8_t { Fine = 1, Low, Full, Unusable };
[[nodiscard]] std::string_view name(DiskState state) noexcept;

/// Free space on the disk of the state folder.
struct DiskView {
  DiskState state = DiskState::Fine;
  std::uint64_t free_bytes = 0;
  double recordable_s = 0.0;  ///< Remaining time if all rigs record.
  std::string directory;
  std::string problem;  ///< What is wrong and what to do; empty: no problem.
};

/// Checks the disk. `bytes_per_s`: the data rate of all rigs together.
[[nodiscard]] DiskView look_at_disk(const StorageConfig& config, double bytes_per_s);

/// Creates `<directory>/sessions` (0750) and checks the access rights to it. An error says what is wrong and what to do.
[[nodiscard]] core::Status prepare_storage(const StorageConfig& config);
[[nodiscard]] std::string catalogue_file(const StorageConfig& config);
[[nodiscard]] std::string sessions_directory(const StorageConfig& config);
/// Returns the size of a file; 0 if it is not known.
[[nodiscard]] std::uint64_t size_of(const std::string& file);

}  // namespace dts::session
