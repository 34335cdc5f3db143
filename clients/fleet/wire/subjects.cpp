// SPDX-License-Identifier: Apache-2.0
#include "fleet/wire/subjects.h"

#include <algorithm>
#include <array>
#include <utility>

namespace dts::fleet::wire {
namespace {

constexpr std::string_view kVersion = "dts.v1.";
constexpr std::size_t kLongestName = 32;
constexpr std::size_t kLongestToken = 64;
constexpr char kAnyClinic[] = "*";

constexpr bool is_name_character(char c) noexcept { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-'; }

bool is_name(std::string_view name) noexcept {
  return !name.empty() && name.size() <= kLongestName && std::all_of(name.begin(), name.end(), is_name_character);
}

/// Rigs and streams: names without a dot, which divides subjects.
bool is_topic_token(std::string_view token) noexcept {
  return !token.empty() && token.size() <= kLongestToken &&
         std::all_of(token.begin(), token.end(), [](char c) { return is_name_character(c) || c == '_'; });
}

/// Subjects that are one word after the clinic.
constexpr std::array<std::pair<Matter, std::string_view>, 5> kPlain{{{Matter::Open, "up.open"},
                                                                     {Matter::Facts, "facts"},
                                                                     {Matter::Erase, "erase"},
                                                                     {Matter::Beat, "beat"},
                                                                     {Matter::DownLive, "down.live"}}};

std::string joined(std::string_view clinic, Matter matter, std::string_view worker, std::string_view rest) {
  std::string text(kVersion);
  text.append(clinic).append(".");
  switch (matter) {
    case Matter::Chunk: return text.append("up.").append(worker).append(".chunk");
    case Matter::Commit: return text.append("up.").append(worker).append(".commit");
    case Matter::Live: return text.append("live.").append(rest);
    default: break;
  }
  const auto* const plain = std::find_if(kPlain.begin(), kPlain.end(), [&](const auto& entry) { return entry.first == matter; });
  return text.append(plain->second);
}

/// Removes `prefix` from the front of `text`, if it is there.
bool drop(std::string_view& text, std::string_view prefix) noexcept {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

bool is_rest_of_inbox(std::string_view rest) noexcept { return !rest.empty() && rest.find_first_of("*> \t\r\n") == std::string_view::npos; }

std::optional<Subject> parse_upload(std::string clinic, std::string_view rest) {
  const std::size_t dot = rest.find('.');
  if (dot == std::string_view::npos || !is_worker_name(rest.substr(0, dot))) return std::nullopt;
  const std::string_view step = rest.substr(dot + 1);
  if (step != "chunk" && step != "commit") return std::nullopt;
  return Subject{
      .clinic = std::move(clinic), .matter = step == "chunk" ? Matter::Chunk : Matter::Commit, .worker = std::string(rest.substr(0, dot))};
}

std::optional<Subject> parse_live(std::string clinic, std::string_view rest) {
  const std::size_t dot = rest.find('.');
  if (dot == std::string_view::npos || !is_topic_token(rest.substr(0, dot)) || !is_topic_token(rest.substr(dot + 1))) return std::nullopt;
  std::string topic(rest);
  topic[dot] = '/';
  return Subject{.clinic = std::move(clinic), .matter = Matter::Live, .topic = std::move(topic)};
}

}  // namespace

bool is_clinic_name(std::string_view name) noexcept { return is_name(name); }

bool is_worker_name(std::string_view name) noexcept { return is_name(name); }

std::string to_text(const Subject& subject) {
  std::string topic = subject.topic;
  std::replace(topic.begin(), topic.end(), '/', '.');
  return joined(subject.clinic, subject.matter, subject.worker, topic);
}

std::optional<Subject> parse_subject(std::string_view text) {
  if (!drop(text, kVersion)) return std::nullopt;
  const std::size_t dot = text.find('.');
  if (dot == std::string_view::npos || !is_clinic_name(text.substr(0, dot))) return std::nullopt;
  std::string clinic(text.substr(0, dot));
  text.remove_prefix(dot + 1);
  for (const auto& [matter, name] : kPlain) {
    if (text == name) return Subject{.clinic = std::move(clinic), .matter = matter};
  }
  if (drop(text, "up.")) return parse_upload(std::move(clinic), text);
  if (drop(text, "live.")) return parse_live(std::move(clinic), text);
  return std::nullopt;
}

std::string of_all_clinics(Matter matter, std::string_view worker) { return joined(kAnyClinic, matter, worker, ">"); }

std::string inbox_prefix(std::string_view clinic) { return "_INBOX." + std::string(clinic); }

std::string dashboard_inbox_prefix(std::string_view public_key) { return "_DASHBOARD." + std::string(public_key); }

bool is_inbox_of_dashboard(std::string_view reply) noexcept { return drop(reply, "_DASHBOARD.") && is_rest_of_inbox(reply); }

bool is_inbox_of(std::string_view clinic, std::string_view reply) noexcept {
  return drop(reply, "_INBOX.") && drop(reply, clinic) && drop(reply, ".") && is_rest_of_inbox(reply);
}

Permissions clinic_permissions(std::string_view clinic) {
  const std::string own = std::string(kVersion) + std::string(clinic) + ".";
  return {.publish = {own + "up.>", own + "facts", own + "erase", own + "beat", own + "live.>"},
          .subscribe = {own + "down.>", inbox_prefix(clinic) + ".>"}};
}

Permissions hub_permissions() {
  const std::string all = std::string(kVersion) + kAnyClinic + ".";
  return {.publish = {inbox_prefix(kAnyClinic) + ".>"},
          .subscribe = {all + "up.>", all + "facts", all + "erase", all + "beat", std::string(kHubInboxPrefix) + ".>"}};
}

Permissions dashboard_permissions(std::string_view public_key, const std::vector<std::string>& clinics) {
  Permissions permissions{.publish = {}, .subscribe = {dashboard_inbox_prefix(public_key) + ".>"}, .may_answer = false};
  for (const std::string& clinic : clinics.empty() ? std::vector<std::string>{kAnyClinic} : clinics) {
    permissions.publish.push_back(to_text({.clinic = clinic, .matter = Matter::DownLive}));
    permissions.subscribe.push_back(to_text({.clinic = clinic, .matter = Matter::Live, .topic = ">"}));
  }
  return permissions;
}

}  // namespace dts::fleet::wire
