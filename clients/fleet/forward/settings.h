// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dts/endpoints.h"
#include "files/toml_reader.h"
#include "fleet/wire/facts.h"

namespace dts::fleet::forward {

/// Times of the day between which recordings may be sent, local time. `from` after `to`: over midnight.
struct Hours {
  std::chrono::minutes from{};
  std::chrono::minutes to{};

  [[nodiscard]] bool contains(std::chrono::minutes time_of_day) const noexcept;
};

struct UploadLimits {
  std::optional<double> rate;             ///< Bytes/s; absent: no limit.
  std::optional<double> rate_in_session;  ///< Bytes/s while a session runs; absent: as `rate`.
  std::optional<Hours> hours{};           ///< Absent: always.
};

/// The configuration of dts-forward, and of the enrolment file that it names. All values are checked.
struct Settings {
  std::string clinic;
  std::vector<std::string> servers;
  std::string ca_pem;
  std::string key_file;
  std::string state_folder;
  client::EndpointWishes daemon;
  UploadLimits upload;
  wire::SendRules rules;
  bool is_live_allowed = true;
};

/// Reads the file and its enrolment file. Adds each error with its place to `problems`. `is_enrolled` false: reads only what is known
/// before the centre has sent the enrolment file: key and state folder.
[[nodiscard]] Settings load_settings(const std::string& file, bool is_enrolled, files::Problems& problems);

/// Returns bytes/s of "4 Mbit/s", "500 kbit/s"; nothing for anything else, and for less than 8 kbit/s.
[[nodiscard]] std::optional<double> rate_of_text(std::string_view text);
/// Returns the hours of "20:00-06:00"; nothing for anything else.
[[nodiscard]] std::optional<Hours> hours_of_text(std::string_view text);

}  // namespace dts::fleet::forward
