// SPDX-License-Identifier: Apache-2.0
// The whole relay without a daemon: what main() runs.
#include "relay/relay.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <pthread.h>
#include <signal.h>
#include <spdlog/sinks/ringbuffer_sink.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <thread>

#include "core/descriptor.h"
#include "core/process.h"
#include "unit/relay/relay_fixture.h"

namespace dts::relay {
namespace {

/// Another program's listener on this address; null if the relay listens there.
std::unique_ptr<core::Descriptor> listen_at(const std::string& address) {
  auto listener = std::make_unique<core::Descriptor>(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_port = htons(static_cast<std::uint16_t>(std::stoi(address.substr(address.rfind(':') + 1))));
  place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int on = 1;
  ::setsockopt(listener->get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (::bind(listener->get(), reinterpret_cast<const sockaddr*>(&place), sizeof place) != 0 || ::listen(listener->get(), 4) != 0) {
    return nullptr;
  }
  return listener;
}

class RelayTest : public RelayFixture {
 protected:
  RelayTest() {
    for (int number = 0; number < kSpareKeys; ++number) EXPECT_TRUE(store_->add(access::key_for(spare(number), v1::ROLE_VIEWER)));
    settings_.key_directory = directory();
    settings_.local = {.control = local(), .data = local()};
    settings_.network = {.control = free_address(), .data = free_address()};
    thread_ = std::jthread([this] {
      core::block_signals({SIGTERM, SIGINT});
      has_ended_well_ = run_relay(settings_, clock_, core::Log(std::make_shared<spdlog::logger>("test", sink_))).has_value();
    });
  }
  ~RelayTest() override { stop(); }
  void stop() {
    if (!thread_.joinable()) return;
    ::pthread_kill(thread_.native_handle(), SIGTERM);
    thread_.join();
  }
  [[nodiscard]] static std::string spare(int number) { return "spare-" + std::to_string(number); }
  static std::string free_address() {
    zmq::context_t context;
    zmq::socket_t probe(context, zmq::socket_type::pair);
    probe.bind("tcp://127.0.0.1:*");
    return probe.get(zmq::sockopt::last_endpoint);
  }
  std::ptrdiff_t logged(const std::string& text) {
    return std::ranges::count_if(sink_->last_formatted(),
                                 [&text](const std::string& line) { return line.find(text) != std::string::npos; });
  }
  /// A client of one of the two addresses.
  struct Visitor {
    zmq::socket_t socket;
    zmq::socket_t events;
    [[nodiscard]] bool comes_in() {
      return eventually([this] { return !receive_now(events).empty(); });
    }
  };
  Visitor visitor(const access::KeyPair& key, const std::string& address) {
    const bool is_data = address == settings_.network->data;
    zmq::socket_t socket = unconnected_client(is_data ? zmq::socket_type::sub : zmq::socket_type::dealer, key);
    zmq::socket_t events = watch(socket, ZMQ_EVENT_HANDSHAKE_SUCCEEDED);
    socket.connect(address);
    return {std::move(socket), std::move(events)};
  }

  static constexpr int kSpareKeys = 20;
  Settings settings_;
  std::shared_ptr<spdlog::sinks::ringbuffer_sink_mt> sink_ = std::make_shared<spdlog::sinks::ringbuffer_sink_mt>(200);
  bool has_ended_well_ = false;
  std::jthread thread_;
};

/// The other program listens as soon as the relay has closed its listeners, unless the relay is faster: then another key is revoked.
TEST_F(RelayTest, RevokedKey_EndsAllConnections_AndAnAddressThatAnotherProgramTookIsBoundAgain) {
  struct Way {
    std::string address;
    Visitor eve;
    std::unique_ptr<core::Descriptor> other{};
  };
  std::array ways{Way{settings_.network->control, visitor(eve_, settings_.network->control)},
                  Way{settings_.network->data, visitor(eve_, settings_.network->data)}};
  for (Way& way : ways) ASSERT_TRUE(way.eve.comes_in());
  const auto is_all_taken = [&ways] { return std::ranges::all_of(ways, [](const Way& way) { return way.other != nullptr; }); };
  for (int number = 0; number < kSpareKeys && !is_all_taken(); ++number) {
    ASSERT_TRUE(store_->revoke(spare(number)));
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::milliseconds(500);
    while (!is_all_taken() && std::chrono::steady_clock::now() < deadline) {
      for (Way& way : ways) {
        if (!way.other) way.other = listen_at(way.address);
      }
    }
  }
  ASSERT_TRUE(is_all_taken());
  for (Way& way : ways) {
    const auto failed = logged("other machines cannot connect");
    EXPECT_TRUE(eventually([&] {
      clock_.advance_ns(core::kNanosecondsPerSecond);  // until the relay tries again
      return logged("other machines cannot connect") > failed;
    }));
    way.other.reset();
    while (!receive_now(way.eve.events).empty()) continue;
    clock_.advance_ns(core::kNanosecondsPerSecond);
    EXPECT_TRUE(way.eve.comes_in());
  }
  stop();
  EXPECT_TRUE(has_ended_well_);
}

}  // namespace
}  // namespace dts::relay
