// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "dts/error.h"
#include "dts/v1/gateway.pb.h"
#include "gateway/bus/carried.h"

namespace dts::gateway {

using BusItem = std::variant<CarriedPointer, v1::Link>;

/// Reads the daemon's data socket on its own thread ("bus") and passes all messages on in order. Reports when the daemon falls silent and
/// when it is back.
class BusReader {
 public:
  /// `on_item` is called on the reader's thread.
  [[nodiscard]] static client::Result<std::unique_ptr<BusReader>> start(const std::string& endpoint, std::function<void(BusItem)> on_item);
  ~BusReader();
  BusReader(const BusReader&) = delete;
  BusReader& operator=(const BusReader&) = delete;

  /// Sets the topics to read; status and retained events are always read. Thread: any.
  void want(std::vector<std::string> prefixes);

 private:
  class Loop;
  explicit BusReader(std::unique_ptr<Loop> loop);

  std::unique_ptr<Loop> loop_;
  std::jthread thread_;
};

}  // namespace dts::gateway
