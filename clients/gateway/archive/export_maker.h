// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "core/result.h"

namespace dts::gateway {

enum class ExportFormat : std::uint8_t { Csv, Bids };
/// "csv", "bids"
[[nodiscard]] std::string name(ExportFormat format);

struct ExportOrder {
  std::string session_id;
  ExportFormat format = ExportFormat::Csv;
  std::vector<std::string> files;  ///< The session's parts.
  std::uint64_t most_bytes = 0;    ///< Text and zip together.
};

/// Writes the export into "data" below `folder`, which is made, and packs it into `folder`/export.zip, whose size it returns. In the zip
/// all is below "SESSION-FORMAT"; for recordings that are not whole there is a file DAMAGE.txt beside that. Fails with DataDamaged when a
/// recording contradicts its checksums, with LimitExceeded when there is too much; then some of it may be left in `folder`. Thread: any.
[[nodiscard]] core::Result<std::uint64_t> make_export(const ExportOrder& order, const std::filesystem::path& folder,
                                                      const std::stop_token& stop);

}  // namespace dts::gateway
