// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "core/result.h"
#include "report/report.h"

namespace dts::gateway {

enum class ExportFormat : std::uint8_t { Csv, Bids, C3d, Fhir };
/// Returns "csv", "bids", "c3d" or "fhir".
[[nodiscard]] std::string name(ExportFormat format);

struct ExportOrder {
  std::string session_id;
  ExportFormat format = ExportFormat::Csv;
  std::vector<std::string> files;                        ///< The session's parts.
  std::uint64_t most_bytes = 0;                          ///< Limit for text files and zip together.
  std::chrono::seconds pdf_limit = report::kLongestPdf;  ///< A FHIR Bundle whose PDF takes longer has none.
};

/// Writes the export into "data" below `folder`, which it creates, and packs it into `folder`/export.zip. Returns the size of the zip file.
/// In the zip, all files are below "SESSION-FORMAT"; if a recording is incomplete, there is also a file DAMAGE.txt; without
/// the PDF of a FHIR Bundle, a file NOTES.txt. Fails with DataDamaged
/// if a recording contradicts its checksums, with LimitExceeded if the export is too large; `folder` may then hold some files. Thread: any.
[[nodiscard]] core::Result<std::uint64_t> make_export(const ExportOrder& order, const std::filesystem::path& folder,
                                                      const std::stop_token& stop);

}  // namespace dts::gateway
