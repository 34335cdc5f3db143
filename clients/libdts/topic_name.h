// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace dts::client {

enum class TopicKind : std::uint8_t { Stream, Event, Status };

/// "<rig>/<name>" taken apart; the views point into the text.
struct TopicName {
  std::string_view rig;
  std::string_view name;
  TopicKind kind = TopicKind::Stream;
};

/// Nothing if `topic` is not "<rig>/<name>". What is neither the status nor an event topic of the protocol is a stream.
[[nodiscard]] std::optional<TopicName> parse_topic(std::string_view topic);

}  // namespace dts::client
