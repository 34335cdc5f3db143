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

/// The kind of signal on a channel. The rig's configuration assigns sensors to channels.
enum class ChannelRole : std::uint8_t {
  Sensor,     ///< Displacement sensor of the plate, V.
  Auxiliary,  ///< Another recorded signal: EMG, a trigger, a simulator's true COP.
  Marker,     ///< Input at a known voltage, to detect rotated channels.
};

/// Name, unit and range of one channel.
struct ChannelDescription {
  std::string name;  ///< "ch0"
  std::string unit;  ///< "V"
  ChannelRole role = ChannelRole::Sensor;
  double minimum = 0.0;     ///< Lowest value that the converter can return, in `unit`.
  double maximum = 0.0;     ///< Highest value, in `unit`.
  double resolution = 0.0;  ///< Size of one code, in `unit`; 0 if not quantised.
};

/// The state of the pipeline at the beginning of a recording; for devices that replay a recording.
struct RecordedPipeline {
  std::vector<std::string> stages{};  ///< Names from `pipeline::stage_text`; empty: unknown.
  std::vector<double> state{};        ///< State before the first scan of the recording.
  std::uint64_t first_scan = 0;       ///< Index of that scan in its segment; stages that keep every n-th scan need it.
};

/// Description of a device, known before it is opened (libiio v1 added this late: describe first, open later).
struct DeviceDescription {
  std::string uri;     ///< As the user wrote it: "sim:floor?seed=7".
  std::string model;   ///< "Simulated floor platform"
  std::string serial;  ///< Identifies the unit, also when it is plugged in again; empty: not known before `open`.
  std::vector<ChannelDescription> channels;
  double minimum_rate_hz = 0.0;  ///< Scans per second.
  double maximum_rate_hz = 0.0;
  bool has_sync_output = false;   ///< The URI configures a line for `set_sync_output`.
  bool waits_for_reader = false;  ///< Scans wait for the reader: a slow reader loses nothing.
  RecordedPipeline recorded_pipeline{};
};

/// Parameters of `Device::start`.
struct StartOptions {
  core::Rate rate;                   ///< Wanted rate; `start` returns the nearest rate that the device's clock can run.
  std::size_t max_block_scans = 64;  ///< Largest block that the caller passes to `read`.
};

/// Result of one check during open, start or a scan.
struct DeviceCheck {
  enum class Outcome : std::uint8_t { Passed = 1, Warning, Failed, Skipped };
  std::string name;  ///< "single readings agree with the scan"
  Outcome outcome = Outcome::Passed;
  std::string detail;  ///< "largest difference 3 mV on ch2"
};

/// Report on the unit that the device opened last.
struct DeviceReport {
  std::string model{};  ///< As the unit says it; empty: it says none, and the description's is used.
  std::string serial{};
  std::vector<std::string> nodes;  ///< Device files of the units that are open now: "/dev/bus/usb/001/002".
  std::string firmware;
  std::vector<DeviceCheck> checks;
};

/// Model and serial number of a unit: what it says itself, otherwise what was known before it was opened.
struct UnitName {
  std::string model;
  std::string serial;  ///< Empty: unknown.
};
[[nodiscard]] inline UnitName unit_name(const DeviceDescription& described, const DeviceReport& report) {
  return {.model = report.model.empty() ? described.model : report.model,
          .serial = report.serial.empty() ? described.serial : report.serial};
}

/// Cue to the person on the rig.
struct Cue {
  bool is_go = false;      ///< true: reach now; false: get ready, hand on the thigh.
  std::int64_t at_ns = 0;  ///< Host monotonic time of the cue.
  double target_cm = 0.0;  ///< Distance of the target from the acromion; 0: no target.
};

/// Closed --open--> Open --start--> Streaming --stop--> Open --close--> Closed; a lost device is Gone until close.
enum class DeviceState : std::uint8_t { Closed, Open, Streaming, Gone };

/// What a call of `Device::read` has found.
enum class ReadOutcome : std::uint8_t {
  Scans,         ///< `block` holds 1 or more scans.
  Timeout,       ///< No scan by the deadline; the device is present and may deliver later.
  Armed,         ///< Like Timeout, but expected: the device waits for its external trigger.
  Gap,           ///< Scans are missing (see `gap`), the stream continues: indices restart at 0 in the next block.
  Broken,        ///< The data are no longer reliable (see `gap`); the device is present: stop it, then start it again.
  Gone,          ///< The device is gone; only stop and close are useful now.
  NotStreaming,  ///< `read` was called in a state other than Streaming.
};

struct ReadResult {
  ReadOutcome outcome = ReadOutcome::NotStreaming;
  core::Gap gap;  ///< Filled for Gap, Broken and Gone.
};

/// A source of scans with its own clock. Every operation is defined in every state.
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
/// | why_gone   | empty         | empty           | empty             | ok                  |
/// | has_more   | false         | false           | ok                | false               |
/// | set_sync_output | WrongState | ok            | ok                | DeviceGone          |
/// | `hear`     | no effect     | no effect       | ok                | no effect           |
///
/// Thread: open, start, stop, close, has_arrived and why_gone on one owner thread; `read` and `has_more` on one thread, between start and
/// stop; `describe`, `state`, `interrupt`, `exact_rate`, `report` and `set_sync_output` on any; `hear` on one of any. The destructor
/// closes.
class Device {
 public:
  virtual ~Device() = default;

  /// Returns what is known about the device without opening it; valid and unchanged as long as the device exists. Thread: any.
  [[nodiscard]] virtual const DeviceDescription& describe() const noexcept = 0;
  /// Returns the present state. It may change to Gone at any time. Thread: any. Realtime-safe: yes.
  [[nodiscard]] virtual DeviceState state() const noexcept = 0;

  /// Returns the exact rate (scans per second), nearest to `wanted`, that the device's clock can run; `start` returns the same rate.
  /// Fails with InvalidArgument outside the limits of `describe`. Thread: any.
  [[nodiscard]] virtual core::Result<core::Rate> exact_rate(core::Rate wanted) const = 0;
  /// Returns the report on the unit; usually empty before the first `open`. Does not wait for control requests. Thread: any.
  [[nodiscard]] virtual DeviceReport report() const = 0;
  /// Returns true if a device was plugged in since the last call: the caller should retry `open`.
  [[nodiscard]] virtual bool has_arrived() noexcept { return false; }
  /// Returns why the device is Gone, as part of a message: "the program x ended with exit status 3"; empty: it was unplugged. May take
  /// 250 ms. Thread: owner.
  [[nodiscard]] virtual std::string why_gone() const { return {}; }

  /// Finds the unit and opens it. Fails with NotFound if no unit matches, with InvalidArgument if several do, with NotAllowed if the system
  /// forbids access, with WrongState if another program uses the unit or the device is Gone, with DeviceGone if it was just unplugged, and
  /// with Failed if it does not work. Thread: owner.
  [[nodiscard]] virtual core::Status open() = 0;
  /// Starts the scan and returns its exact rate. Allocates everything that `read` needs. Fails as the table states, with InvalidArgument
  /// for options that the device cannot run, and with Failed or Timeout if the unit does not answer or does not scan. Thread: owner.
  [[nodiscard]] virtual core::Result<core::Rate> start(const StartOptions& options) = 0;
  /// Waits until `block.capacity()` scans have arrived or `deadline_ns` (host monotonic) has passed, and delivers the scans
  /// that arrived. Sets the block's count, its first scan (counted since start or since the last gap), the host time of that
  /// scan, the uncertainty of this time and the drift of the device's clock. The block must have one column per described
  /// channel; values are in the channel's unit. Sets quality bits: 0, kRail, or the reason why a value is NaN. Repeats Broken
  /// until `stop`.
  /// Realtime-safe: yes while scans flow; if the device falls silent, a request for its state may take up to 100 ms.
  [[nodiscard]] virtual ReadResult read(core::Block& block, std::int64_t deadline_ns) noexcept = 0;
  /// Returns true if the next `read` of a full block would not wait. false is always correct: the caller then publishes block by block.
  /// Thread: that of `read`. Realtime-safe: yes.
  [[nodiscard]] virtual bool has_more() noexcept { return false; }
  /// Makes a waiting `read` return within 100 ms. Thread: any. Realtime-safe: yes.
  virtual void interrupt() noexcept = 0;
  /// Drives the digital line that signals the start of a session to other instruments. Fails with Unsupported if the device has no
  /// such line, with WrongState if it is not open or is busy starting, and with DeviceGone if it is gone. Thread: any.
  [[nodiscard]] virtual core::Status set_sync_output(bool is_high) = 0;
  /// Passes a cue to a simulated person, who follows it. Hardware ignores it: there, the therapist cues the person.
  /// Thread: one, as a rule control. Realtime-safe: yes.
  virtual void hear(const Cue& cue) noexcept { static_cast<void>(cue); }
  /// Stops the scan. Returns within 250 ms if the device answers. Fails with Failed or Timeout if it does not; the state is Open or Gone
  /// also then. Thread: owner, after the last `read` has returned.
  virtual core::Status stop() = 0;
  /// Stops the scan and closes the unit; the device is Closed afterwards, also after an error. Fails like `stop`. Thread: owner.
  virtual core::Status close() = 0;
};

}  // namespace dts::device
