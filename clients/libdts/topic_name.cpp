// SPDX-License-Identifier: Apache-2.0
#include "topic_name.h"

#include "dts/wire/options.h"

namespace dts::client {

std::optional<TopicName> parse_topic(std::string_view topic) {
  constexpr std::size_t kLongestTopic = 128;
  const std::size_t slash = topic.find('/');
  if (topic.size() > kLongestTopic || slash == 0 || slash == std::string_view::npos) return std::nullopt;
  TopicName parsed{.rig = topic.substr(0, slash), .name = topic.substr(slash + 1), .kind = TopicKind::Stream};
  if (parsed.name.empty() || parsed.name.find('/') != std::string_view::npos) return std::nullopt;
  if (topic == "dtsd/status") parsed.kind = TopicKind::Status;
  if (wire::is_event_topic(parsed.name)) parsed.kind = TopicKind::Event;
  return parsed;
}

}  // namespace dts::client
