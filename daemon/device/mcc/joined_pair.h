// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "core/clock.h"
#include "device/device.h"
#include "device/device_entry.h"

namespace dts::device::mcc {

/// The two units of a pair, each a separate Device.
struct PairParts {
  std::unique_ptr<Device> master;  ///< Drives the SYNC wire.
  std::unique_ptr<Device> slave;   ///< Scans at each pulse; delivers nothing before the first pulse.
  /// Stops a scan that the open master may still run; fails if the master does not confirm.
  std::function<core::Status()> confirm_master_stopped;
  DeviceDescription description;  ///< The channels of the master, then those of the slave.
};

/// Two USB-1608FS-Plus with connected SYNC pins, as one device with up to 16 simultaneous channels: those of the first unit, then
/// those of the second, with consecutive numbers.
///
///     slave:  armed, a scan per pulse of SYNC   --+
///                                                 +-- same scan index = same instant --> one block
///     master: paces, pulses SYNC per scan       --+
///
/// The slave starts first, after the master has confirmed that it does not scan, and stops last: a pulse of an earlier scan would shift
/// one unit against the other, and the data would not show it. Host time is that of the master. A fault of one unit is a fault of the pair.
/// A unit that stays behind the other is also a fault: reads begin with each unit alternately; if the other unit is always late, it has
/// lost pulses or packets.
class JoinedPair final : public Device {
 public:
  JoinedPair(PairParts parts, core::Clock& clock);
  ~JoinedPair() override;
  JoinedPair(const JoinedPair&) = delete;
  JoinedPair& operator=(const JoinedPair&) = delete;

  [[nodiscard]] const DeviceDescription& describe() const noexcept override { return description_; }
  [[nodiscard]] DeviceState state() const noexcept override { return state_.load(std::memory_order_acquire); }  // pairs with move_to
  [[nodiscard]] core::Result<core::Rate> exact_rate(core::Rate wanted) const override;
  [[nodiscard]] DeviceReport report() const override;
  [[nodiscard]] bool has_arrived() noexcept override;
  [[nodiscard]] core::Status open() override;
  [[nodiscard]] core::Result<core::Rate> start(const StartOptions& options) override;
  [[nodiscard]] ReadResult read(core::Block& block, std::int64_t deadline_ns) noexcept override;
  void interrupt() noexcept override;
  [[nodiscard]] core::Status set_sync_output(bool is_high) override;
  core::Status stop() override;
  core::Status close() override;

 private:
  /// One unit, and its scans that the other unit has not delivered yet.
  struct Half {
    std::unique_ptr<Device> device;
    core::Block fresh;                                ///< Scans of one `read`.
    core::Block waiting;                              ///< The next scans to deliver.
    ReadOutcome outcome = ReadOutcome::NotStreaming;  ///< Outcome of the last `read`.
    std::int64_t shortest_wait_ns = 0;                ///< Shortest wait in this window for scans that the other half had already.
    int waits = 0;
  };

  void move_to(DeviceState state) noexcept { state_.store(state, std::memory_order_release); }  // pairs with state()
  [[nodiscard]] core::Status silence_master();
  [[nodiscard]] core::Result<core::Rate> start_halves(const StartOptions& options);
  [[nodiscard]] std::optional<ReadResult> collect(Half& half, std::size_t scans, std::int64_t deadline_ns) noexcept;
  void append(Half& half) noexcept;
  void drop_front(Half& half, std::size_t scans) noexcept;
  void merge(core::Block& block, std::size_t scans) noexcept;
  [[nodiscard]] std::optional<ReadResult> collect_both(std::size_t wanted, std::int64_t deadline_ns) noexcept;
  void note_wait(Half& half, std::int64_t wait_ns) noexcept;
  [[nodiscard]] bool is_one_behind(std::size_t scans) noexcept;
  void begin_window() noexcept;
  [[nodiscard]] bool is_one_alone(std::int64_t now_ns) noexcept;
  [[nodiscard]] ReadResult cause_of(const ReadResult& fault) noexcept;
  [[nodiscard]] ReadResult end_with(const ReadResult& seen) noexcept;

  Half master_;
  Half slave_;
  std::function<core::Status()> confirm_master_stopped_;
  core::Clock& clock_;
  DeviceDescription description_;
  std::atomic<DeviceState> state_{DeviceState::Closed};
  std::atomic<bool> is_interrupted_{false};
  core::Rate rate_;
  std::size_t max_block_scans_ = 0;
  std::int64_t lag_limit_ns_ = 0;
  std::int64_t wait_limit_ns_ = 0;
  std::uint64_t window_scans_ = 0;
  bool is_slave_first_ = false;
  std::atomic<bool> has_missed_pulses_{false};  ///< The scan ended because only the master had scans.
  std::optional<ReadResult> broken_;            ///< Result that `read` repeats until `stop`.
  std::optional<std::int64_t> alone_since_ns_;  ///< Time since which only one unit delivers.
};

/// Creates "mcc:1608fs-plus-pair?serial=A&second_serial=B": options of the first unit, and of the second with the prefix "second_".
/// No unit needs to be present. Fails with Unsupported if there is no USB.
[[nodiscard]] core::Result<std::unique_ptr<Device>> create_pair(const DeviceUri& uri, const DeviceContext& context);

}  // namespace dts::device::mcc
