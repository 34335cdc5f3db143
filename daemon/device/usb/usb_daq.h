// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/clock.h"
#include "core/host_time.h"
#include "device/device.h"
#include "device/usb/bulk_stream.h"
#include "device/usb/daq_driver.h"
#include "device/usb/daq_options.h"
#include "device/usb/scan_reader.h"
#include "device/usb/usb_bus.h"

namespace dts::device::usb {

/// Any USB DAQ: a driver, which knows the protocol of one family, and everything that is the same for all families.
///
///     BulkStream --chunks--> ScanReader: driver.unpack --codes--> ScanBuffer --volts, quality, host time--> block
///                                                                  | marker, start check, rate check: each failure ends the segment
///
/// If the data are no longer reliable, the stream is Broken: `stop` and `start` make a new stream. Data are never re-aligned.
class UsbDaq final : public Device {
 public:
  UsbDaq(std::unique_ptr<DaqDriver> driver, DaqOptions options, UsbBus& bus, core::Clock& clock);
  ~UsbDaq() override;
  UsbDaq(const UsbDaq&) = delete;
  UsbDaq& operator=(const UsbDaq&) = delete;

  [[nodiscard]] const DeviceDescription& describe() const noexcept override { return driver_->describe(); }
  [[nodiscard]] DeviceState state() const noexcept override { return state_.load(std::memory_order_acquire); }  // pairs with move_to
  [[nodiscard]] core::Result<core::Rate> exact_rate(core::Rate wanted) const override { return driver_->exact_rate(wanted); }
  [[nodiscard]] DeviceReport report() const override;
  [[nodiscard]] bool has_arrived() noexcept override;
  [[nodiscard]] core::Status open() override;
  [[nodiscard]] core::Result<core::Rate> start(const StartOptions& options) override;
  [[nodiscard]] ReadResult read(core::Block& block, std::int64_t deadline_ns) noexcept override;
  [[nodiscard]] bool has_more() noexcept override { return state() == DeviceState::Streaming && reader_->has_more(); }
  void interrupt() noexcept override;
  [[nodiscard]] core::Status set_sync_output(bool is_high) override;
  /// Fails if the device did not confirm the end of its scan; the state is Open even then, or Gone if the transfers did not end.
  core::Status stop() override;
  core::Status close() override;
  /// Stops the device's scan once more; fails if the device may still be scanning. Needs state Open.
  [[nodiscard]] core::Status confirm_stopped();

 private:
  void move_to(DeviceState state) noexcept { state_.store(state, std::memory_order_release); }  // pairs with state()
  [[nodiscard]] core::Result<std::vector<UsbUnit>> candidates();
  [[nodiscard]] std::string what_is_there_instead();
  [[nodiscard]] core::Status open_unit(const UsbUnit& unit);
  [[nodiscard]] bool is_abandoned(const UsbUnit& unit) const;
  [[nodiscard]] core::Result<std::vector<double>> read_single();
  [[nodiscard]] core::Status launch(const StreamShape& shape, core::Rate rate);
  [[nodiscard]] core::Result<core::Rate> bring_up(const StartOptions& options, core::Rate rate);
  void prepare_host_time(core::Rate rate);
  [[nodiscard]] core::Status end_scan() noexcept;
  [[nodiscard]] core::Status end_stream() noexcept;
  void add_check(DeviceCheck check);
  [[nodiscard]] DeviceCheck describe_transfer_errors() const;
  void keep_findings();
  void free_abandoned() noexcept;

  std::unique_ptr<DaqDriver> driver_;
  DaqOptions options_;
  UsbBus& bus_;
  core::Clock& clock_;
  std::atomic<DeviceState> state_{DeviceState::Closed};
  std::atomic<bool> is_interrupted_{false};
  std::uint64_t seen_arrivals_ = 0;
  bool must_use_large_packets_ = false;  ///< The device has overrun since it was opened.
  bool has_ever_scanned_ = false;        ///< Not reset by `open`: only the first scan waits for a trigger.
  /// Serialises control requests; locked during the whole of start and stop, never while scans flow. Lock it before `report_mutex_`.
  std::mutex request_mutex_;
  /// Protects everything that `report` reads; locked for short times only. Changes of `port_` and `reader_` need both mutexes.
  mutable std::mutex report_mutex_;
  std::unique_ptr<UsbPort> port_;
  std::unique_ptr<BulkStream> stream_;
  std::unique_ptr<ScanReader> reader_;
  /// A port and its stream whose transfers did not end in time. It keeps interface 0 of the unit claimed.
  struct Abandoned {
    std::unique_ptr<UsbPort> port;
    std::unique_ptr<BulkStream> stream;
  };
  std::vector<Abandoned> abandoned_;
  TransferErrors transfer_errors_{};
  DeviceReport report_;                    ///< Filled by `open`.
  std::vector<DeviceCheck> scan_checks_;   ///< Of the last `start` and, after `stop`, of its scan.
  std::vector<DeviceCheck> break_checks_;  ///< Of the last Broken scan, kept until `close`: a restart must not hide the reason.
  core::HostTime host_time_;               ///< Kept from scan to scan, because it knows the drift of the device's clock.
  std::optional<core::Rate> host_time_rate_;
};

}  // namespace dts::device::usb
