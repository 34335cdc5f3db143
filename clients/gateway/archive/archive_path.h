// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "report/language.h"

namespace dts::gateway {

/// The parsed path below /api/sessions/.
struct ArchivePath {
  enum class Kind : std::uint8_t { Report, Page, Recording, Csv, Bids, C3d, Fhir };

  std::string session_id;
  Kind kind = Kind::Report;
  std::string page{};                                     ///< For Page: "trial-01.html"
  std::uint32_t part = 0;                                 ///< For Recording.
  report::Language language = report::Language::English;  ///< For Report and Page: "report-de" in the path is German.
};

/// Returns nothing for a path that no session can have. Ids and pages consist of letters, digits, '.', '_' and '-' and do not begin with a
/// '.'.
[[nodiscard]] std::optional<ArchivePath> read_archive_path(std::string_view path);

}  // namespace dts::gateway
