// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <optional>

#include "served_gateway.h"
#include "unit/libdts/fake_daemon.h"

namespace dts::gateway::test {
namespace {

using ::testing::EndsWith;

std::string answer_to(std::uint16_t port, const std::string& bytes) {
  RawClient client(port);
  client.send(bytes);
  return client.read_answer();
}

TEST(HttpServer, AnswersAndKeepsTheConnection) {
  const ServedGateway gateway;
  RawClient client(gateway.port());

  client.send(request(gateway.port(), "GET /a%20b?x=1"));
  const std::string first = client.read_answer();
  client.send(request(gateway.port(), "POST /p", "Content-Length: 4\r\n", "body"));
  const std::string second = client.read_answer();

  EXPECT_THAT(first, EndsWith("\r\n\r\nGET /a b "));
  EXPECT_THAT(first, HasSubstr("Content-Security-Policy: "));
  EXPECT_THAT(second, EndsWith("\r\n\r\nPOST /p body"));
}

TEST(HttpServer, PipelinedRequestsAreAnsweredInOrder) {
  const ServedGateway gateway;
  RawClient client(gateway.port());

  client.send(request(gateway.port(), "GET /1") +
              request(gateway.port(), "POST /2", "Transfer-Encoding: chunked\r\n", "2\r\nhi\r\n0\r\n\r\n") +
              request(gateway.port(), "GET /3", "Connection: close\r\n"));

  EXPECT_THAT(client.read_answer(), EndsWith("GET /1 "));
  EXPECT_THAT(client.read_answer(), EndsWith("POST /2 hi"));
  EXPECT_THAT(client.read_to_end(), EndsWith("GET /3 "));
}

TEST(HttpServer, Http10WithoutKeepAliveIsClosed) {
  const ServedGateway gateway;
  RawClient client(gateway.port());

  client.send("GET / HTTP/1.0\r\nHost: localhost\r\n\r\n");

  EXPECT_THAT(client.read_to_end(), HasSubstr("Connection: close"));
}

const std::string kHost = "Host: localhost\r\n";
const std::string kUpgrade =
    "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n";
struct Refused {
  const char* status;
  std::string bytes;
};
const std::vector<Refused> kRefused{
    Refused{"400", "GET / HTTP/1.1\r\n\r\n"},
    Refused{"400", "GET / HTTP/1.0\r\n\r\n"},
    Refused{"400", "GET / HTTP/1.1\r\nHost:\r\n\r\n"},
    Refused{"400", "GET / HTTP/1.1\r\n" + kHost + kHost + "\r\n"},
    Refused{"421", "GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n"},
    Refused{"421", "GET / HTTP/1.1\r\nHost: localhost.evil.example:80\r\n\r\n"},
    Refused{"421", "GET / HTTP/1.1\r\nHost: 127.0.0.2\r\n\r\n"},
    Refused{"400", "GET http://localhost/ HTTP/1.1\r\n" + kHost + "\r\n"},
    Refused{"400", "GET /../etc/passwd HTTP/1.1\r\n" + kHost + "\r\n"},
    Refused{"400", "GET /%2e%2e/x HTTP/1.1\r\n" + kHost + "\r\n"},
    Refused{"405", "DELETE / HTTP/1.1\r\n" + kHost + "\r\n"},
    Refused{"405", "OPTIONS * HTTP/1.1\r\n" + kHost + "\r\n"},
    Refused{"405", "CONNECT localhost:22 HTTP/1.1\r\n" + kHost + "\r\n"},
    Refused{"501", "BREW / HTTP/1.1\r\n" + kHost + "\r\n"},
    Refused{"400", "GET / HTTP/1.1\r\n" + kHost + "Content-Length: 5\r\n\r\nhello"},
    Refused{"400", "HEAD / HTTP/1.1\r\n" + kHost + "Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n"},
    Refused{"400", "POST / HTTP/1.1\r\n" + kHost + "Content-Length: 4\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n"},
    Refused{"400", "POST / HTTP/1.1\r\n" + kHost + "Content-Length: 4\r\nContent-Length: 5\r\n\r\nabcde"},
    Refused{"400", "POST / HTTP/1.1\r\n" + kHost + "Content-Length: -1\r\n\r\n"},
    Refused{"400", "POST / HTTP/1.1\r\n" + kHost + "Transfer-Encoding : chunked\r\n\r\n0\r\n\r\n"},
    Refused{"501", "POST / HTTP/1.1\r\n" + kHost + "Transfer-Encoding: gzip\r\n\r\n"},
    Refused{"400", "POST / HTTP/1.1\r\n" + kHost + "Transfer-Encoding: chunked\r\n\r\nzz\r\n"},
    Refused{"403", "POST / HTTP/1.1\r\n" + kHost + "Origin: http://evil.example\r\nContent-Length: 0\r\n\r\n"},
    Refused{"403", "POST / HTTP/1.1\r\n" + kHost + "Origin: null\r\nContent-Length: 0\r\n\r\n"},
    Refused{"431", "GET / HTTP/1.1\r\n" + kHost + "X: " + std::string(9000, 'x') + "\r\n\r\n"},
    Refused{"431", "GET /" + std::string(9000, 'x') + " HTTP/1.1\r\n" + kHost + "\r\n"},
    Refused{"413", "POST / HTTP/1.1\r\n" + kHost + "Content-Length: 99999999999\r\n\r\n"},
    Refused{"413", "POST / HTTP/1.1\r\n" + kHost + "Transfer-Encoding: chunked\r\n\r\n5000\r\n" + std::string(0x5000, 'x') + "\r\n"},
    Refused{"400", "\x16\x03\x01 a TLS client hello\r\n\r\n"},
    Refused{"505", "GET / HTTP/1.2\r\n" + kHost + "\r\n"},
    Refused{"505", "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"},
    Refused{"400", "GET /ws HTTP/1.1\r\n" + kHost + kUpgrade + "Content-Length: 3\r\n\r\nabc"},
    Refused{"404", "GET /other HTTP/1.1\r\n" + kHost + kUpgrade + "\r\n"},
    Refused{"403", "GET /ws HTTP/1.1\r\n" + kHost + kUpgrade + "\r\n"},
    Refused{"400", "GET /ws HTTP/1.1\r\n" + kHost + kUpgrade + "Origin: http://localhost\r\nSec-WebSocket-Protocol: dts.v1\r\n\r\n" +
                       std::string("\x82\x80\0\0\0\0", 6)}};

TEST(HttpServer, RefusedRequestIsAnsweredOnceAndTheConnectionEnds) {
  ServedGateway gateway;
  std::uint64_t count = 0;
  for (const auto& [status, bytes] : kRefused) {
    RawClient client(gateway.port());
    client.send(bytes + "GET /smuggled HTTP/1.1\r\nHost: localhost\r\n\r\n");
    client.end_of_sending();
    const std::string all = client.read_to_end();

    EXPECT_EQ(status_of(all), status) << bytes;
    EXPECT_THAT(all, HasSubstr("Connection: close")) << bytes;
    EXPECT_THAT(all, Not(HasSubstr("smuggled"))) << bytes;
    EXPECT_EQ(gateway.statistics().refused_requests_total, ++count) << bytes;
  }
}

TEST(HttpServer, TellsTheRoutesWhetherAPageOfOursAsks) {
  const ServedGateway gateway;
  const std::string ours = "Origin: http://127.0.0.1:" + std::to_string(gateway.port()) + "\r\n";

  EXPECT_THAT(answer_to(gateway.port(), request(gateway.port(), "POST /same-origin", ours)), EndsWith("yes"));
  EXPECT_THAT(answer_to(gateway.port(), request(gateway.port(), "POST /same-origin")), EndsWith("no"));
  EXPECT_THAT(answer_to(gateway.port(), request(gateway.port(), "GET /same-origin", "Origin: http://evil.example\r\n")), EndsWith("no"));
}

TEST(HttpServer, OneConnectionTooMany_TheOldestThatIsNotLoggedInIsClosed) {
  ServedGateway gateway(with_limits({.connections = {.per_address = 3}}));
  std::vector<RawClient> clients;
  const auto visit = [&](const std::string& headers) {
    clients.emplace_back(gateway.port());
    clients.back().send(request(gateway.port(), "GET /", headers));
    EXPECT_EQ(status_of(clients.back().read_answer()), "200");
  };
  visit("Cookie: dts_token=of a login\r\n");
  for (int stranger = 0; stranger < 4; ++stranger) visit("");

  EXPECT_EQ(clients[1].read_to_end(), "");
  EXPECT_EQ(gateway.statistics().refused_connections_total, 1U);
  clients[0].send(request(gateway.port(), "GET /"));
  EXPECT_EQ(status_of(clients[0].read_answer()), "200") << "the user's is served on";
}

TEST(HttpServer, TabsOfAUser_AreLimited) {
  const ServedGateway gateway(with_limits({.connections = {.per_user = 1}}));
  const std::string upgrade =
      kUpgrade + "Origin: http://127.0.0.1:" + std::to_string(gateway.port()) + "\r\nSec-WebSocket-Protocol: dts.v1\r\n";
  RawClient first(gateway.port());
  first.send(request(gateway.port(), "GET /ws", upgrade));
  EXPECT_EQ(status_of(first.read_answer()), "101");

  EXPECT_EQ(status_of(answer_to(gateway.port(), request(gateway.port(), "GET /ws", upgrade))), "503");
}

TEST(HttpServer, ARequestThatTricklesInIsEndedWhateverItSends) {
  ServedGateway gateway(with_limits({.handshake_timeout = milliseconds(300), .idle_timeout = 10 * RawClient::kMostWait}));
  const auto start = std::chrono::steady_clock::now();
  RawClient client(gateway.port());
  client.send("GET / HTTP/1.1\r\n");

  bool is_closed = false;
  while (!is_closed && std::chrono::steady_clock::now() - start < RawClient::kMostWait) {
    is_closed = client.is_closed_within(milliseconds(50)) || !client.send("X");
  }

  EXPECT_TRUE(is_closed);
  EXPECT_GE(std::chrono::steady_clock::now() - start, milliseconds(300));
  EXPECT_TRUE(ServedGateway::eventually([&] { return gateway.statistics().connections == 0; }));
}

TEST(HttpServer, SilenceEndsTheConnection) {
  ServedGateway gateway(with_limits({.idle_timeout = milliseconds(200)}));
  RawClient never(gateway.port());
  std::optional<RawClient> once;
  ASSERT_TRUE(ServedGateway::eventually([&] {  // on a busy machine a request may come later than silence is waited for
    once.emplace(gateway.port());
    once->send(request(gateway.port(), "GET /"));
    return status_of(once->read_answer()) == "200";
  }));

  EXPECT_TRUE(never.is_closed_within(RawClient::kMostWait));
  EXPECT_TRUE(once->is_closed_within(RawClient::kMostWait));
}

TEST(HttpServer, APeerThatDoesNotReadIsLeft) {
  ServedGateway gateway(with_limits({.write_timeout = milliseconds(300)}));
  RawClient client(gateway.port(), 4096);
  client.send(request(gateway.port(), "GET /big"));

  EXPECT_TRUE(
      ServedGateway::eventually([&] { return gateway.statistics().connections_total == 1 && gateway.statistics().connections == 0; }));
}

TEST(HttpServer, TooManyRequestsOnOneConnectionAreRefused) {
  const ServedGateway gateway(with_limits({.requests_per_s = 2.0}));
  RawClient client(gateway.port());
  std::string many;
  for (int i = 0; i < 20; ++i) many += request(gateway.port(), "GET /");

  client.send(many);
  const std::string all = client.read_to_end();

  EXPECT_THAT(all, HasSubstr("HTTP/1.1 429 Too Many Requests"));
  EXPECT_THAT(all, HasSubstr("Retry-After: 1"));
}

TEST(HttpServer, AMistakeInARouteCostsOneAnswer) {
  const ServedGateway gateway;

  EXPECT_EQ(status_of(answer_to(gateway.port(), request(gateway.port(), "GET /boom"))), "500");
  EXPECT_THAT(answer_to(gateway.port(), request(gateway.port(), "GET /twice")), EndsWith("\r\n\r\nfirst"));
  EXPECT_EQ(status_of(answer_to(gateway.port(), request(gateway.port(), "GET /"))), "200");
}

TEST(HttpServer, AFileIsStreamedAndHeadTellsItsSize) {
  const dts::testing::TemporaryDirectory directory;
  const std::string content(300000, 'f');
  std::ofstream(directory.path() / "part.xdf") << content;
  ServedGateway gateway;
  gateway.file = directory.path() / "part.xdf";
  RawClient client(gateway.port());

  client.send(request(gateway.port(), "HEAD /file") + request(gateway.port(), "GET /file", "Connection: close\r\n"));
  const std::string head = client.read_head();
  const std::string all = client.read_to_end();
  std::filesystem::remove(gateway.file);
  const std::string gone = answer_to(gateway.port(), request(gateway.port(), "GET /file"));

  EXPECT_THAT(head, HasSubstr("Content-Length: 300000\r\n"));
  EXPECT_THAT(all, EndsWith("\r\n\r\n" + content));
  EXPECT_EQ(status_of(gone), "404");
  EXPECT_TRUE(ServedGateway::eventually([&] { return gateway.files_done() == 3; }));
}

TEST(HttpServer, AFileIsGivenBackWhenThePeerLeavesEarly) {
  const dts::testing::TemporaryDirectory directory;
  std::ofstream(directory.path() / "part.xdf") << std::string(8U << 20U, 'f');
  ServedGateway gateway;
  gateway.file = directory.path() / "part.xdf";

  {
    RawClient client(gateway.port(), 4096);
    client.send(request(gateway.port(), "GET /file"));
    EXPECT_EQ(status_of(client.read_head()), "200");
  }

  EXPECT_TRUE(ServedGateway::eventually([&] { return gateway.files_done() == 1; }));
}

TEST(HttpServer, StopClosesTheListenerAndIdleConnections) {
  ServedGateway gateway;
  RawClient client(gateway.port());
  client.send(request(gateway.port(), "GET /"));
  ASSERT_EQ(status_of(client.read_answer()), "200");

  gateway.stop();

  EXPECT_TRUE(client.is_closed_within(RawClient::kMostWait));
  EXPECT_FALSE(RawClient(gateway.port()).is_connected());
}

TEST(HttpServer, AddressesThatCannotBeUsedAreExplained) {
  const ServedGateway gateway;
  boost::asio::io_context io;

  const auto no_address = Server::open(io, {.address = "localhost"}, {});
  const auto taken = Server::open(io, {.port = gateway.port()}, {});

  ASSERT_FALSE(no_address.has_value());
  EXPECT_EQ(no_address.error().code, client::ErrorCode::InvalidArgument);
  ASSERT_FALSE(taken.has_value());
  EXPECT_EQ(taken.error().code, client::ErrorCode::Failed);
  EXPECT_NE(taken.error().hint.find("--listen"), std::string::npos);
}

}  // namespace
}  // namespace dts::gateway::test
