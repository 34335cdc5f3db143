// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../clients/libdts/inbox.h"

#include <gtest/gtest.h>

#include "unit/libdts/fake_daemon.h"

namespace dts::client {

inline constexpr std::int64_t kNowNs = 1'000'000'000'000;
inline constexpr std::int64_t kMillisecond = 1'000'000;

class InboxTest : public ::testing::Test {
 protected:
  static Inbox inbox(Mode mode, bool hands_out_status = false) { return {mode, hands_out_status, "this-boot"}; }
  static void give(Inbox& inbox, const std::string& topic, const google::protobuf::MessageLite& message, std::int64_t now_ns = kNowNs) {
    give_raw(inbox, topic, message.SerializeAsString(), now_ns);
  }
  static void give_raw(Inbox& inbox, const std::string& topic, const std::string& body, std::int64_t now_ns = kNowNs) {
    inbox.accept(topic, std::as_bytes(std::span(body)), now_ns);
  }
  static void learn(Inbox& inbox) { give(inbox, "dtsd/status", testing::floor_status()); }
  /// The next message as a block; fails the test when it is none.
  static Block next_block(Inbox& inbox) {
    const auto message = inbox.next(kNowNs);
    EXPECT_TRUE(message && std::holds_alternative<Block>(*message));
    return message && std::holds_alternative<Block>(*message) ? std::get<Block>(*message) : Block{};
  }
};

}  // namespace dts::client
