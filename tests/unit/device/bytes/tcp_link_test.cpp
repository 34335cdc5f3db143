// SPDX-License-Identifier: Apache-2.0
#include "device/bytes/tcp_link.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include "unit/device/bytes/link_ends.h"

namespace dts::device::bytes {
namespace {

using core::ErrorCode;
using testing::HasSubstr;

/// A board that listens at a port of 127.0.0.1 that the system chose.
class Board {
 public:
  Board() : listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(::bind(listener_.get(), reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(::listen(listener_.get(), 4), 0);
    EXPECT_EQ(::getsockname(listener_.get(), reinterpret_cast<sockaddr*>(&address), &size), 0);
    port_ = ntohs(address.sin_port);
  }
  [[nodiscard]] std::uint16_t port() const noexcept { return port_; }
  [[nodiscard]] core::Descriptor accept() const { return core::Descriptor(::accept(listener_.get(), nullptr, nullptr)); }

 private:
  core::Descriptor listener_;
  std::uint16_t port_ = 0;
};

TEST(TcpLink, BytesGoBothWays_ThenTheBoardCloses) {
  core::SystemClock clock;
  const Board board;
  auto link = connect_tcp("127.0.0.1", board.port(), clock);
  ASSERT_TRUE(link->open().has_value());
  {
    const core::Descriptor peer = board.accept();
    ASSERT_EQ(::send(peer.get(), "scan", 4, 0), 4);
    EXPECT_EQ(read_text(*link, 4), "scan");
    ASSERT_TRUE(link->write(as_bytes("start")).has_value());
    std::array<char, 5> heard{};
    ASSERT_EQ(::recv(peer.get(), heard.data(), heard.size(), MSG_WAITALL), 5);
    EXPECT_EQ(std::string(heard.data(), heard.size()), "start");
    ASSERT_EQ(::send(peer.get(), "tail", 4, 0), 4);
  }
  EXPECT_EQ(read_text(*link, 4), "tail");
  EXPECT_EQ(read_to_end(*link), ReadEnd::Lost);
  EXPECT_THAT(link->why_lost(), HasSubstr("the board closed the connection"));
  link->close();
  ASSERT_TRUE(link->open().has_value()) << "it connects again";
  EXPECT_EQ(link->why_lost(), "");
}

TEST(TcpLink, BoardThatVanishes_WriteFailsWithoutASignal) {
  core::SystemClock clock;
  const Board board;
  auto link = connect_tcp("127.0.0.1", board.port(), clock);
  ASSERT_TRUE(link->open().has_value());
  {
    const core::Descriptor peer = board.accept();
    const linger now{.l_onoff = 1, .l_linger = 0};
    ASSERT_EQ(::setsockopt(peer.get(), SOL_SOCKET, SO_LINGER, &now, sizeof now), 0);  // closing resets the connection
  }
  EXPECT_EQ(read_to_end(*link), ReadEnd::Lost);
  const auto written = link->write(as_bytes("x"));
  ASSERT_FALSE(written.has_value());
  EXPECT_EQ(written.error().code, ErrorCode::DeviceGone);
}

TEST(TcpLink, BoardThatReadsNothing_WriteEndsWithTimeout) {
  core::SystemClock clock;
  const Board board;
  auto link = connect_tcp("127.0.0.1", board.port(), clock);
  ASSERT_TRUE(link->open().has_value());
  const auto written = link->write(as_bytes(std::string(64'000'000, 'x')));
  ASSERT_FALSE(written.has_value());
  EXPECT_EQ(written.error().code, ErrorCode::Timeout);
}

TEST(TcpLink, NobodyListens_IsNotFound) {
  core::SystemClock clock;
  std::uint16_t port = 0;
  {
    const Board gone;
    port = gone.port();
  }
  const auto refused = connect_tcp("127.0.0.1", port, clock)->open();
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::NotFound);
  EXPECT_THAT(refused.error().what, HasSubstr("nothing listens at this port"));
}

TEST(TcpLink, BoardThatDoesNotAnswer_EndsAfterTheLimit) {
  core::SystemClock clock;
  const core::Descriptor full(::socket(AF_INET, SOCK_STREAM, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ASSERT_EQ(::bind(full.get(), reinterpret_cast<sockaddr*>(&address), size), 0);
  ASSERT_EQ(::listen(full.get(), 0), 0);
  ASSERT_EQ(::getsockname(full.get(), reinterpret_cast<sockaddr*>(&address), &size), 0);
  std::vector<std::unique_ptr<ByteLink>> links;
  core::Status opened;
  for (int i = 0; i < 4 && opened; ++i) {  // the queue of the listener is full after one or two
    links.push_back(connect_tcp("127.0.0.1", ntohs(address.sin_port), clock));
    opened = links.back()->open();
  }
  ASSERT_FALSE(opened.has_value());
  EXPECT_THAT(opened.error().what, HasSubstr("no answer within 3 s"));
}

TEST(HostPort, Name_IsRefused_BecauseAskingForItsAddressMayTakeAMinute) {
  EXPECT_THAT(split_host_port("board.local:5000").error().what, HasSubstr("\"board.local\" is neither an address in digits nor localhost"));
  EXPECT_EQ(split_host_port("localhost:5000").value().host, "127.0.0.1");
}

TEST(HostPort, AddressesWithPorts) {
  EXPECT_EQ(split_host_port("192.168.1.20:65535").value().port, 65535);
  EXPECT_EQ(split_host_port("[fd00::20]:5000").value().host, "fd00::20");
  for (const char* wrong : {"", "board", "board:", "10.0.0.1:0", "10.0.0.1:65536", "10.0.0.1:5000x", ":5000", "fd00::20:5000", "[]:5000",
                            "10.0.0.1:-1", "board.local:5000", "board:5000", "10.0.0.256:5000"}) {
    const auto refused = split_host_port(wrong);
    ASSERT_FALSE(refused.has_value()) << wrong;
    EXPECT_EQ(refused.error().code, ErrorCode::InvalidArgument);
    EXPECT_THAT(refused.error().hint, HasSubstr("HOST:PORT"));
  }
}

}  // namespace
}  // namespace dts::device::bytes
