// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "access/rate_limit.h"
#include "core/result.h"

namespace dts::relay {

/// Limits how often each client sends commands, before anything of them is decoded: 50 a second, 100 at once. Thread: one.
class MessageLimit {
 public:
  MessageLimit();

  /// Counts a message of `who`. Fails with LimitExceeded if the client is above its limit.
  [[nodiscard]] core::Status admit(const std::string& who, std::int64_t now_ns);
  /// Returns true if a message above the limit gets an answer. Counts it: these answers have their own limit, so that a flood gets few.
  [[nodiscard]] bool is_worth_an_answer(const std::string& who, std::int64_t now_ns) { return refusals_.take(who, now_ns); }

 private:
  access::RateLimit commands_;
  access::RateLimit refusals_;
};

}  // namespace dts::relay
