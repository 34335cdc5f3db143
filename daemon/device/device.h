// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/block.h"
#include "core/frame.h"
#include "core/rate.h"
#include "core/result.h"

namespace dts::device {

/// What a channel carries. The rig's configuration says which sensor sits on which channel.
enum class ChannelRole : std::uint8_t {
  Sensor,     ///< A displacement sensor of the plate, V.
  Auxiliary,  ///< Anything recorded beside it: EMG, a trigger, a simulator's true COP.
  Marker,     ///< At a known voltage, to detect rotated scans.
};

struct ChannelDescription {
  std::string name;  ///< "ch0"
  std::string unit;  ///< "V"
  ChannelRole role = ChannelRole::Sensor;
  double minimum = 0.0;     ///< Lowest value the converter can give, in `unit`.
  double maximum = 0.0;     ///< Highest value.
  double resolution = 0.0;  ///< One code, in `unit`; 0 when not quantised.
};

/// The pipeline as it was when a recording began, for devices that play one.
struct RecordedPipeline {
  std::vector<std::string> stages{};  ///< As `pipeline::stage_text` names them; empty: nothing is known.
  std::vector<double> state{};        ///< Of the pipeline before the first scan of the recording.
  std::uint64_t first_scan = 0;       ///< Index that this scan had in its segment: stages that keep every n-th go by it.
};

/// Known before anything is opened (libiio v1 learned this late: describe first, open later).
struct DeviceDescription {
  std::string uri;     ///< As given by the user: "sim:floor?seed=7".
  std::string model;   ///< "Simulated floor platform"
  std::string serial;  ///< Identifies the unit; stable across plugging.
  std::vector<ChannelDescription> channels;
  double minimum_rate_hz = 0.0;
  double maximum_rate_hz = 0.0;
  bool has_sync_output = false;   ///< `set_sync_output` drives a line, as configured.
  bool waits_for_reader = false;  ///< Its scans wait for whoever reads: nothing is lost when the reader is slow.
  RecordedPipeline recorded_pipeline{};
};

struct StartOptions {
  core::Rate rate;                   ///< Wanted; the device answers with what its clock can do.
  std::size_t max_block_scans = 64;  ///< Largest block that `read` will be given.
};

/// Something that was looked at when the device was opened and started.
struct DeviceCheck {
  enum class Outcome : std::uint8_t { Passed = 1, Warning, Failed, Skipped };
  std::string name;  ///< "single readings agree with the scan"
  Outcome outcome = Outcome::Passed;
  std::string detail;  ///< "largest difference 3 mV on ch2"
};

/// What the device found at the unit that it opened last.
struct DeviceReport {
  std::string serial;
  std::vector<std::string> nodes;  ///< Of the units that are open now: "/dev/bus/usb/001/002".
  std::string firmware;
  std::vector<DeviceCheck> checks;
};

/// What the person at the device is told.
struct Cue {
  bool is_go = false;      ///< Reach now; else: get ready, hand on the thigh.
  std::int64_t at_ns = 0;  ///< Host monotonic: when it is given.
  double target_cm = 0.0;  ///< From the acromion; 0: no target.
};

/// Closed --open--> Open --start--> Streaming --stop--> Open --close--> Closed; a lost device is Gone until close.
enum class DeviceState : std::uint8_t { Closed, Open, Streaming, Gone };

enum class ReadOutcome : std::uint8_t {
  Scans,         ///< `block` holds 1 or more scans.
  Timeout,       ///< Nothing by the deadline; the device is present and may deliver later.
  Armed,         ///< As Timeout, and that is right: the scan waits for its external trigger.
  Gap,           ///< The stream broke (see `gap`) and goes on: indices of the next block start at 0 again.
  Broken,        ///< The stream cannot be believed any more (see `gap`); the device is there: stop, then start again.
  Gone,          ///< The device is lost; only stop and close make sense now.
  NotStreaming,  ///< `read` was called in a state other than Streaming.
};

struct ReadResult {
  ReadOutcome outcome = ReadOutcome::NotStreaming;
  core::Gap gap;  ///< Filled for Gap, Broken and Gone.
};

/// A source of scans with its own clock. Small and total: every operation has a meaning in every state.
///
/// | operation  | Closed        | Open            | Streaming         | Gone                |
/// |------------|---------------|-----------------|-------------------|---------------------|
/// | describe   | ok            | ok              | ok                | ok                  |
/// | open       | -> Open       | ok, no effect   | ok, no effect     | WrongState          |
/// | start      | WrongState    | -> Streaming    | WrongState        | DeviceGone          |
/// | read       | NotStreaming  | NotStreaming    | scans             | Gone                |
/// | stop       | ok, no effect | ok, no effect   | -> Open           | ok, no effect       |
/// | close      | ok, no effect | -> Closed       | stops, -> Closed  | -> Closed           |
/// | exact_rate | ok            | ok              | ok                | ok                  |
/// | report     | ok            | ok              | ok                | ok                  |
/// | has_arrived| ok            | ok              | ok                | ok                  |
/// | set_sync_output | WrongState | ok            | ok                | DeviceGone          |
/// | hear       | no effect     | no effect       | ok                | no effect           |
///
/// Thread: open, start, stop, close and has_arrived on one owner thread; `read` on one thread, between start and stop;
/// `interrupt`, `exact_rate`, `report` and `set_sync_output` on any; `hear` on one of any. The destructor closes.
class Device {
 public:
  virtual ~Device() = default;

  [[nodiscard]] virtual const DeviceDescription& describe() const noexcept = 0;
  [[nodiscard]] virtual DeviceState state() const noexcept = 0;

  /// The rate nearest to `wanted` that the device's clock can give, exactly: what `start` will return for it.
  /// InvalidArgument: outside the limits of `describe`.
  [[nodiscard]] virtual core::Result<core::Rate> exact_rate(core::Rate wanted) const = 0;
  /// Before the first `open`: what is known without the unit, as a rule nothing. Waits for no control request.
  [[nodiscard]] virtual DeviceReport report() const = 0;
  /// true when something was plugged in since the last call: `open` is worth another try now.
  [[nodiscard]] virtual bool has_arrived() noexcept { return false; }

  [[nodiscard]] virtual core::Status open() = 0;
  /// Returns the exact rate the device runs at. Allocates everything `read` needs.
  [[nodiscard]] virtual core::Result<core::Rate> start(const StartOptions& options) = 0;
  /// Waits until `block.capacity()` scans have been taken or `deadline_ns` (host monotonic) has passed, and delivers what
  /// is there. Sets the block's count, first scan (continuing since start or since the last gap) and the host time of the
  /// first scan's instant, its uncertainty and the drift of the device's clock; the block has one column per described channel,
  /// in its unit. Quality bits are set too: 0, kRail, or why a value is NaN. Broken is repeated until `stop`.
  /// Realtime-safe: yes while scans flow; a device that falls silent may be asked for its state, for at most 100 ms.
  [[nodiscard]] virtual ReadResult read(core::Block& block, std::int64_t deadline_ns) noexcept = 0;
  /// Makes a waiting `read` return within 100 ms. Thread: any. Realtime-safe: yes.
  virtual void interrupt() noexcept = 0;
  /// Drives the digital line that tells other instruments that a session begins. Unsupported: there is none. WrongState: or busy starting.
  [[nodiscard]] virtual core::Status set_sync_output(bool is_high) = 0;
  /// Simulated people hear it and obey; at hardware a therapist says it. Thread: one, as a rule control. Realtime-safe: yes.
  virtual void hear(const Cue& cue) noexcept { static_cast<void>(cue); }
  /// Returns within 250 ms when the device answers.
  virtual core::Status stop() = 0;
  virtual core::Status close() = 0;
};

}  // namespace dts::device
