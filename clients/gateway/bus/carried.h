// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace dts::gateway {

/// The one topic that every tab gets.
inline constexpr std::string_view kStatusTopic = "dtsd/status";

/// A message of the bus on its way to any number of tabs. Never changes, hence shared.
struct Carried {
  enum class Kind : std::uint8_t { Block, Event, Status };

  std::string topic;
  Kind kind = Kind::Block;
  std::string bytes;              ///< The dts.v1 message.
  std::uint64_t scans = 0;        ///< Of a block.
  bool is_retained = false;       ///< A state, not a happening: who comes late is told the last one.
  std::uint64_t instance_id = 0;  ///< Of the daemon that said it: another one after a restart.
};
using CarriedPointer = std::shared_ptr<const Carried>;

}  // namespace dts::gateway
