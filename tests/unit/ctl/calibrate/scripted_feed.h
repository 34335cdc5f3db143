// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "ctl/calibrate/feed.h"

namespace dts::ctl {

/// Scans that a test wrote down, in blocks of 10; fails with Timeout when they are used up.
class ScriptedFeed final : public Feed {
 public:
  explicit ScriptedFeed(double noise = 0.001) : noise_(noise) {}

  /// `blocks` blocks that rest at `values`.
  ScriptedFeed& rest(const std::vector<double>& values, int blocks, std::uint8_t quality = 0, bool follows_loss = false) {
    return move(values, values, blocks, quality, follows_loss);
  }
  /// From one to the other in a straight line.
  ScriptedFeed& move(const std::vector<double>& from, const std::vector<double>& to, int blocks, std::uint8_t quality = 0,
                     bool follows_loss = false) {
    std::normal_distribution<double> noise(0.0, 1.0);
    for (int b = 0; b < blocks; ++b) {
      FeedBlock block{.columns = std::vector<std::vector<double>>(from.size()),
                      .quality = std::vector<std::uint8_t>(from.size(), quality),
                      .follows_loss = follows_loss && b == 0};
      for (int i = 0; i < kBlockScans; ++i) {
        const double part = (b * kBlockScans + i) / static_cast<double>(blocks * kBlockScans);
        for (std::size_t c = 0; c < from.size(); ++c)
          block.columns[c].push_back(from[c] + part * (to[c] - from[c]) + noise_ * noise(random_));
      }
      blocks_.push_back(std::move(block));
    }
    return *this;
  }

  [[nodiscard]] client::Result<std::optional<FeedBlock>> next() override {
    if (blocks_.empty()) return client::fail(client::ErrorCode::Timeout, "the script is at its end");
    FeedBlock block = std::move(blocks_.front());
    blocks_.pop_front();
    return std::optional<FeedBlock>(std::move(block));
  }
  [[nodiscard]] client::Result<void> discard() override {
    ++discarded;
    return {};
  }
  [[nodiscard]] bool is_used_up() const { return blocks_.empty(); }

  static constexpr int kBlockScans = 10;
  int discarded = 0;

 private:
  double noise_;
  std::mt19937_64 random_{1};
  std::deque<FeedBlock> blocks_;
};

}  // namespace dts::ctl
