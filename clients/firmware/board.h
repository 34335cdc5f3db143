// SPDX-License-Identifier: Apache-2.0
// What a board says and does: the protocol without the hardware. The same source runs on a board and in tests on the host.
#pragma once

#include <stdint.h>

#include "firmware/frame.h"
#include "firmware/plan.h"
#include "firmware/run_number.h"
#include "firmware/scan_queue.h"

namespace firmware {

/// One board. Call poll() from the main loop, never from an interrupt. `Hardware` has:
/// - static constexpr Limits kLimits; uint8_t kBits; float kVoltsPerCode; uint8_t kQueuedScans; uint32_t kFirstCounter;
///   uint16_t kDefaultPeriod
/// - serial(), model(), firmware(), channel_name(i): texts
/// - Guard: keeps interrupts out while it lives
/// - start_sampling(period): returns the ticks of the first scan
/// - stop_sampling(): the scan that is being converted is still completed
/// - is_converting()
/// - wake_line(): there are bytes to send
/// - read_cell(i), store_cell(i, value): the EEPROM, without waiting
/// - is_stored(): the last store_cell() is complete
template <class Hardware>
class Board {
 public:
  using Queue = ScanQueue<Hardware::kLimits.channels, Hardware::kQueuedScans, typename Hardware::Guard>;

  explicit Board(Hardware& hardware) : hardware_(hardware) {}

  /// After a reset: ends what the reset cut off on the line, and describes the board.
  void begin() {
    run_.load([this](uint8_t cell) { return hardware_.read_cell(cell); });
    new_run();
    to_host.add(0);
    to_host.publish();
    announce(kAllDescriptions);
    hardware_.wake_line();
  }

  /// Takes commands and sends what is due. Never waits.
  void poll() {
    // A command waits until the answer to the one before is sent, the tail of a stopped run included: each has an answer of its own.
    while (!is_stopping_ && !has_announcement() && !from_host.is_empty()) {
      if (reader_.add(from_host.take())) obey();
    }
    // Alternately, so that a description during a run does not make the queue overflow.
    if (!is_scans_turn_ && is_announcement_due()) {
      if (!has_room(kLargestAnnouncement)) return;  // else shorter frames could take the room for ever
      send_announcement();
    }
    is_scans_turn_ = is_running_ && !send_run();
  }

  /// Call it every 5 s.
  void describe_again() {
    if (!has_announcement()) announce(1);
  }

  /// Returns whether the LED is on. `beats` counts thirtieths of a second. Idle: one second on, one off. Running: on. 2 s after a loss:
  /// fast.
  bool is_led_on(uint16_t beats) {
    if (has_new_loss_) {
      has_new_loss_ = false;
      fast_beats_ = 60;
      last_beat_ = beats;
    }
    const uint16_t passed = static_cast<uint16_t>(beats - last_beat_);
    last_beat_ = beats;
    fast_beats_ = passed < fast_beats_ ? static_cast<uint8_t>(fast_beats_ - passed) : static_cast<uint8_t>(0);
    if (fast_beats_ != 0) return (beats / 3) % 2 == 0;
    return is_running_ || (beats / 30) % 2 == 0;
  }

  ByteRing to_host;    ///< The board's transmitter reads it.
  ByteRing from_host;  ///< The board's receiver writes it.
  Queue scans;         ///< The converter's interrupt writes it.

 private:
  static constexpr uint8_t kChannels = Hardware::kLimits.channels;
  static constexpr uint8_t kAllDescriptions = 1 + kChannels;

  void new_run() {
    run_.advance();
    hardware_.store_cell(run_.cell(), run_.value());
  }

  /// Queues the first `frames` of DESCRIPTOR, CHANNEL 0, CHANNEL 1, ...
  void announce(uint8_t frames) {
    announce_end_ = frames;
    announce_next_ = 0;
  }
  bool has_announcement() const { return announce_next_ < announce_end_ || log_ != nullptr; }

  void obey() {
    const uint8_t size = reader_.size();
    switch (static_cast<Type>(reader_.payload()[0])) {
      case Type::kDescribe:
        if (size != 1) break;
        return announce(kAllDescriptions);
      case Type::kStart:
        if (size != 9) break;
        return start(reader_.u32(1), reader_.u32(5));
      case Type::kStop:
        if (size != 1) break;
        if (!is_running_) {
          wants_pattern_ = false;
          return announce(1);
        }
        hardware_.stop_sampling();
        is_stopping_ = true;
        return;  // the answer follows the tail
      case Type::kPattern:
        if (size != 2) break;
        wants_pattern_ = reader_.payload()[1] != 0;
        return announce(1);
      default: break;
    }
    log_ = "command rejected: unknown type or wrong length";
  }

  void start(uint32_t numerator, uint32_t denominator) {
    announce(1);
    if (is_running_) return;
    if (denominator == 0) {
      log_ = "START rejected: the denominator of the rate is 0";
      return;
    }
    period_ = numerator == 0 ? period_for(Hardware::kLimits, Hardware::kLimits.ticks_per_second, Hardware::kDefaultPeriod)
                             : period_for(Hardware::kLimits, numerator, denominator);
    frame_scans_ = scans_per_frame(Hardware::kLimits, period_);
    new_run();
    counter_ = Hardware::kFirstCounter;
    is_running_ = true;
    ticks_ = hardware_.start_sampling(period_);
  }

  bool has_room(uint8_t payload) const { return to_host.room() >= FrameWriter::size_on_wire(payload); }
  void finish(FrameWriter& frame) {
    frame.end();
    hardware_.wake_line();
  }

  /// At the highest rate, the line has little time for anything but scans. So a description waits while they fill half of the queue.
  bool is_announcement_due() const { return has_announcement() && (!is_running_ || scans.size() < Hardware::kQueuedScans / 2); }

  /// Sends one frame of the description, or a line of log.
  void send_announcement() {
    if (announce_next_ < announce_end_) {
      if (announce_next_ == 0) {
        send_descriptor();
      } else {
        send_channel(static_cast<uint8_t>(announce_next_ - 1));
      }
      ++announce_next_;
      return;
    }
    FrameWriter frame(to_host, Type::kLog);
    frame.bytes(log_);
    log_ = nullptr;
    finish(frame);
  }

  void send_descriptor() {
    is_pattern_ = wants_pattern_;  // from here on, so that the host never takes the pattern for data
    FrameWriter frame(to_host, Type::kDescriptor);
    frame.u8(1);
    frame.u8(kChannels);
    frame.u8(Hardware::kBits);
    frame.u32(Hardware::kLimits.ticks_per_second);
    frame.u32(period_);
    frame.u32(Hardware::kLimits.ticks_per_second);
    frame.u8(static_cast<uint8_t>(0x01 | 0x02 | (is_pattern_ ? 0x04 : 0) | (is_running_ ? 0x08 : 0)));
    frame.text(hardware_.serial(), 32);
    frame.text(hardware_.model(), 32);
    frame.text(hardware_.firmware(), 32);
    finish(frame);
  }

  void send_channel(uint8_t channel) {
    FrameWriter frame(to_host, Type::kChannel);
    frame.u8(channel);
    frame.u8(0);
    // A converter whose input is beyond its range gives its first or last code: those two are rail, not values.
    frame.i16(1);
    frame.i16(static_cast<int16_t>((1UL << Hardware::kBits) - 2));
    frame.f32(Hardware::kVoltsPerCode);
    frame.f32(0.0F);
    frame.text(hardware_.channel_name(channel), 16);
    frame.text("V", 16);
    finish(frame);
  }

  /// Sends one frame of the run. Returns false if one is due but has no room.
  bool send_run() {
    if (!hardware_.is_stored()) return true;  // a reset before that would give the next run the same number
    const bool is_complete = is_stopping_ && !hardware_.is_converting();
    const bool has_loss = scans.has_loss();  // before size(): scans are accepted again only after take_loss()
    const uint8_t ready = scans.size();
    if (ready >= frame_scans_ || (ready != 0 && (has_loss || is_complete))) {
      const uint8_t count = ready < frame_scans_ ? ready : frame_scans_;
      if (!has_room(scans_payload(kChannels, count))) return false;
      send_scans(count);
      return true;
    }
    if (ready != 0 || !(has_loss || is_complete)) return true;
    if (!has_room(kLostPayload)) return false;
    if (has_loss) {
      const typename Queue::Loss loss = scans.take_loss();
      skip(loss.scans);
      has_new_loss_ = true;
      send_lost(static_cast<uint8_t>(loss.reason), loss.scans);
    } else {
      send_lost(static_cast<uint8_t>(Reason::kStopped), 0);
      is_stopping_ = false;
      is_running_ = false;
      wants_pattern_ = false;
      announce(1);
    }
    return true;
  }

  void send_scans(uint8_t count) {
    FrameWriter frame(to_host, Type::kScans);
    frame.u8(run_.value());
    frame.u32(counter_);
    frame.u32(ticks_);
    frame.u8(count);
    for (uint8_t scan = 0; scan < count; ++scan) {
      const int16_t* codes = scans.front();
      for (uint8_t channel = 0; channel < kChannels; ++channel) frame.i16(is_pattern_ ? pattern(channel) : codes[channel]);
      scans.pop();
      skip(1);
    }
    finish(frame);
  }

  void send_lost(uint8_t reason, uint32_t lost) {
    FrameWriter frame(to_host, Type::kLost);
    frame.u8(run_.value());
    frame.u32(counter_);
    frame.u8(reason);
    frame.u32(lost);
    finish(frame);
  }

  int16_t pattern(uint8_t channel) const { return static_cast<int16_t>((counter_ * 7 + channel * 1000UL) & 0x7FFFU); }
  void skip(uint32_t scans_passed) {
    counter_ += scans_passed;
    ticks_ += scans_passed * period_;
  }

  static constexpr uint8_t kLostPayload = 11;
  static constexpr uint8_t kLargestAnnouncement = 24 + 3 * 33;  ///< A descriptor with three texts of 32 bytes.

  Hardware& hardware_;
  CommandReader reader_;
  RunNumber run_;
  const char* log_ = nullptr;
  uint32_t counter_ = 0;  ///< Of the next scan that leaves the queue.
  uint32_t ticks_ = 0;    ///< Of the same scan.
  uint16_t period_ = period_for(Hardware::kLimits, Hardware::kLimits.ticks_per_second, Hardware::kDefaultPeriod);
  uint16_t last_beat_ = 0;
  uint8_t frame_scans_ = 1;
  uint8_t announce_next_ = 0;
  uint8_t announce_end_ = 0;
  uint8_t fast_beats_ = 0;
  bool is_running_ = false;
  bool is_stopping_ = false;
  bool is_scans_turn_ = false;
  bool wants_pattern_ = false;
  bool is_pattern_ = false;
  bool has_new_loss_ = false;
};

}  // namespace firmware
