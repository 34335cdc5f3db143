// SPDX-License-Identifier: Apache-2.0
#include "fleet/link/protocol.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "fleet/link/channel.h"

namespace dts::fleet::link {
namespace {

using testing::HasSubstr;
using Kind = Operation::Kind;

/// Parses bytes that arrive `size` at a time. Stops at an error, which becomes the last text.
std::vector<Operation> operations_of(std::string_view bytes, std::size_t size) {
  Parser parser;
  std::vector<Operation> found;
  for (std::size_t begin = 0; begin < bytes.size(); begin += size) {
    parser.append(bytes.substr(begin, size));
    while (true) {
      auto operation = parser.next();
      if (!operation) {
        found.push_back({.kind = Kind::Error, .text = "failed: " + operation.error().what});
        return found;
      }
      if (!*operation) break;
      found.push_back(std::move(**operation));
    }
  }
  return found;
}

TEST(Parser, OperationsInPiecesOfAnySize_AreTheSame) {
  const std::string bytes =
      "INFO {\"max_payload\":5}\r\nPING\r\nMSG a.b 7 3\r\n\r\nx\r\nMSG a.b 8 inbox.1 0\r\n\r\nPONG\r\n+OK\r\n"
      "HMSG inbox.2 9 16 16\r\nNATS/1.0 503\r\n\r\n\r\nHMSG c 7 reply 18 20\r\nNATS/1.0\r\nA: b\r\n\r\nhi\r\n"
      "-ERR 'Authorization Violation'\r\n";
  for (std::size_t size = 1; size <= bytes.size(); ++size) {
    const auto found = operations_of(bytes, size);
    ASSERT_EQ(found.size(), 9U) << size;
    EXPECT_EQ(found[0].kind, Kind::Info);
    EXPECT_EQ(found[0].text, "{\"max_payload\":5}");
    EXPECT_EQ(found[1].kind, Kind::Ping);
    EXPECT_EQ(found[2].kind, Kind::Message);
    EXPECT_EQ(found[2].letter.data, "\r\nx");
    EXPECT_EQ(found[2].subscription, 7U);
    EXPECT_EQ(found[2].letter.reply, "");
    EXPECT_EQ(found[3].letter.data, "");
    EXPECT_EQ(found[3].letter.reply, "inbox.1");
    EXPECT_EQ(found[4].kind, Kind::Pong);
    EXPECT_EQ(found[5].kind, Kind::Ok);
    EXPECT_EQ(found[6].kind, Kind::Message);
    EXPECT_EQ(found[6].subscription, 9U);
    EXPECT_TRUE(found[6].letter.has_no_listener);
    EXPECT_EQ(found[7].kind, Kind::Message);
    EXPECT_EQ(found[7].letter.data, "hi");
    EXPECT_FALSE(found[7].letter.has_no_listener);
    EXPECT_EQ(found[7].letter.reply, "reply");
    EXPECT_EQ(found[8].kind, Kind::Error);
    EXPECT_EQ(found[8].text, "Authorization Violation");
  }
}

TEST(Parser, WrongBytes_AreAnError) {
  for (const char* wrong :
       {"MSG a 1 99999999999999999999\r\n", "MSG a 1 8388609\r\n", "MSG a 1 -1\r\n", "MSG a 1\r\n", "MSG a x 1\r\n", "MSG a 1 r r r 1\r\n",
        "HMSG a 1 5 4\r\n", "HMSG a 1 4\r\n", "HMSG a 1 x 4\r\n", "GET / HTTP/1.1\r\n", "\r\n", "MSG \r\n"}) {
    const auto found = operations_of(wrong, 100);
    ASSERT_EQ(found.size(), 1U) << wrong;
    EXPECT_THAT(found[0].text, HasSubstr("failed: the server sends")) << wrong;
  }
  EXPECT_THAT(operations_of(std::string(kLargestLine + 1, 'x'), 1000).back().text, HasSubstr("a line without an end"));
}

TEST(InfoOfJson, WrongJson_IsAnError) {
  for (const char* wrong : {"", "{", "[]", "{}", "{\"max_payload\":\"1\"}", "{\"max_payload\":-1}"})
    EXPECT_FALSE(info_of_json(wrong)) << wrong;
  EXPECT_EQ(info_of_json("{\"max_payload\":18446744073709551615,\"nonce\":5}").value().max_payload, kLargestMessage);
}

TEST(IsSubject, TextThatWouldBeAnotherOperation_IsNone) {
  EXPECT_TRUE(is_subject("dts.v1.*.beat"));
  for (const char* wrong : {"", "a b", "a\r\nPUB x 0", "a\tb", "a\x7f"}) EXPECT_FALSE(is_subject(wrong)) << wrong;
  EXPECT_FALSE(is_subject(std::string(1025, 'a')));
}

TEST(AddressOf, Servers) {
  EXPECT_EQ(address_of("tls://centre.example.org:4222").value().host, "centre.example.org");
  EXPECT_EQ(address_of("tls://[::1]:4222").value().host, "::1");
  EXPECT_EQ(address_of("nats://127.0.0.1:1").value().port, "1");
  for (const char* wrong : {"tls://centre", "tls://:4222", "tls://centre:", "tls://centre:http", "http://centre:1", "centre:1"})
    EXPECT_FALSE(address_of(wrong)) << wrong;
}

}  // namespace
}  // namespace dts::fleet::link
