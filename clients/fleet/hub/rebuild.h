// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "core/result.h"
#include "fleet/hub/catalogue.h"
#include "fleet/hub/store.h"

namespace dts::fleet::hub {

struct Rebuilt {
  std::uint64_t entered = 0;
  std::uint64_t known = 0;          ///< Had a receipt already.
  std::uint64_t erased = 0;         ///< Belonged to erased sessions, and were removed.
  std::vector<std::string> left{};  ///< Recordings that could not be entered, each with the reason.
  std::set<std::string> clinics{};  ///< Of the entered recordings.
};

/// Enters the recordings of the store that have no receipt, after a loss of the database: part, receipt, and what the header of the file
/// holds of the session, with revision 0: the clinic's facts replace it. Reads and checks every such file. Removes those of erased
/// sessions: reconcile the erasures first. Fails if the database does, and with Unreachable if the store does not answer.
[[nodiscard]] core::Result<Rebuilt> rebuild(Store& store, Catalogue& catalogue, const std::string& hub, std::int64_t utc_ns);

}  // namespace dts::fleet::hub
