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

/// Nothing when `topic` is not one of the protocol's topics (the fixed list of stream.proto).
[[nodiscard]] std::optional<TopicName> parse_topic(std::string_view topic) noexcept;

/// Retained events are sent again whenever anybody subscribes to anything.
[[nodiscard]] bool is_retained_event(std::string_view name) noexcept;

}  // namespace dts::client
