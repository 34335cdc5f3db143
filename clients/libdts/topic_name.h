// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace dts::client {

enum class TopicKind : std::uint8_t { Stream, Event, Status };

/// The parts of a topic "<rig>/<name>"; the views point into the topic's text.
struct TopicName {
  std::string_view rig;
  std::string_view name;
  TopicKind kind = TopicKind::Stream;
};

/// Returns nothing if `topic` is not "<rig>/<name>". Every topic that is neither the status nor an event of the protocol is a stream.
[[nodiscard]] std::optional<TopicName> parse_topic(std::string_view topic);

}  // namespace dts::client
