// SPDX-License-Identifier: Apache-2.0
// A board as the sheet of the sample frames describes it, with faults. It runs on any clock: the caller says what time it is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "device/board/frame_decoder.h"
#include "device/board/frames.h"

namespace dts::test {

/// What a fake board is, and what it does wrong.
struct FakeBoardSetup {
  bool speaks_lines = false;
  std::size_t channels = 4;
  device::board::WireRate rate{100, 1};  ///< Until a START says otherwise.
  std::size_t scans_per_frame = 5;
  bool carries_time = true;
  bool starts_on_command = true;
  bool hears = true;        ///< false: describes itself every 5 s, completely, and takes no commands.
  bool knows_rate = true;   ///< false: says 0/1.
  bool keeps_rate = false;  ///< true: runs `rate` whatever START says.
  double clock_ppm = 0.0;   ///< How much its clock is fast.
  std::string serial = "B0A4D001";
  std::uint8_t version = 1;       ///< Of the frames, as its DESCRIPTOR says.
  float scale = 5.0F / 32767.0F;  ///< Of its channels, as its CHANNELs say.
  int constant_channel = -1;
  int digital_channel = -1;  ///< Has no unit.
  // Lines
  bool has_counter = false;
  unsigned counter_bits = 32;
  bool has_time = false;
  bool has_checksum = false;
  std::string_view separator = ",";
  std::string_view line_end = "\r\n";
  // Faults
  std::optional<double> loses_at_s{};  ///< Since the start of the run: loses `lost_scans`, and says so.
  std::uint32_t lost_scans = 70;
  std::optional<double> silent_at_s{};  ///< Since the start of the run: does nothing any more, until reset.
};

/// The codes of a scan of a fake board show which scan it is: channel 0 has the low 15 bits of the counter, 1 the run, 2 a hash of counter
/// and run, 3 the next 15 bits of the counter; more channels have hashes too.
[[nodiscard]] std::int16_t fake_code(std::uint8_t run, std::uint32_t counter, std::size_t channel) noexcept;
/// Returns the value that dtsd must deliver for a code.
[[nodiscard]] double fake_value(std::int16_t code) noexcept;

class FakeBoard {
 public:
  /// It is reset at `now_ns`.
  explicit FakeBoard(FakeBoardSetup setup, std::int64_t now_ns = 0);

  FakeBoardSetup& setup() noexcept { return setup_; }
  /// The reset button, or the power: it forgets everything but the number of its resets.
  void reset(std::int64_t now_ns);
  /// Makes the scans and frames up to `now_ns`.
  void run_until(std::int64_t now_ns);
  /// Takes bytes of the host.
  void receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns);
  /// When it will do something by itself.
  [[nodiscard]] std::int64_t next_event_ns() const noexcept;
  /// Moves up to `out.size()` bytes to `out` and returns their number.
  [[nodiscard]] std::size_t take(std::span<std::uint8_t> out) noexcept;
  /// Removes what waits to be sent.
  void drop_output() noexcept {
    out_.clear();
    taken_ = 0;
  }
  [[nodiscard]] bool has_output() const noexcept { return taken_ < out_.size(); }

  [[nodiscard]] bool is_streaming() const noexcept { return is_streaming_; }
  [[nodiscard]] std::int64_t run_start_ns() const noexcept { return run_start_ns_; }
  [[nodiscard]] std::uint8_t run() const noexcept { return run_; }
  [[nodiscard]] std::uint32_t counter() const noexcept { return counter_; }
  [[nodiscard]] std::uint64_t scans_made() const noexcept { return scans_made_; }
  /// Continues the counter elsewhere: near its wrap.
  void set_counter(std::uint32_t counter) noexcept {
    first_counter_ = counter;
    counter_ = counter;
  }
  void set_run(std::uint8_t run) noexcept { run_ = run; }
  /// Makes no scans for the time of `scans`, and does not count them.
  void skip_uncounted(std::uint32_t scans) noexcept { first_counter_ -= scans; }
  void send_payload(std::span<const std::uint8_t> payload);
  void send_bytes(std::span<const std::uint8_t> bytes);
  void send_descriptor();
  void send_channels();
  /// `ahead`: how many scans later the next scan is.
  void send_lost(device::board::LostReason reason, std::uint32_t lost, std::uint32_t ahead = 0);
  void send_log(std::string_view text);

 private:
  void start(device::board::WireRate wanted, std::int64_t now_ns);
  void handle(std::span<const std::uint8_t> payload, std::int64_t now_ns);
  void make_scan(std::int64_t at_ns);
  void send_line(std::int64_t at_ns);
  void send_frame();
  [[nodiscard]] std::int64_t scan_ns(std::uint64_t scan) const noexcept;
  [[nodiscard]] std::size_t frame_scans() const noexcept;

  FakeBoardSetup setup_;
  device::board::WireRate rate_;
  device::board::FrameDecoder decoder_;
  std::vector<std::uint8_t> out_;
  std::size_t taken_ = 0;
  std::int64_t boot_ns_ = 0;
  std::int64_t next_descriptor_ns_ = 0;
  bool is_streaming_ = false;
  bool is_pattern_ = false;
  std::int64_t run_start_ns_ = 0;
  std::uint8_t run_ = 0;
  std::uint32_t counter_ = 0;        ///< Of the next scan.
  std::uint32_t first_counter_ = 0;  ///< Of the run.
  std::uint64_t scans_made_ = 0;
  bool has_lost_ = false;
  std::vector<std::int16_t> codes_;  ///< Of the frame in work.
  std::uint32_t frame_counter_ = 0;
  std::uint32_t frame_ticks_ = 0;
};

}  // namespace dts::test
