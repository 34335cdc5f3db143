// SPDX-License-Identifier: Apache-2.0
#include "cli/progress.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "cli/table.h"

namespace dts::cli {
namespace {

constexpr std::chrono::seconds kPatience{2};
constexpr std::chrono::milliseconds kRedraw{100};
constexpr std::size_t kBarColumns = 20;

}  // namespace

Progress::Progress(Console& console, std::string what, std::function<Time()> now)
    : console_(console), what_(std::move(what)), now_(std::move(now)), begun_(now_()), drawn_(begun_) {}

Progress::~Progress() {
  if (ticker_.joinable()) {
    ticker_.request_stop();
    ticker_.join();
  }
  if (columns_drawn_ > 0) console_.talk << '\r' << std::string(columns_drawn_, ' ') << '\r' << std::flush;
}

void Progress::report(double fraction) {
  if (!std::isfinite(fraction)) return;
  const std::lock_guard lock(mutex_);
  fraction_ = std::clamp(fraction, 0.0, 1.0);
  draw();
}

void Progress::tick() {
  const std::lock_guard lock(mutex_);
  draw();
}

void Progress::tick_by_itself() {
  if (!console_.is_talk_terminal) return;
  ticker_ = std::jthread([this](const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (!end_.wait_for(lock, stop, kRedraw, [&] { return stop.stop_requested(); })) draw();
  });
}

void Progress::draw() {
  if (!console_.is_talk_terminal) return;
  const Time now = now_();
  if (now - begun_ < kPatience || (columns_drawn_ > 0 && now - drawn_ < kRedraw)) return;
  drawn_ = now;
  const auto full = static_cast<std::size_t>(fraction_ * kBarColumns);
  const std::string percent = decimal(std::floor(fraction_ * 100.0), 0);
  const std::string line = what_ + "  [" + std::string(full, '#') + std::string(kBarColumns - full, '.') + "]  " +
                           std::string(3 - std::min<std::size_t>(3, percent.size()), ' ') + percent + " %  " +
                           std::to_string(std::chrono::duration_cast<std::chrono::seconds>(now - begun_).count()) + " s";
  console_.talk << '\r' << line << std::flush;
  columns_drawn_ = width(line);
}

}  // namespace dts::cli
