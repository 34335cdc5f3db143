// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>

#include <atomic>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <chrono>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "gateway/http/server.h"
#include "gateway/raw_client.h"

namespace dts::gateway::test {

using dts::test::RawClient;
using dts::test::request;
using dts::test::status_of;
using std::chrono::milliseconds;
using ::testing::HasSubstr;
using ::testing::Not;

/// Echoes; "close" closes, "boom" throws, "flood" sends 1 MiB in 64 KiB messages.
class EchoTab : public Tab {
 public:
  EchoTab(TabConnection& connection, std::atomic<int>& alive) : connection_(connection), alive_(alive) { ++alive_; }
  ~EchoTab() override { --alive_; }

  void on_message(std::string_view message) override {
    if (message == "boom") throw std::runtime_error("a bug");
    if (message == "flood") {
      for (int piece = 0; piece < 16; ++piece) connection_.send(std::string(65536, 'x'));
    } else {
      connection_.send(std::string(message));
    }
    if (message == "close") connection_.close(4000, "as you like");
  }

 private:
  TabConnection& connection_;
  std::atomic<int>& alive_;
};

/// A Server on a free port with a thread of its own, and routes that tests can tell apart.
class ServedGateway {
 public:
  explicit ServedGateway(ServerOptions options = {}) {
    options.port = 0;
    auto server = Server::open(io_, options, hooks());
    if (!server) throw std::runtime_error(server.error().what);
    server_ = std::move(*server);
    thread_ = std::jthread([this] { io_.run(); });
  }
  ~ServedGateway() {
    on_io([this] { server_.reset(); });
    work_.reset();
    io_.stop();
    thread_.join();
  }

  [[nodiscard]] std::uint16_t port() const noexcept { return server_->port(); }
  [[nodiscard]] ServerStatistics statistics() {
    ServerStatistics statistics;
    on_io([&] { statistics = server_->statistics(); });
    return statistics;
  }
  void stop() {
    on_io([this] { server_->stop(); });
  }
  [[nodiscard]] int tabs() const noexcept { return tabs_; }
  [[nodiscard]] int files_done() const noexcept { return files_done_; }
  /// Polls until it holds, or too long.
  [[nodiscard]] static bool eventually(const std::function<bool()>& condition) {
    const auto deadline = std::chrono::steady_clock::now() + dts::test::RawClient::kMostWait;
    while (!condition()) {
      if (std::chrono::steady_clock::now() > deadline) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return true;
  }

  std::filesystem::path file{};  ///< Served under /file.

 private:
  void on_io(std::function<void()> call) {
    std::promise<void> done;
    boost::asio::post(io_, [&] {
      call();
      done.set_value();
    });
    done.get_future().wait();
  }

  ServerHooks hooks() {
    return {.handle = [this](HttpRequest request, Respond respond) { handle(std::move(request), std::move(respond)); },
            .admit = [](const HttpRequest& request) -> std::optional<Identity> {
              if (!request.header("x-nobody").empty()) return std::nullopt;
              return Identity{.user = "test", .role = v1::ROLE_VIEWER};
            },
            .open_tab = [this](const Identity&, const Query&, TabConnection& connection) -> std::unique_ptr<Tab> {
              return std::make_unique<EchoTab>(connection, tabs_);
            }};
  }

  void handle(HttpRequest request, Respond respond) {
    if (request.path == "/boom") throw std::runtime_error("a bug");
    if (request.path == "/big") return respond({.body = std::string(8U << 20U, 'b')});
    if (request.path == "/twice") respond({.body = "first"});
    if (request.path == "/file") return respond({.body = FileBody{.path = file, .when_done = [this] { ++files_done_; }}});
    if (request.path == "/same-origin") return respond({.body = request.is_same_origin ? "yes" : "no"});
    respond({.body = request.method + " " + request.path + " " + request.body});
  }

  boost::asio::io_context io_;
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_ = boost::asio::make_work_guard(io_);
  std::unique_ptr<Server> server_;
  std::atomic<int> tabs_ = 0;
  std::atomic<int> files_done_ = 0;
  std::jthread thread_;
};

inline ServerOptions with_limits(const ServerLimits& limits) { return {.limits = limits}; }

}  // namespace dts::gateway::test
