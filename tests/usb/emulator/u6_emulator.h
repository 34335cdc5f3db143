// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "usb/emulator/emulated_device.h"
#include "usb/emulator/faults.h"
#include "usb/emulator/sample_feed.h"

namespace dts::emulator {

/// A LabJack U6 as the U6 data sheet (section 5.2, low-level function reference) and the open Exodriver describe it: commands
/// on 0x01, replies on 0x82, stream packets on 0x83. A command with a wrong checksum is answered B8 B8, as the data sheet says.
///
/// A Source of it has 17 inputs: AIN0..13, 14 the temperature (not modelled: any voltage), 15 ground (the emulator makes it 0 V)
/// and 16 the voltage at FIO0; the other digital lines are open and read 1.
class U6Emulator final : public EmulatedDevice {
 public:
  static constexpr std::size_t kInputCount = 17;
  static constexpr std::size_t kGround = 15;
  static constexpr std::size_t kFio0 = 16;
  static constexpr std::size_t kLargeFifoSamples = 984;  ///< With 25 samples per packet; the data sheet says 512 to 984.
  static constexpr std::size_t kSmallFifoSamples = 512;
  static constexpr std::uint64_t kForcedLossScans = 5;  ///< What `Faults::overrun_at_code` discards.

  struct Identity {
    std::uint32_t serial = 360004242;
    bool is_pro = false;
    std::uint8_t firmware_major = 1;
    std::uint8_t firmware_minor = 45;  ///< Below 0.94 data stay in 0x83 after a stop.
  };
  /// What only a U6 can do wrong; codes are counted as in Faults.
  struct Quirks {
    std::uint64_t scan_overlap_at_code = Faults::kNever;                ///< Error 55 from here to the stop (no document says for how long).
    std::size_t reply_bytes = std::numeric_limits<std::size_t>::max();  ///< Replies are cut to this. Stays.
    std::uint64_t reply_to_damage = Faults::kNever;                     ///< This reply, counted from 0, gets a bit turned.
    bool is_discarded_count_wide = false;                               ///< The count of lost scans reaches into bytes 8 and 9. Stays.
    bool has_dummy_scan = true;                                         ///< false: auto-recovery ends without its scan of 0xFFFF. Stays.
  };

  explicit U6Emulator(Source source) : U6Emulator(std::move(source), Identity{}) {}
  U6Emulator(Source source, Identity identity);

  Quirks quirks;

  [[nodiscard]] bool is_streaming() const noexcept { return is_streaming_; }
  [[nodiscard]] std::uint64_t commands() const noexcept { return commands_; }  ///< Received so far.
  /// The code for a voltage at gain index 0..3 (+-10, 1, 0.1, 0.01 V) by this unit's calibration.
  [[nodiscard]] static std::uint16_t code(std::size_t gain, double volts) noexcept;
  /// One code in volts at this gain, above the centre.
  [[nodiscard]] static double step_v(std::size_t gain) noexcept;

  [[nodiscard]] const Descriptors& descriptors() const override { return descriptors_; }
  void power_up(std::int64_t now_ns) override;
  [[nodiscard]] ControlReply control(const Setup& setup, std::span<const std::uint8_t> out_data, std::int64_t now_ns) override;
  void bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  [[nodiscard]] std::optional<Packet> take_packet(std::uint8_t endpoint, std::int64_t now_ns) override;
  void clear_halt(std::uint8_t endpoint) override;
  [[nodiscard]] std::int64_t next_packet_ns(std::int64_t now_ns) const override;

 private:
  using Bytes = std::vector<std::uint8_t>;
  struct Scan {
    std::vector<std::size_t> channels;  ///< As in StreamConfig: 0..15, 193, 194.
    std::vector<std::size_t> gains;
    std::size_t samples_per_packet = 25;
    core::Rate rate;
  };

  void answer(Bytes reply);
  void run_normal(std::span<const std::uint8_t> command, std::int64_t now_ns);
  void run_extended(std::span<const std::uint8_t> command);
  void configure_unit();
  void read_calibration(std::uint8_t block);
  [[nodiscard]] std::uint8_t configure_stream(std::span<const std::uint8_t> command);
  [[nodiscard]] std::uint8_t start_stream(std::int64_t now_ns);
  [[nodiscard]] std::uint8_t stop_stream(std::int64_t now_ns);

  [[nodiscard]] std::optional<Packet> take_stream_packet(std::int64_t now_ns);
  /// The codes of the next packet; `is_corrupt`: one of them is to be damaged on the way.
  [[nodiscard]] std::vector<std::uint16_t> take_samples(bool& is_corrupt);
  [[nodiscard]] std::uint16_t take_code(bool& is_corrupt);
  [[nodiscard]] std::uint64_t available(std::int64_t now_ns) const noexcept;
  [[nodiscard]] Bytes make_packet(std::span<const std::uint16_t> samples, std::uint8_t error, std::uint64_t discarded, std::int64_t now_ns);
  void watch_fifo(std::int64_t now_ns);
  void resume_when_drained(std::int64_t now_ns);
  [[nodiscard]] std::uint16_t convert(std::size_t position, double volts) const noexcept;
  [[nodiscard]] std::size_t fifo_samples() const noexcept;

  Descriptors descriptors_;
  Identity identity_;
  SampleFeed feed_;
  Scan scan_;
  bool is_configured_ = false;
  bool is_streaming_ = false;
  bool is_halted_ = false;
  std::uint64_t commands_ = 0;
  std::uint64_t answers_ = 0;
  std::size_t calibration_bytes_sent_ = 0;
  std::deque<Bytes> replies_;
  std::int64_t paused_until_ns_ = 0;
  std::deque<Bytes> stale_;            ///< Packets that the host did not fetch before the stop.
  std::deque<std::uint16_t> waiting_;  ///< Samples that come before those of the feed.
  std::uint8_t counter_ = 0;
  std::optional<std::uint64_t> keep_until_;  ///< Auto-recovery: samples before this one are sent, later ones are discarded.
  std::uint64_t forced_loss_scans_ = 0;
  bool is_overlapping_ = false;
  std::optional<std::uint64_t> discarded_;  ///< To be reported by the next packet.
};

}  // namespace dts::emulator
