// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <string>

#include "core/result.h"

namespace dts::fleet::hub {

/// Writes the content of a file, or the names of a folder, to the disk. After a failure the system may have dropped what was not written:
/// never try again, write the content again.
[[nodiscard]] core::Status synchronise(const std::string& path);

/// Returns the SHA-256, 32 bytes, of a synchronised file. Lets the system drop its copy in memory first, so that the bytes come from the
/// disk. Fails with NotFound if there is no such file, and with Timeout if a stop is requested meanwhile.
[[nodiscard]] core::Result<std::string> sha256_from_disk(const std::string& file, const std::stop_token& stop);

/// Creates a folder and those above it; the names are durable.
[[nodiscard]] core::Status create_folder(const std::string& folder);

/// Removes a file, durably. Returns false if there was none.
[[nodiscard]] core::Result<bool> remove_file(const std::string& file);

}  // namespace dts::fleet::hub
