// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ctl/commands.h"
#include "dts/error.h"
#include "dts/subscriber.h"

namespace dts::ctl {

/// Consecutive scans of the stream that a calibration uses.
struct FeedBlock {
  std::vector<std::vector<double>> columns;  ///< Per channel; all of the same length, at least 1.
  std::vector<std::uint8_t> quality;         ///< Per channel: bits of v1::Quality.
  bool follows_loss = false;                 ///< Scans before this block are missing.
};

/// Source of scans for a calibration: the daemon, or a test's script.
class Feed {
 public:
  virtual ~Feed() = default;
  /// Returns the next scans; nothing if none arrived in time. Fails if the daemon was restarted or the device is silent for too long.
  [[nodiscard]] virtual client::Result<std::optional<FeedBlock>> next() = 0;
  /// Drops all scans received so far. Fails if the daemon was restarted meanwhile.
  [[nodiscard]] virtual client::Result<void> discard() = 0;
};

/// One stream of one rig of a running daemon.
class LiveFeed final : public Feed {
 public:
  /// `where`: the daemon whose data socket is used; `channels`: names, in the desired order. Does not connect yet.
  [[nodiscard]] static client::Result<LiveFeed> open(const Target& where, const std::string& rig, const std::string& stream,
                                                     std::vector<std::string> channels);

  [[nodiscard]] client::Result<std::optional<FeedBlock>> next() override;
  [[nodiscard]] client::Result<void> discard() override;

 private:
  LiveFeed(client::Subscriber subscriber, std::string endpoint, std::string topic, std::vector<std::string> channels)
      : subscriber_(std::move(subscriber)), endpoint_(std::move(endpoint)), topic_(std::move(topic)), channels_(std::move(channels)) {}

  [[nodiscard]] client::Result<std::optional<FeedBlock>> receive(std::chrono::milliseconds timeout);
  [[nodiscard]] client::Result<FeedBlock> convert(const client::Block& block);
  [[nodiscard]] client::Result<void> check_silence() const;

  client::Subscriber subscriber_;
  std::string endpoint_;
  std::string topic_;
  std::vector<std::string> channels_;
  std::uint32_t segment_ = 0;
  bool has_begun_ = false;
  bool is_broken_ = false;
  std::chrono::steady_clock::time_point received_at_ = std::chrono::steady_clock::now();
};

}  // namespace dts::ctl
