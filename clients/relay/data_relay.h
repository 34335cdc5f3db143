// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <thread>
#include <zmq.hpp>

#include "libdts/data_source.h"
#include "relay/remote_listener.h"

namespace dts::relay {

/// Passes everything that dtsd publishes to subscribers on other machines, byte for byte.
///
///     dtsd's Unix socket --DataSource--> this thread --XPUB, CURVE--> subscribers
///
/// The local subscription is always the same one, to everything: no remote subscriber changes anything in dtsd. dtsd repeats its retained
/// messages (status, newest events of sessions and devices) for every new subscription, so this class renews a part of its own subscription
/// when a remote one is new, at most ten times a second. Thread: its own, "data".
class DataRelay {
 public:
  /// Binds `remote` and starts the thread. `local`: dtsd's data endpoint; connects to it in the background, and again whenever it was away.
  [[nodiscard]] static core::Result<std::unique_ptr<DataRelay>> start(zmq::context_t& context, const RemoteEndpoint& remote,
                                                                      const std::string& local);
  DataRelay(const DataRelay&) = delete;
  DataRelay& operator=(const DataRelay&) = delete;

  /// Ends all connections soon: a key was revoked. Thread: any.
  void drop_peers() noexcept { is_drop_due_.store(true, std::memory_order_release); }  // pairs with run()
  /// Returns true if nothing listens, because the address could not be bound again. Thread: any.
  [[nodiscard]] bool is_down() const noexcept { return is_down_.load(std::memory_order_relaxed); }

 private:
  using Clock = std::chrono::steady_clock;

  DataRelay(RemoteListener listener, std::unique_ptr<client::DataSource> source);
  void run(const std::stop_token& stop);
  [[nodiscard]] bool pass_messages();
  void note_interruptions();
  void send(const client::RawMessage& message);
  [[nodiscard]] bool take_subscriptions();
  void renew_subscription();

  RemoteListener listener_;
  std::unique_ptr<client::DataSource> source_;
  std::atomic<bool> is_drop_due_{false};
  std::atomic<bool> is_down_{false};
  bool is_renewal_due_ = false;
  std::uint64_t interruptions_ = 0;
  Clock::time_point renewed_at_{};
  std::jthread thread_;  // last: ends before the other members are destroyed
};

}  // namespace dts::relay
