// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "dts/error.h"
#include "dts/v1/sessions.pb.h"

namespace dts::gateway {

/// Returns the files of a finished session, part by part. Fails with WrongState while it runs or if it is deleted, NotFound if nothing was
/// recorded, DataDamaged for a missing part, NotAllowed or Failed for a file that the gateway cannot read.
[[nodiscard]] client::Result<std::vector<std::string>> files_of(const v1::SessionRecord& session);
/// The same for one part; the session may still be running, but not that part.
[[nodiscard]] client::Result<std::string> file_of(const v1::SessionRecord& session, std::uint32_t part);

/// Returns a text that stays the same for the same recordings, and changes when a part is added or repaired
/// or the session is corrected.
[[nodiscard]] std::string fingerprint_of(const v1::SessionRecord& session);

}  // namespace dts::gateway
