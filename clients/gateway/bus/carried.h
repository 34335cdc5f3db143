// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace dts::gateway {

/// The only topic that every tab receives.
inline constexpr std::string_view kStatusTopic = "dtsd/status";

/// A message of the bus for any number of tabs. Immutable, therefore shared.
struct Carried {
  enum class Kind : std::uint8_t { Block, Event, Status };

  std::string topic;
  Kind kind = Kind::Block;
  std::string bytes;              ///< The dts.v1 message.
  std::uint64_t scans = 0;        ///< Number of scans in a block.
  bool is_retained = false;       ///< True for a state that later subscribers must also receive.
  std::uint64_t instance_id = 0;  ///< Of the daemon that sent it; changes when the daemon restarts.
};
using CarriedPointer = std::shared_ptr<const Carried>;

}  // namespace dts::gateway
