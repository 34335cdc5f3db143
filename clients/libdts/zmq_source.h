// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <zmq.hpp>

#include "data_source.h"

namespace dts::client {

/// A SUB socket of libzmq: for endpoints of other machines.
class ZmqSource final : public DataSource {
 public:
  /// Throws zmq::error_t if the endpoint cannot be used.
  explicit ZmqSource(const SourceOptions& options);

  void subscribe(const std::string& prefix) override { socket_.set(zmq::sockopt::subscribe, prefix); }
  void unsubscribe(const std::string& prefix) override { socket_.set(zmq::sockopt::unsubscribe, prefix); }
  [[nodiscard]] std::optional<RawMessage> take() override;
  [[nodiscard]] Waited wait(std::chrono::milliseconds timeout) override;

 private:
  zmq::context_t context_{1};
  zmq::socket_t socket_;
  zmq::message_t topic_;
  zmq::message_t body_;
};

}  // namespace dts::client
