// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dts::fleet::wire {

/// Returns true for the name of a clinic: 1..32 of a-z 0-9 and -.
[[nodiscard]] bool is_clinic_name(std::string_view name) noexcept;
/// Returns true for the name of one process of the hub: the same characters.
[[nodiscard]] bool is_worker_name(std::string_view name) noexcept;

/// What a subject "dts.v1.CLINIC...." is for. The server has checked that only this clinic publishes to it.
enum class Matter : std::uint8_t { Open, Chunk, Commit, Facts, Erase, Beat, Live, DownLive };

struct Subject {
  std::string clinic;
  Matter matter = Matter::Beat;
  std::string worker{};  ///< Of Chunk and Commit.
  std::string topic{};   ///< Of Live: "floor/cop".

  friend bool operator==(const Subject&, const Subject&) = default;
};

/// Returns the subject as text. Names must be valid, see above.
[[nodiscard]] std::string to_text(const Subject& subject);
/// Returns nothing for a text that is not exactly one subject of this version.
[[nodiscard]] std::optional<Subject> parse_subject(std::string_view text);
/// Returns the text with "*" for the clinic: what the hub subscribes to. `worker` is for Chunk and Commit.
[[nodiscard]] std::string of_all_clinics(Matter matter, std::string_view worker = {});

/// Returns "_INBOX.CLINIC": replies to this clinic have subjects below it, so that no clinic can read those of another.
[[nodiscard]] std::string inbox_prefix(std::string_view clinic);
inline constexpr std::string_view kHubInboxPrefix = "_HUB";
/// Returns "_DASHBOARD.KEY": answers of clinics to the dashboard with this public key.
[[nodiscard]] std::string dashboard_inbox_prefix(std::string_view public_key);
/// Returns true if a clinic may answer to `reply`. Without this check, a dashboard could let a clinic publish to the hub or to another
/// clinic.
[[nodiscard]] bool is_inbox_of_dashboard(std::string_view reply) noexcept;
/// Returns true if the hub may answer to `reply`. Without this check, a clinic could let the hub publish to another clinic.
[[nodiscard]] bool is_inbox_of(std::string_view clinic, std::string_view reply) noexcept;

/// What a user of nats-server may do; everything else is rejected.
struct Permissions {
  std::vector<std::string> publish;
  std::vector<std::string> subscribe;
  bool may_answer = true;  ///< May answer each message that it receives, once (`allow_responses`).
};
[[nodiscard]] Permissions clinic_permissions(std::string_view clinic);
[[nodiscard]] Permissions hub_permissions();
/// May ask these clinics for live data, and receive it. `clinics`: empty: all.
[[nodiscard]] Permissions dashboard_permissions(std::string_view public_key, const std::vector<std::string>& clinics);

}  // namespace dts::fleet::wire
