// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/clock.h"
#include "pipeline/rig_config.h"

namespace dts::fault {

inline constexpr const char* kDevice = "sim:floor?seed=7";

/// The shipped floor with 16 sensors (config/rigs/floor16-sim.toml) at 1500 Hz: as text, and as the daemon reads it.
[[nodiscard]] std::string floor16_text();
[[nodiscard]] pipeline::RigConfig floor16_rig();
/// The shipped floor with 4 sensors at 100 Hz.
[[nodiscard]] pipeline::RigConfig floor4_rig();

/// The machine's clock, some times as fast: sessions of seconds take a fraction of one. Thread: any.
class AcceleratedClock final : public core::Clock {
 public:
  explicit AcceleratedClock(double factor) : factor_(factor), origin_ns_(system_.now_ns()) {}
  [[nodiscard]] std::int64_t now_ns() const noexcept override {
    return origin_ns_ + static_cast<std::int64_t>(static_cast<double>(system_.now_ns() - origin_ns_) * factor_);
  }
  void sleep_until_ns(std::int64_t deadline_ns) noexcept override {
    system_.sleep_until_ns(origin_ns_ + static_cast<std::int64_t>(static_cast<double>(deadline_ns - origin_ns_) / factor_));
  }

 private:
  core::SystemClock system_;
  double factor_;
  std::int64_t origin_ns_;
};

}  // namespace dts::fault
