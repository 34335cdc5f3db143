// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/token_bucket.h"
#include "gateway/access/identity.h"
#include "gateway/bus/bus_reader.h"
#include "gateway/bus/carried.h"
#include "gateway/bus/command_pool.h"
#include "gateway/bus/tab_queue.h"
#include "gateway/http/tab.h"

namespace dts::gateway {

class HubTab;

/// Returns the present time of the clock that blocks and events have (host time, ns); 0: not known yet.
using HostClock = std::function<std::int64_t()>;
/// The clock of this machine, for a daemon on it.
[[nodiscard]] std::int64_t own_host_time();

/// Connects the bus and the tabs: passes each message to the tabs that subscribed to it, and retained messages also to later subscribers.
/// Thread: io. Outlives its tabs.
class Hub {
 public:
  /// `commands`: nullptr: all commands are rejected, because the daemon is elsewhere and may only be watched. `want` passes the topics of
  /// all tabs together to the reader.
  Hub(boost::asio::io_context& io, CommandPool* commands, std::function<void(std::vector<std::string>)> want, std::string version,
      HostClock clock = own_host_time);
  ~Hub();
  Hub(const Hub&) = delete;
  Hub& operator=(const Hub&) = delete;

  void handle(const BusItem& item);
  [[nodiscard]] std::unique_ptr<Tab> open_tab(const Identity& identity, TabConnection& connection);

  /// Returns the daemon's newest status; nullptr if no status arrived lately, even if its data still arrive.
  [[nodiscard]] CarriedPointer status(std::chrono::steady_clock::time_point now = std::chrono::steady_clock::now()) const;
  /// Returns the sum over all tabs, including closed ones.
  [[nodiscard]] TabQueue::Dropped dropped() const;

  [[nodiscard]] std::size_t retained_bytes() const noexcept { return retained_bytes_; }
  [[nodiscard]] std::int64_t host_time() const { return clock_(); }
  /// Called by tabs: when their topics changed, and when they close.
  void wishes_changed(HubTab& tab);
  void close_tab(HubTab& tab);

 private:
  /// Most topic updates per second for the reader, apart from a burst: each update costs reader and daemon work in proportion to the
  /// topics.
  static constexpr double kWishSends_hz = 5.0;
  static constexpr std::size_t kMostRetained = 256;
  static constexpr std::size_t kMostRetainedBytes = std::size_t{4} << 20U;
  void keep(const CarriedPointer& message);
  void retain(const CarriedPointer& message);
  void send_wishes();
  void send_wishes_later();

  boost::asio::io_context& io_;
  CommandPool* commands_;
  std::function<void(std::vector<std::string>)> want_;
  std::string version_;
  HostClock clock_;
  v1::Link link_;
  boost::asio::steady_timer timer_;  ///< Runs while changed topics wait to be passed to the reader.
  core::TokenBucket wish_sends_{kWishSends_hz};
  bool is_sending_later_ = false;
  std::set<HubTab*> tabs_;
  TabQueue::Dropped dropped_for_closed_;  ///< Of tabs that are closed.
  std::set<std::string> wishes_;          ///< The topics last passed to the reader.
  std::chrono::steady_clock::time_point status_received_at_{};
  std::uint64_t instance_id_ = 0;                   ///< Of the daemon that sent the retained messages.
  std::map<std::string, CarriedPointer> retained_;  ///< By topic, within the limits above: the daemon of a clinic is not trusted.
  std::size_t retained_bytes_ = 0;
};

}  // namespace dts::gateway
