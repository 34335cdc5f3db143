// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "usb/emulator/sample_feed.h"

namespace dts::emulator {

/// How the codes of a scan are packed.
struct MccPacking {
  std::size_t codes_per_packet = 32;
  std::size_t endpoint_bytes = 64;  ///< wMaxPacketSize.
  bool stalls_on_overrun = true;    ///< Else the data simply stop.
};

/// A scan of an MCC device on its way to the cable: FIFO, packets, overrun, halt. Codes that are left when the scan is stopped wait
/// in the FIFO until they are read or cleared, and stand before those of the next scan.
class MccScan {
 public:
  MccScan(Source source, std::size_t input_count) : feed_(std::move(source), input_count) {}

  /// `clock` nullptr: its own.
  void start(FeedSetup setup, Converter converter, const MccPacking& packing, Faults& faults, const ScanClock* clock, std::int64_t now_ns);
  void stop(std::int64_t now_ns);
  /// A code stays in the FIFO, though no scan runs.
  void leave(std::uint16_t code);
  void clear_fifo() noexcept;
  void clear_errors() noexcept { is_overrun_ = false; }
  void clear_halt() noexcept { is_halted_ = false; }
  void power_up() noexcept;
  /// As if the FIFO were full.
  void overrun(std::int64_t now_ns);

  [[nodiscard]] bool is_running() const noexcept { return feed_.is_running(); }
  [[nodiscard]] bool is_overrun() const noexcept { return is_overrun_; }
  [[nodiscard]] SampleFeed& feed() noexcept { return feed_; }

  [[nodiscard]] std::optional<Packet> take_packet(std::int64_t now_ns);
  [[nodiscard]] std::int64_t next_packet_ns(std::int64_t now_ns) const noexcept;

 private:
  [[nodiscard]] bool is_paused(std::int64_t now_ns) noexcept;
  [[nodiscard]] bool strikes(std::uint64_t& fault_at, std::size_t codes) const noexcept;
  [[nodiscard]] std::optional<Packet> next_packet(std::int64_t now_ns);
  [[nodiscard]] std::optional<Packet> last_packet(std::int64_t now_ns);
  [[nodiscard]] Packet pack(std::size_t codes);
  void damage(Packet& packet, std::uint64_t first_code, std::size_t codes);

  SampleFeed feed_;
  Faults* faults_ = nullptr;
  MccPacking packing_;
  std::vector<std::uint8_t> left_over_;
  std::int64_t paused_until_ns_ = 0;
  bool is_overrun_ = false;
  bool is_halted_ = false;
};

/// Offset binary: the code of a converter with `bits` bits, range +-`range_v` and an error that slope and offset correct.
[[nodiscard]] std::uint16_t to_code(double volts, double range_v, unsigned bits, float slope, float offset) noexcept;

}  // namespace dts::emulator
