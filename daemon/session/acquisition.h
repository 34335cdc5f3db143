// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string_view>

#include "core/clock.h"
#include "core/doorbell.h"
#include "core/frame.h"
#include "core/latest_value.h"
#include "core/losses.h"
#include "core/spsc_ring.h"
#include "device/device.h"
#include "session/recent_peak.h"

namespace dts::session {

/// What the acquire thread tells the rest of the daemon about itself. Trivially copyable: it travels in a LatestValue.
struct AcquisitionReport {
  device::DeviceState device = device::DeviceState::Closed;
  std::uint32_t segment = 0;
  std::uint64_t next_scan = 0;         ///< Index that the next scan of this segment will have.
  std::int64_t last_scan_host_ns = 0;  ///< Instant of the newest scan; 0 before the first.
  std::uint64_t scans_total = 0;
  core::Losses losses;
  core::Gap last_gap;
  RecentPeak ring_blocks;                     ///< Waiting for the pipeline.
  std::uint64_t turns = 0;                    ///< Counts up while the thread lives without scans.
  std::uint64_t reconnects_total = 0;         ///< Times that a lost device came back.
  std::uint64_t restarts_total = 0;           ///< Times that the scan of a present device had to be started again.
  bool is_silent = false;                     ///< Streaming, but nothing came for over a second.
  bool is_armed = false;                      ///< Streaming, but the scan waits for its external trigger.
  std::int64_t host_time_uncertainty_ns = 0;  ///< Of the newest block.
  double clock_drift_ppm = 0.0;               ///< Of the device's clock, as the newest block says.
  core::Rate rate;                            ///< Exact, as the device runs.
  std::array<char, 512> message{};            ///< Why the device is not streaming, and what to do; empty when it is.

  void set_message(std::string_view text) noexcept;
  [[nodiscard]] std::string_view text() const noexcept { return message.data(); }
};

/// The acquire thread's work: keeps one device open and streaming and moves its scans into the ring.
///
///     device --read--> [claimed slot] --SpscRing--> pipeline
///
/// Owns the segments: any hole (device gap, unplug, silence, full ring) closes the segment, is counted, and stands as
/// `gap_before` on the first block of the next one. A device whose scans wait for their reader loses none to a full ring: it is not read
/// until there is room. A lost device is opened again with a growing pause (0.25 to 4 s), at once
/// when something was plugged in. A stream that breaks is started again at once, and again after a second or more of scans; one that breaks
/// sooner than that again waits as an absent device does; one that was absent and breaks soon after its return is started again at once,
/// too.
class Acquisition {
 public:
  /// All of it outlives this object. `rate`: as the device's `exact_rate` gave it.
  Acquisition(device::Device& device, core::Clock& clock, core::SpscRing<core::Acquired>& ring, core::Doorbell& bell, core::Rate rate,
              std::size_t block_scans);

  /// Runs until `request_stop`. Between (re)starts of the device it may allocate and wait; while streaming it does not.
  void run() noexcept;
  /// Thread: any.
  void request_stop() noexcept;
  /// Thread: control (the one reader).
  [[nodiscard]] const AcquisitionReport& report() noexcept { return latest_.load(); }

 private:
  [[nodiscard]] bool bring_up();
  void stream() noexcept;
  void wait_before_retry() noexcept;
  void take(core::Acquired& acquired) noexcept;
  void note_delivery() noexcept;
  void lose_to_full_ring(const core::Block& block) noexcept;
  void note_gap(const core::Gap& gap) noexcept;
  void restart(const core::Gap& gap) noexcept;
  void note_armed(std::int64_t now_ns) noexcept;
  void note_timeout(std::int64_t now_ns, std::int64_t deadline_ns) noexcept;
  void note_jumps(const core::Block& block) noexcept;
  void open_segment(core::Acquired& acquired) noexcept;
  void publish_report() noexcept { latest_.store(report_); }
  void note_turn() noexcept {
    ++report_.turns;
    publish_report();
  }

  device::Device& device_;
  core::Clock& clock_;
  core::SpscRing<core::Acquired>& ring_;
  core::Doorbell& bell_;
  core::Rate wanted_rate_;
  std::size_t block_scans_;
  std::atomic<bool> stop_requested_{false};

  AcquisitionReport report_;
  core::LatestValue<AcquisitionReport> latest_;
  core::Acquired spare_;            ///< Filled when the ring has no slot: the scans must leave the device all the same.
  core::Gap pending_gap_;           ///< To stand before the next block that finds room.
  std::uint64_t segment_base_ = 0;  ///< Device index of the segment's scan 0.
  bool needs_segment_ = true;       ///< The next block starts a segment.
  bool has_streamed_ = false;
  bool was_lost_ = false;
  std::uint64_t scans_since_start_ = 0;  ///< Since it was last brought up.
  std::int64_t suspended_at_last_scan_ns_ = 0;
  std::int64_t quiet_since_ns_ = 0;  ///< Of the last scan or the last start, whichever is later.
  std::int64_t retry_pause_ns_ = 0;
  bool has_retried_at_once_ = false;  ///< Since a stream last lasted.
};

}  // namespace dts::session
