// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "served_gateway.h"

namespace dts::gateway::test {
namespace {

using namespace dts::test;

/// Opens a WebSocket, sends, and tells the code of the close frame that comes back.
unsigned close_code_after(const ServedGateway& gateway, const std::string& bytes) {
  auto client = open_websocket(gateway.port());
  if (!client) return 0;
  client->send(bytes);
  return read_close_code(*client);
}

std::string answer_to_upgrade(std::uint16_t port, const std::string& path, std::string headers, const std::string& instead_of = {},
                              const std::string& with = {}) {
  if (!instead_of.empty()) headers.replace(headers.find(instead_of), instead_of.size(), with);
  RawClient client(port);
  client.send(request(port, "GET " + path, headers));
  return client.read_answer();
}

TEST(WebSocketServer, CarriesMessagesBothWays) {
  ServedGateway gateway;
  auto client = open_websocket(gateway.port());
  ASSERT_TRUE(client.has_value());

  client->send(frame(kBinary, "hel") + frame(kContinuation, "") + frame(kFin | kPing, "p") + frame(kFin | kContinuation, "lo"));
  const auto pong = read_frame(*client);
  const auto echo = read_frame(*client);

  ASSERT_TRUE(pong && echo);
  EXPECT_EQ(pong->opcode, kPong);
  EXPECT_EQ(echo->opcode, kBinary);
  EXPECT_EQ(echo->payload, "hello");
  EXPECT_EQ(gateway.statistics().tabs, 1U);
  EXPECT_EQ(gateway.tabs(), 1);
}

TEST(WebSocketServer, TheTabEndsWithItsConnection) {
  ServedGateway gateway;
  { ASSERT_TRUE(open_websocket(gateway.port()).has_value()); }

  EXPECT_TRUE(ServedGateway::eventually([&] { return gateway.tabs() == 0 && gateway.statistics().connections == 0; }));
  EXPECT_EQ(gateway.statistics().tabs, 0U);
}

TEST(WebSocketServer, OnlyPagesOfOursAndFriendsGetOne) {
  const ServedGateway gateway;
  const std::uint16_t port = gateway.port();
  const std::string good = upgrade_headers(port);
  const std::string origin = "Origin: http://127.0.0.1:" + std::to_string(port) + "\r\n";

  const std::string accepted = answer_to_upgrade(port, "/ws", good);
  EXPECT_EQ(status_of(accepted), "101");
  EXPECT_THAT(accepted, HasSubstr("Sec-WebSocket-Protocol: dts.v1\r\n"));
  EXPECT_EQ(status_of(answer_to_upgrade(port, "/ws", good, origin, "")), "403");
  EXPECT_EQ(status_of(answer_to_upgrade(port, "/ws", good, origin, "Origin: http://evil.example\r\n")), "403");
  EXPECT_EQ(status_of(answer_to_upgrade(port, "/ws", good, origin, "Origin: null\r\n")), "403");
  EXPECT_EQ(status_of(answer_to_upgrade(port, "/ws", good, "http://127", "https://127")), "403");
  EXPECT_EQ(status_of(answer_to_upgrade(port, "/ws", good + "X-Nobody: 1\r\n")), "401");
  EXPECT_EQ(status_of(answer_to_upgrade(port, "/other", good)), "404");
  EXPECT_EQ(status_of(answer_to_upgrade(port, "/ws", good, "dts.v1", "dts.v2")), "400");
  for (const char* key : {"", "x", "dGhlIHNhbXBsZQ==", "dGhlIHNhbXBsZSBub25jZSE=", "dGhlIHNhbXBsZSBub25j?Q=="}) {
    EXPECT_EQ(status_of(answer_to_upgrade(port, "/ws", good, "dGhlIHNhbXBsZSBub25jZQ==", key)), "400") << key;
  }
  const std::string old = answer_to_upgrade(port, "/ws", good, "Version: 13", "Version: 8");
  EXPECT_EQ(status_of(old), "426");
  EXPECT_THAT(old, HasSubstr("Sec-WebSocket-Version: 13\r\n"));
}

TEST(WebSocketServer, CompressionIsNotAccepted) {
  const ServedGateway gateway;

  const std::string answer = answer_to_upgrade(
      gateway.port(), "/ws", upgrade_headers(gateway.port()) + "Sec-WebSocket-Extensions: permessage-deflate; client_max_window_bits\r\n");

  EXPECT_EQ(status_of(answer), "101");
  EXPECT_THAT(answer, Not(HasSubstr("Extensions")));
  EXPECT_EQ(close_code_after(gateway, frame(kFin | kRsv1 | kBinary, "bomb")), 1002U);
}

TEST(WebSocketServer, WhatIsNoBinaryMessageClosesWithTheCodeThatSaysWhy) {
  const ServedGateway gateway(with_limits({.websocket_message_bytes = 1000}));
  const std::string half(600, 'x');

  EXPECT_EQ(close_code_after(gateway, frame(kFin | kText, "text")), 1003U);
  EXPECT_EQ(close_code_after(gateway, frame(kFin | kBinary, std::string(1001, 'x'))), 1009U);
  EXPECT_EQ(close_code_after(gateway, frame(kBinary, half) + frame(kContinuation, half)), 1009U);
  EXPECT_EQ(close_code_after(gateway, std::string("\x82\xff\x7f\xff\xff\xff\xff\xff\xff\xff\0\0\0\0", 14)), 1009U);
  EXPECT_EQ(close_code_after(gateway, frame(kFin | kContinuation, "x")), 1002U);
  EXPECT_EQ(close_code_after(gateway, frame(kFin | 0x3, "x")), 1002U);
  EXPECT_EQ(close_code_after(gateway, frame(kPing, "x")), 1002U);
  EXPECT_EQ(close_code_after(gateway, frame(kFin | kPing, std::string(126, 'x'))), 1002U);
  EXPECT_EQ(close_code_after(gateway, std::string("\x82\x01x", 3)), 1002U);  // not masked
  EXPECT_EQ(close_code_after(gateway, frame(kFin | kBinary, "boom")), 1011U);
}

TEST(WebSocketServer, TheLargestMessageIsFine) {
  const ServedGateway gateway;
  auto client = open_websocket(gateway.port());
  ASSERT_TRUE(client.has_value());

  client->send(frame(kFin | kBinary, std::string(65536, 'x')));

  EXPECT_EQ(read_frame(*client)->payload.size(), 65536U);
}

TEST(WebSocketServer, AMessageWithoutAnEndIsEnded) {
  ServedGateway gateway(with_limits({.websocket_message_bytes = 1000, .write_timeout = milliseconds(200)}));
  auto client = open_websocket(gateway.port());
  ASSERT_TRUE(client.has_value());
  std::string empty_fragments;
  for (int i = 0; i < 1000; ++i) empty_fragments += frame(kContinuation, "");

  client->send(frame(kBinary, ""));
  int rounds = 0;
  while (rounds < 20000 && client->send(empty_fragments)) ++rounds;

  EXPECT_LT(rounds, 20000);
  EXPECT_EQ(read_close_code(*client), 1008U);
  EXPECT_TRUE(ServedGateway::eventually([&] { return gateway.tabs() == 0 && gateway.statistics().connections == 0; }));
}

TEST(WebSocketServer, FloodsAreClosed) {
  const ServedGateway gateway(with_limits({.messages_per_s = 5.0}));
  std::string messages;
  std::string pings;
  for (int i = 0; i < 30; ++i) {
    messages += frame(kFin | kBinary, "x");
    pings += frame(kFin | kPing, "x");
  }

  EXPECT_EQ(close_code_after(gateway, messages), 1008U);
  EXPECT_EQ(close_code_after(gateway, pings), 1008U);
}

TEST(WebSocketServer, APeerThatDoesNotReadIsLeftByTimeOrBySize) {
  for (const auto& [limits, floods] : {std::pair(ServerLimits{.write_timeout = milliseconds(300)}, 6), {{.unsent_bytes = 3U << 20U}, 20}}) {
    ServedGateway gateway(with_limits(limits));
    auto client = open_websocket(gateway.port(), {}, 4096);
    ASSERT_TRUE(client.has_value());

    for (int i = 0; i < floods; ++i) client->send(frame(kFin | kBinary, "flood"));

    EXPECT_TRUE(ServedGateway::eventually([&] { return gateway.tabs() == 0 && gateway.statistics().connections == 0; }));
  }
}

TEST(WebSocketServer, APeerThatIsDeadIsNoticedByItsMissingPong) {
  ServedGateway gateway(with_limits({.idle_timeout = milliseconds(400)}));
  auto client = open_websocket(gateway.port());
  ASSERT_TRUE(client.has_value());

  const auto ping = read_frame(*client);

  ASSERT_TRUE(ping.has_value());
  EXPECT_EQ(ping->opcode, kPing);
  EXPECT_TRUE(ServedGateway::eventually([&] { return gateway.tabs() == 0; }));
}

/// Whether a peer that answers five pings is still there, with a gateway that waits for a pong for half of `idle_timeout`.
bool stays_by_pongs(std::chrono::milliseconds idle_timeout) {
  ServedGateway gateway(with_limits({.idle_timeout = idle_timeout}));
  auto client = open_websocket(gateway.port());
  for (int i = 0; client && i < 5; ++i) {
    const auto ping = read_frame(*client);
    if (!ping.has_value() || ping->opcode != kPing) return false;
    client->send(frame(kFin | kPong, ping->payload));
  }
  return gateway.tabs() == 1;
}

TEST(WebSocketServer, APeerThatAnswersPingsStays) {
  // On a busy machine this peer may be late itself: then it is given more time.
  bool stays = false;
  for (auto idle_timeout = milliseconds(500); !stays && idle_timeout < std::chrono::seconds(20); idle_timeout *= 4) {
    stays = stays_by_pongs(idle_timeout);
  }

  EXPECT_TRUE(stays);
}

TEST(WebSocketServer, ATabMayCloseFromInsideAMessage) {
  ServedGateway gateway;
  auto client = open_websocket(gateway.port());
  ASSERT_TRUE(client.has_value());

  client->send(frame(kFin | kBinary, "close"));
  const auto last_words = read_frame(*client);
  const auto close = read_frame(*client);
  client->send(frame(kFin | kClose, close ? close->payload : ""));

  ASSERT_TRUE(last_words && close);
  EXPECT_EQ(last_words->payload, "close");
  EXPECT_EQ(close->close_code(), 4000U);
  EXPECT_EQ(close->payload.substr(2), "as you like");
  EXPECT_TRUE(client->is_closed_within(RawClient::kMostWait));
  client->end_of_sending();
  EXPECT_TRUE(ServedGateway::eventually([&] { return gateway.tabs() == 0; }));
}

TEST(WebSocketServer, ACloseThatIsNotAnsweredEndsAllTheSame) {
  ServedGateway gateway;
  auto client = open_websocket(gateway.port());
  ASSERT_TRUE(client.has_value());

  client->send(frame(kFin | kBinary, "close"));

  EXPECT_TRUE(ServedGateway::eventually([&] { return gateway.tabs() == 0; }));
}

TEST(WebSocketServer, StopSaysThatItGoesAway) {
  ServedGateway gateway;
  auto client = open_websocket(gateway.port());
  ASSERT_TRUE(client.has_value() && ServedGateway::eventually([&] { return gateway.tabs() == 1; }));

  gateway.stop();

  EXPECT_EQ(read_close_code(*client), 1001U);
  EXPECT_TRUE(ServedGateway::eventually([&] { return gateway.tabs() == 0; }));
}

}  // namespace
}  // namespace dts::gateway::test
