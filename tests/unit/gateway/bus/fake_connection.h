// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dts/v1/gateway.pb.h"
#include "gateway/http/tab.h"

namespace dts::gateway {

/// Keeps what a tab sends.
class FakeConnection final : public TabConnection {
 public:
  void send(std::string message) override {
    v1::FromGateway parsed;
    EXPECT_TRUE(parsed.ParseFromString(message));
    sent.push_back(std::move(parsed));
  }
  [[nodiscard]] std::size_t unsent_bytes() const noexcept override { return unsent; }
  void close(unsigned code, std::string reason) override {
    closed_with = code;
    close_reason = std::move(reason);
  }

  std::vector<v1::FromGateway> sent{};
  std::size_t unsent = 0;
  std::optional<unsigned> closed_with{};
  std::string close_reason{};
};

inline void say(Tab& tab, const v1::FromBrowser& message) { tab.on_message(message.SerializeAsString()); }

}  // namespace dts::gateway
