// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/clock.h"
#include "core/host_time.h"
#include "device/device.h"
#include "device/device_entry.h"
#include "device/nidaqmx/daqmx_library.h"

namespace dts::device::nidaqmx {

struct NiOptions {
  std::string uri;
  std::string name;                   ///< Name in NI's tools: "Dev1".
  std::vector<std::size_t> channels;  ///< Analogue inputs in scan order.
  std::int32_t terminal = api::kTerminalRse;
  double range_v = 10.0;  ///< Requested range, +- this value; the device uses its next larger range.
  std::string trigger;    ///< "PFI0": starts the first scan of the device object; empty: every scan starts at once.
  std::string library = kDefaultLibrary;
};

/// Any device that NI-DAQmx supports on this computer. NI's library owns the USB transfers and the buffer; this class handles states,
/// time and errors. The library reports the true rate only for a task that is set up. So `exact_rate` returns the wanted rate, and `start`
/// fails if the device would run at another rate; the error contains that rate.
class NiDaqmx final : public Device {
 public:
  NiDaqmx(NiOptions options, core::Clock& clock);
  ~NiDaqmx() override;
  NiDaqmx(const NiDaqmx&) = delete;
  NiDaqmx& operator=(const NiDaqmx&) = delete;

  [[nodiscard]] const DeviceDescription& describe() const noexcept override { return description_; }
  [[nodiscard]] DeviceState state() const noexcept override { return state_.load(std::memory_order_acquire); }  // pairs with move_to
  [[nodiscard]] core::Result<core::Rate> exact_rate(core::Rate wanted) const override;
  [[nodiscard]] DeviceReport report() const override;
  [[nodiscard]] core::Status open() override;
  [[nodiscard]] core::Result<core::Rate> start(const StartOptions& options) override;
  [[nodiscard]] ReadResult read(core::Block& block, std::int64_t deadline_ns) noexcept override;
  void interrupt() noexcept override;
  [[nodiscard]] core::Status set_sync_output(bool is_high) override;
  core::Status stop() override;
  core::Status close() override;

 private:
  void move_to(DeviceState state) noexcept { state_.store(state, std::memory_order_release); }  // pairs with state()
  [[nodiscard]] core::Status create_task();
  [[nodiscard]] core::Status set_up(const StartOptions& options);
  [[nodiscard]] core::Status check_rate_of_task(core::Rate promised);
  [[nodiscard]] core::Status failed(std::int32_t status, const std::string& call) const;
  core::Status clear_task();

  [[nodiscard]] std::size_t fetch(std::size_t wanted, std::int64_t deadline_ns) noexcept;
  void note_error(std::int32_t status) noexcept;
  void fill(core::Block& block, std::size_t count) noexcept;
  [[nodiscard]] bool waits_for_trigger() const noexcept { return !options_.trigger.empty() && !has_ever_scanned_; }
  [[nodiscard]] ReadResult report_trouble() noexcept;

  NiOptions options_;
  core::Clock& clock_;
  DeviceDescription description_;
  std::atomic<DeviceState> state_{DeviceState::Closed};
  std::atomic<bool> is_interrupted_{false};
  std::atomic<std::int32_t> read_error_{0};  ///< Error that ended the last scan; 0: none.
  mutable std::mutex report_mutex_;
  DeviceReport report_;

  std::unique_ptr<const DaqmxLibrary> library_;
  DaqmxLibrary::Task task_ = nullptr;
  std::size_t max_block_scans_ = 0;
  std::vector<double> values_;     ///< Values in the order of NI's library: scan after scan.
  std::uint64_t next_ = 0;         ///< First scan of the next block.
  bool has_ever_scanned_ = false;  ///< Not reset by `open`: only the first scan waits for a trigger.
  core::HostTime host_time_;
  ReadResult trouble_{ReadOutcome::Scans, {}};
};

/// Reads channels, terminal, range_v, trigger and library.
[[nodiscard]] core::Result<NiOptions> read_ni_options(const DeviceUri& uri);
/// Creates "ni:Dev1", for the registry.
[[nodiscard]] core::Result<std::unique_ptr<Device>> create_ni_daqmx(const DeviceUri& uri, const DeviceContext& context);

}  // namespace dts::device::nidaqmx
