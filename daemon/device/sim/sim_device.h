// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/clock.h"
#include "core/spsc_ring.h"
#include "device/device.h"
#include "device/sim/fault.h"
#include "device/sim/pacer.h"
#include "device/sim/scene.h"
#include "sim/daq.h"

namespace dts::device::sim {

inline constexpr double kMinimumRateHz = 1.0;
inline constexpr double kMaximumRateHz = 20'000.0;

/// Parts of a simulated device.
struct SimParts {
  DeviceDescription description;
  std::size_t converted_channels = 0;  ///< The first channels pass the converter, the others are exact.
  dts::sim::Daq daq;
  double clock_error_ppm = 0.0;
  Fault fault;
  std::unique_ptr<Scene> scene;
};

/// A simulated device that behaves like hardware: its own clock, a bounded buffer, faults.
///
///     clock --Pacer--> scans due --(buffer: 4 s)--> read: Scene --> Daq --> block
///
/// Scans are computed when they are read: values depend only on the scan number since start, never on the time of the read. If the
/// reader is more than four seconds late, the buffer overruns: all scans up to now are lost and counted.
class SimDevice final : public Device {
 public:
  SimDevice(SimParts parts, core::Clock& clock);
  ~SimDevice() override;
  SimDevice(const SimDevice&) = delete;
  SimDevice& operator=(const SimDevice&) = delete;
  SimDevice(SimDevice&&) = delete;
  SimDevice& operator=(SimDevice&&) = delete;

  [[nodiscard]] const DeviceDescription& describe() const noexcept override { return parts_.description; }
  [[nodiscard]] DeviceState state() const noexcept override { return state_.load(std::memory_order_acquire); }  // pairs with move_to
  [[nodiscard]] core::Result<core::Rate> exact_rate(core::Rate wanted) const override;
  [[nodiscard]] DeviceReport report() const override { return {.serial = parts_.description.serial}; }
  [[nodiscard]] core::Status open() override;
  [[nodiscard]] core::Result<core::Rate> start(const StartOptions& options) override;
  [[nodiscard]] ReadResult read(core::Block& block, std::int64_t deadline_ns) noexcept override;
  [[nodiscard]] bool has_more() noexcept override;
  void interrupt() noexcept override;
  void hear(const Cue& cue) noexcept override;
  [[nodiscard]] core::Status set_sync_output(bool is_high) override;
  core::Status stop() override;
  core::Status close() override;

 private:
  static constexpr std::size_t kMostCues = 16;

  void move_to(DeviceState state) noexcept { state_.store(state, std::memory_order_release); }  // pairs with state()
  [[nodiscard]] std::uint64_t wait_for(std::uint64_t scans, std::int64_t deadline_ns) noexcept;
  [[nodiscard]] ReadResult read_scans(core::Block& block, std::uint64_t break_at, std::int64_t deadline_ns) noexcept;
  [[nodiscard]] ReadResult read_break(std::int64_t deadline_ns) noexcept;
  [[nodiscard]] ReadResult continue_at(std::uint64_t scan, const core::Gap& gap) noexcept;
  [[nodiscard]] ReadResult unplugged() noexcept;
  [[nodiscard]] bool is_break_ahead() const noexcept;
  void fill(core::Block& block, std::size_t count) noexcept;
  void compute_scan(std::uint64_t scan) noexcept;
  void pass_cues(std::uint64_t scan, double time_s) noexcept;

  SimParts parts_;
  core::Clock& clock_;
  std::atomic<DeviceState> state_{DeviceState::Closed};
  std::atomic<bool> is_interrupted_{false};
  core::SpscRing<Cue> cues_{kMostCues};

  Pacer pacer_;
  FaultWindow window_;
  bool was_unplugged_ = false;
  std::int64_t plugged_in_at_ns_ = 0;
  std::size_t max_block_scans_ = 0;
  std::uint64_t buffer_scans_ = 0;
  std::uint64_t next_ = 0;           ///< First scan of the next block, counted since start.
  std::uint64_t segment_start_ = 0;  ///< Scan with index 0 in the current segment, counted since start.
  std::vector<double> row_;          ///< One scan, all channels.
  double stuck_value_ = 0.0;
  bool is_stuck_ = false;
};

}  // namespace dts::device::sim
