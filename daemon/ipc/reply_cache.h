// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <string>
#include <unordered_map>

namespace dts::ipc {

/// Remembers the answers to recent commands by request ID. If an answer was lost, the client can repeat its request and the command is not
/// executed twice (zguide chapter 4, Lazy Pirate). Bounded: removes the oldest answer first.
class ReplyCache {
 public:
  explicit ReplyCache(std::size_t capacity) : capacity_(capacity) {}

  struct Entry {
    std::string request;  ///< All bytes of the request: a different request with the same ID is an error, not a repeat.
    std::string reply;
  };

  /// Returns nullptr if the ID is not in the cache.
  [[nodiscard]] const Entry* find(const std::string& request_id) const;
  void store(const std::string& request_id, Entry entry);

 private:
  std::size_t capacity_;
  std::deque<std::string> order_;
  std::unordered_map<std::string, Entry> replies_;
};

}  // namespace dts::ipc
