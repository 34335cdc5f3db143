// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/result.h"
#include "fleet/database/database.h"

namespace dts::fleet::desk {

/// The place of a session in the list of all sessions, newest first.
struct SessionKey {
  std::int64_t started_us = 0;  ///< UTC.
  std::string clinic;
  std::string id;

  friend bool operator==(const SessionKey&, const SessionKey&) = default;
};
/// "1700000000000000,kent,20261121T144525Z-floor-1". Returns nothing for any other text.
[[nodiscard]] std::optional<SessionKey> parse_session_key(std::string_view text);

inline constexpr int kMostSessions = 200;
/// Which sessions a page has. Empty texts: all.
struct SessionFilter {
  std::string clinic{};
  std::string rig{};
  std::string protocol{};
  std::string subject{};
  std::optional<std::int64_t> since_ms{};  ///< UTC: not started earlier.
  std::optional<SessionKey> before{};      ///< The last session of the page before.
  int limit = 50;                          ///< 1..kMostSessions.
};

struct TrendFilter {
  std::string measure;              ///< "eyes-open/MVELO"
  std::string analysis = "clinic";  ///< "clinic", or an analysis of the centre: "sway 0.3.1"
  std::string protocol{};
  std::string clinic{};
  std::optional<std::int64_t> since_ms{};
};

/// Each returns a JSON document, which PostgreSQL makes. README.md describes them. Errors are those of `Database`.

/// `version`: of the centre. Clinics with an older one are named.
[[nodiscard]] core::Result<std::string> clinics_page(database::Database& database, std::string_view version);
/// Fails with NotFound.
[[nodiscard]] core::Result<std::string> clinic_page(database::Database& database, std::string_view version, const std::string& clinic);
[[nodiscard]] core::Result<std::string> sessions_page(database::Database& database, const SessionFilter& filter);
/// The first `kMostMeasures` and `kMostProtocols` by name.
inline constexpr int kMostMeasures = 1000;
inline constexpr int kMostProtocols = 200;
[[nodiscard]] core::Result<std::string> measures_page(database::Database& database);
[[nodiscard]] core::Result<std::string> trend_page(database::Database& database, const TrendFilter& filter);

}  // namespace dts::fleet::desk
