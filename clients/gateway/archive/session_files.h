// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "dts/error.h"
#include "dts/v1/sessions.pb.h"

namespace dts::gateway {

/// The files of a session that is over, part by part. WrongState while it runs, NotFound when nothing was recorded, DataDamaged for a part
/// that is gone, NotAllowed or Failed for one that cannot be read here.
[[nodiscard]] client::Result<std::vector<std::string>> files_of(const v1::SessionRecord& session);
/// The same of one part; the session may be running, that part not.
[[nodiscard]] client::Result<std::string> file_of(const v1::SessionRecord& session, std::uint32_t part);

/// The same for the same recordings, another one when a part came or was repaired.
[[nodiscard]] std::string fingerprint_of(const v1::SessionRecord& session);

}  // namespace dts::gateway
