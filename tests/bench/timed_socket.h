// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>

#include "bench/peer_protocol.h"
#include "core/clock.h"
#include "dts/v1/stream.pb.h"
#include "ipc/data_socket.h"

namespace dts::bench {

/// A data socket with a stopwatch: how long each send call takes, and how old the newest scan is when it begins.
/// Thread: one at a time; the figures may be read once the rig and the publish thread have ended.
class TimedSocket final : public ipc::DataSocket {
 public:
  struct Figures {
    Percentiles send;
    Percentiles age;
    explicit Figures(std::size_t expected) : send(expected), age(expected) {}
  };
  /// Messages before scan `first_scan` do not count. `figures` outlives the socket.
  TimedSocket(std::unique_ptr<ipc::DataSocket> socket, std::uint64_t first_scan, core::Rate rate, const core::Clock& clock,
              Figures& figures)
      : socket_(std::move(socket)), first_scan_(first_scan), rate_(rate), clock_(clock), figures_(figures) {}

  [[nodiscard]] bool is_wanted(std::string_view topic) override { return socket_->is_wanted(topic); }
  void send(std::string_view topic, const google::protobuf::MessageLite& message) override {
    const auto* block = dynamic_cast<const v1::StreamBlock*>(&message);
    const std::int64_t before_ns = clock_.now_ns();
    socket_->send(topic, message);
    if (block == nullptr || block->first_scan() < first_scan_) return;
    figures_.send.add_ns(clock_.now_ns() - before_ns);
    figures_.age.add_ns(before_ns - block->host_time_ns() - rate_.time_ns({block->scan_count() - 1}));
  }
  [[nodiscard]] bool flush(std::size_t most_peers) override { return socket_->flush(most_peers); }
  void wait(int bell_fd, int timeout_ms) override { socket_->wait(bell_fd, timeout_ms); }
  [[nodiscard]] bool take_subscriptions() override { return socket_->take_subscriptions(); }

 private:
  std::unique_ptr<ipc::DataSocket> socket_;
  std::uint64_t first_scan_;
  core::Rate rate_;
  const core::Clock& clock_;
  Figures& figures_;
};

}  // namespace dts::bench
