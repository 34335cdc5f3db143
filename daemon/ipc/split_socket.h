// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>

#include "ipc/local_publisher.h"
#include "ipc/xpub_socket.h"

namespace dts::ipc {

/// One DataSocket of two: local subscribers and other machines.
class SplitSocket final : public DataSocket {
 public:
  SplitSocket(std::unique_ptr<LocalPublisher> local, std::unique_ptr<XpubSocket> remote)
      : local_(std::move(local)), remote_(std::move(remote)) {
    local_->watch(remote_->fd());
  }

  /// Local subscribers first: other machines are far away anyway.
  void send(std::string_view topic, const google::protobuf::MessageLite& message) override {
    local_->send(topic, message);
    remote_->send(topic, message);
  }
  [[nodiscard]] bool flush(std::size_t most_peers) override { return local_->flush(most_peers); }
  void expect(std::string_view topic) override { local_->expect(topic); }
  void wait(int bell_fd, int timeout_ms) override {
    local_->wait(bell_fd, remote_->look() ? 0 : timeout_ms);
    remote_->look();
  }
  [[nodiscard]] bool take_subscriptions() override {
    const bool is_local = local_->take_subscriptions();
    return remote_->take_subscriptions() || is_local;
  }
  [[nodiscard]] bool drop_remote_peers() noexcept override { return remote_->drop_remote_peers(); }

 private:
  std::unique_ptr<LocalPublisher> local_;
  std::unique_ptr<XpubSocket> remote_;
};

}  // namespace dts::ipc
