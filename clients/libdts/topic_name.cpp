// SPDX-License-Identifier: Apache-2.0
#include "topic_name.h"

#include <algorithm>
#include <array>

namespace dts::client {
namespace {

constexpr std::size_t kLongestTopic = 128;
constexpr std::array<std::string_view, 6> kStreams{"raw", "filtered", "deflection", "cop", "transient", "aux"};
constexpr std::array<std::string_view, 9> kEvents{"gap", "marker", "trigger", "device", "session", "trial", "reach", "class", "sway"};

}  // namespace

std::optional<TopicName> parse_topic(std::string_view topic) noexcept {
  const std::size_t slash = topic.find('/');
  if (topic.size() > kLongestTopic || slash == 0 || slash == std::string_view::npos) return std::nullopt;
  TopicName parsed{.rig = topic.substr(0, slash), .name = topic.substr(slash + 1), .kind = TopicKind::Stream};
  if (std::ranges::find(kStreams, parsed.name) != kStreams.end()) return parsed;
  parsed.kind = TopicKind::Event;
  if (std::ranges::find(kEvents, parsed.name) != kEvents.end()) return parsed;
  parsed.kind = TopicKind::Status;
  if (topic == "dtsd/status") return parsed;
  return std::nullopt;
}

bool is_retained_event(std::string_view name) noexcept { return name == "device" || name == "session"; }

}  // namespace dts::client
