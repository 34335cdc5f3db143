// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "dts/v1/stream.pb.h"

namespace dts::lsl {

/// Knows which sessions are under way, from the session events of all rigs. A session over several rigs counts once. Thread: one.
class SessionOrder {
 public:
  /// `rigs`: the only ones whose sessions count; empty: all.
  explicit SessionOrder(std::vector<std::string> rigs = {}) : rigs_(std::move(rigs)) {}
  void take(std::string_view rig, const v1::SessionChange& change);
  /// dtsd was restarted: no session is under way until its events say so.
  void clear() { of_rig_.clear(), order_.clear(); }
  /// Returns the ID of the session that started first; empty: none is under way.
  [[nodiscard]] std::string first() const { return order_.empty() ? std::string() : order_.front(); }

 private:
  std::vector<std::string> rigs_;
  std::map<std::string, std::string, std::less<>> of_rig_;
  std::vector<std::string> order_;
};

}  // namespace dts::lsl
