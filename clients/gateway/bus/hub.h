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

#include "gateway/access/identity.h"
#include "gateway/bus/bus_reader.h"
#include "gateway/bus/carried.h"
#include "gateway/bus/command_pool.h"
#include "gateway/bus/tab_queue.h"
#include "gateway/http/tab.h"
#include "gateway/http/token_bucket.h"

namespace dts::gateway {

class HubTab;

/// Between the bus and the tabs: every message to those that want it, states also to those that come late.
/// Thread: io. Outlives its tabs.
class Hub {
 public:
  /// `want` tells the reader what all tabs together want.
  Hub(boost::asio::io_context& io, CommandPool& commands, std::function<void(std::vector<std::string>)> want, std::string version);
  ~Hub();
  Hub(const Hub&) = delete;
  Hub& operator=(const Hub&) = delete;

  void take(const BusItem& item);
  [[nodiscard]] std::unique_ptr<Tab> open_tab(const Identity& identity, TabConnection& connection);

  /// The daemon's newest status; nullptr while it says nothing of itself, even when data of it go on arriving.
  [[nodiscard]] CarriedPointer status(std::chrono::steady_clock::time_point now = std::chrono::steady_clock::now()) const;
  /// For all tabs, also those that are closed.
  [[nodiscard]] TabQueue::Dropped dropped() const;

  /// For tabs: what they want has changed; they are gone.
  void wishes_changed(HubTab& tab);
  void close_tab(HubTab& tab);

 private:
  /// How often in a second the reader is told at most, but for a burst: each time costs it and the daemon as much as there are topics.
  static constexpr double kTellings_hz = 5.0;
  void keep(const CarriedPointer& message);
  void tell_wishes();
  void tell_wishes_later();

  boost::asio::io_context& io_;
  CommandPool& commands_;
  std::function<void(std::vector<std::string>)> want_;
  std::string version_;
  v1::Link link_;
  boost::asio::steady_timer timer_;  ///< Runs while wishes wait to be told.
  TokenBucket tellings_{kTellings_hz};
  bool is_telling_later_ = false;
  std::set<HubTab*> tabs_;
  TabQueue::Dropped dropped_for_closed_;  ///< For tabs that are closed.
  std::set<std::string> wishes_;                    ///< As told last.
  std::chrono::steady_clock::time_point told_status_{};
  std::uint64_t instance_id_ = 0;                   ///< Of the daemon that said what is retained.
  std::map<std::string, CarriedPointer> retained_;  ///< By topic; as many as the daemon's rigs have states.
};

}  // namespace dts::gateway
