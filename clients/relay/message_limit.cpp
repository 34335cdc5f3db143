// SPDX-License-Identifier: Apache-2.0
#include "relay/message_limit.h"

namespace dts::relay {
namespace {

// A fast person sends ten commands a second, a dashboard two. A script that needs more must subscribe to a stream.
constexpr double kCommandsPerSecond = 50.0;
constexpr double kCommandBurst = 100.0;

}  // namespace

MessageLimit::MessageLimit() : commands_(kCommandsPerSecond, kCommandBurst), refusals_(kCommandsPerSecond, kCommandBurst) {}

core::Status MessageLimit::admit(const std::string& who, std::int64_t now_ns) {
  if (commands_.take(who, now_ns)) return {};
  return core::fail(core::ErrorCode::LimitExceeded, "more than 50 commands per second from " + who,
                    "subscribe to dtsd/status instead of repeating the command");
}

}  // namespace dts::relay
