// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "core/result.h"

namespace dts::lab::compare {

/// The recordings of two rigs that were made at the same time.
struct SessionPair {
  std::string file_a;  ///< Of the leading rig.
  std::string file_b;
  std::string rig_a;
  std::string rig_b;
};

/// Finds the recordings of a session of two rigs in the folder of the recordings. `part`: of the leading rig; 0: the session was not
/// resumed. Fails with NotFound, and with InvalidArgument if the session has not two rigs at this time, or was resumed and `part` is 0.
[[nodiscard]] core::Result<SessionPair> find_session_pair(const std::string& folder, const std::string& session_id, std::uint32_t part);

}  // namespace dts::lab::compare
