// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string_view>

#include "core/clock.h"
#include "core/frame.h"
#include "core/latest_value.h"
#include "core/losses.h"
#include "device/device.h"

namespace dts::session {

/// The report of the acquisition to the rest of the daemon. Trivially copyable, as LatestValue requires.
struct AcquisitionReport {
  device::DeviceState device = device::DeviceState::Closed;
  std::uint32_t segment = 0;
  std::uint64_t next_scan = 0;         ///< Index of the next scan within this segment.
  std::int64_t last_scan_host_ns = 0;  ///< Host time of the newest scan; 0 before the first.
  std::uint64_t scans_total = 0;
  core::Losses losses;
  core::Gap last_gap;
  std::array<char, 512> why_last_gap{};       ///< Why the device was gone before the last gap ended; empty: unplugged, or never gone.
  std::uint64_t turns = 0;                    ///< Increases while the thread runs without scans: a sign of life for the watchdog.
  std::uint64_t reconnects_total = 0;         ///< Number of times that a lost device was opened again.
  std::uint64_t restarts_total = 0;           ///< Number of times that the scan of a connected device was restarted.
  bool is_silent = false;                     ///< Streaming, but without scans for more than 1 s.
  bool is_armed = false;                      ///< Streaming, but the scan waits for its external trigger.
  std::int64_t host_time_uncertainty_ns = 0;  ///< Uncertainty of the newest block's host time.
  double clock_drift_ppm = 0.0;               ///< Drift of the device's clock, from the newest block.
  core::Rate rate;                            ///< The device's exact rate.
  std::array<char, 512> message{};            ///< Why the device is not streaming, and what to do; empty while it streams.

  /// Returns whether scans arrive.
  [[nodiscard]] bool delivers() const noexcept { return device == device::DeviceState::Streaming && !is_silent && !is_armed; }
  void set_message(std::string_view text) noexcept;
  [[nodiscard]] std::string_view text() const noexcept { return message.data(); }
  [[nodiscard]] std::string_view gap_text() const noexcept { return why_last_gap.data(); }
};

/// Receives the scans of an Acquisition. Thread: rig.
class ScanSink {
 public:
  virtual ~ScanSink() = default;
  /// Returns false while no scans may come. Only asked if the device waits for its reader (`waits_for_reader`).
  [[nodiscard]] virtual bool has_room() noexcept { return true; }
  /// Processes the next block. `has_more`: another one follows at once. Realtime-safe: yes.
  virtual void process(const core::Acquired& acquired, bool has_more) noexcept = 0;
};

/// Keeps one device open and streaming, and passes its scans on.
///
///     device --read--> block --ScanSink--> stages
///
/// Owns the segments: any gap (reported by the device, unplugged device, silence) closes the segment, is counted, and becomes `gap_before`
/// of the next segment's first block. A lost device is opened again with growing pauses (0.25 to 4 s), or immediately when a new device is
/// plugged in. A broken stream is restarted immediately if it lasted at least 1 s, or if the device had just returned. If it breaks sooner
/// again, the next restart waits like the retries for an absent device.
class Acquisition {
 public:
  /// All references must outlive this object. `rate`: the result of the device's `exact_rate`.
  Acquisition(device::Device& device, core::Clock& clock, ScanSink& sink, core::Rate rate, std::size_t block_scans);

  /// Runs until `request_stop`. May allocate and wait while it opens or starts the device; does neither while streaming.
  void run() noexcept;
  /// Thread: any.
  void request_stop() noexcept;
  /// Thread: control (the one reader).
  [[nodiscard]] const AcquisitionReport& report() noexcept { return latest_.load(); }

 private:
  [[nodiscard]] bool bring_up();
  void stream() noexcept;
  void wait_before_retry() noexcept;
  void pass_on() noexcept;
  void note_delivery() noexcept;
  void note_gap(const core::Gap& gap) noexcept;
  void note_gone(const std::string& why) noexcept;
  void restart(const core::Gap& gap) noexcept;
  void note_armed(std::int64_t now_ns) noexcept;
  void note_timeout(std::int64_t now_ns, std::int64_t deadline_ns) noexcept;
  void note_jumps(const core::Block& block) noexcept;
  void compare_gap_with_time() noexcept;
  void open_segment() noexcept;
  void publish_report() noexcept { latest_.store(report_); }
  void note_turn() noexcept {
    ++report_.turns;
    publish_report();
  }

  device::Device& device_;
  core::Clock& clock_;
  ScanSink& sink_;
  core::Rate wanted_rate_;
  std::size_t block_scans_;
  std::atomic<bool> stop_requested_{false};

  AcquisitionReport report_;
  core::LatestValue<AcquisitionReport> latest_;
  core::Acquired acquired_;  ///< The newest block.
  core::Gap pending_gap_;    ///< Becomes `gap_before` of the next block.
  std::array<char, 512> why_pending_gap_{};
  std::uint64_t segment_base_ = 0;  ///< Device index of the segment's scan 0.
  bool needs_segment_ = true;       ///< The next block starts a segment.
  bool has_streamed_ = false;
  bool was_lost_ = false;
  std::uint64_t scans_since_start_ = 0;  ///< Since the device was last started.
  std::int64_t suspended_at_last_scan_ns_ = 0;
  std::int64_t quiet_since_ns_ = 0;  ///< Time of the last scan or of the last start, whichever is later.
  std::int64_t retry_pause_ns_ = 0;
};

}  // namespace dts::session
