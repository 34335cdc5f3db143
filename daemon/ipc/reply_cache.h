// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <string>
#include <unordered_map>

namespace dts::ipc {

/// Remembers the answers to recent commands by request id, so that a client which heard nothing can ask again without
/// the command being executed twice (zguide chapter 4, Lazy Pirate). Bounded; the oldest answer goes first.
class ReplyCache {
 public:
  explicit ReplyCache(std::size_t capacity) : capacity_(capacity) {}

  struct Entry {
    std::string request;  ///< All bytes of it: the same id over another command is a mistake, not a repeat.
    std::string reply;
  };

  /// nullptr when the id is not known (any more).
  [[nodiscard]] const Entry* find(const std::string& request_id) const;
  void store(const std::string& request_id, Entry entry);

 private:
  std::size_t capacity_;
  std::deque<std::string> order_;
  std::unordered_map<std::string, Entry> replies_;
};

}  // namespace dts::ipc
