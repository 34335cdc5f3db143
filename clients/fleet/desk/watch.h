// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "fleet/link/link.h"
#include "gateway/bus/bus_reader.h"

namespace dts::fleet::desk {

/// Watches the rigs of one clinic on a thread of its own ("watch"): asks the clinic for topics again and again, because it publishes only
/// what was asked for within the last 10 s, and passes on what it publishes of that. Anything else is dropped.
///
///     want, set_viewers --> LiveRequest (4 s) --> clinic --> live.> --> check --> on_item
class Watch {
 public:
  /// `link` outlives the watch. `on_item` is called on the watch's thread.
  Watch(link::Link& link, std::string clinic, std::function<void(gateway::BusItem)> on_item);
  ~Watch();
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;
  Watch(Watch&&) = delete;
  Watch& operator=(Watch&&) = delete;

  /// Sets the topics, as prefixes. dtsd's status and the retained events of all rigs are always watched. Thread: any, as the next two.
  void want(std::vector<std::string> prefixes);
  /// Sets who watches: the clinic shows these names.
  void set_viewers(std::set<std::string> names);
  /// Returns half of the shortest round trip to the clinic; nothing before its first answer.
  [[nodiscard]] std::optional<std::chrono::nanoseconds> delay() const noexcept;

 private:
  class Loop;
  std::unique_ptr<Loop> loop_;
  std::jthread thread_;
};

/// Converts a message that a clinic published. Returns nothing if it is not a message of dts.v1 for this topic. `topic`: "floor/cop".
[[nodiscard]] gateway::CarriedPointer carried_of(const std::string& topic, std::string bytes);

/// Returns the topics of a clinic with these prefixes, at most `kMostTopics`, with those that are always watched first.
inline constexpr std::size_t kMostTopics = 64;
[[nodiscard]] std::vector<std::string> topics_of(const v1::StatusSnapshot* status, const std::vector<std::string>& prefixes);

/// Returns what is wrong with a status; empty: nothing. A clinic is not trusted: a status could name any number of rigs.
inline constexpr int kMostRigs = 64;
inline constexpr int kMostStreams = 64;  ///< Of a rig.
[[nodiscard]] std::string problem_of_status(const v1::StatusSnapshot& status);

}  // namespace dts::fleet::desk
