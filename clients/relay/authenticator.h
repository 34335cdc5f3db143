// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>
#include <zmq.hpp>

#include "access/rate_limit.h"
#include "core/clock.h"
#include "core/result.h"
#include "relay/fresh_keys.h"

namespace dts::relay {

/// Decides for libzmq which clients may connect (ZeroMQ RFC 27, ZAP). Accepts a CURVE client whose public key is in the store, and sets
/// that key as its "User-Id". Rejects all others. libzmq asks for every CURVE server socket of the context.
/// Thread: its own, "access".
class Authenticator {
 public:
  /// Starts the thread. Call it before a CURVE server socket is bound. `context`, `keys` and `clock` must outlive this object.
  [[nodiscard]] static core::Result<std::unique_ptr<Authenticator>> start(zmq::context_t& context, FreshKeys& keys, core::Clock& clock);
  Authenticator(const Authenticator&) = delete;
  Authenticator& operator=(const Authenticator&) = delete;

  [[nodiscard]] std::uint64_t accepted_total() const noexcept { return accepted_total_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t refused_total() const noexcept { return refused_total_.load(std::memory_order_relaxed); }

 private:
  Authenticator(zmq::socket_t socket, FreshKeys& keys, core::Clock& clock);
  void run(const std::stop_token& stop);
  void answer(const std::vector<zmq::message_t>& request);

  zmq::socket_t socket_;
  FreshKeys& keys_;
  core::Clock& clock_;
  access::RateLimit handshakes_;
  std::atomic<std::uint64_t> accepted_total_{0};
  std::atomic<std::uint64_t> refused_total_{0};
  std::jthread thread_;  // last: ends before the other members are destroyed
};

}  // namespace dts::relay
