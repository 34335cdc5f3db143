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
};

struct ChannelDescription {
  std::string name;  ///< "ch0"
  std::string unit;  ///< "V"
  ChannelRole role = ChannelRole::Sensor;
  double minimum = 0.0;     ///< Lowest value the converter can give, in `unit`.
  double maximum = 0.0;     ///< Highest value.
  double resolution = 0.0;  ///< One code, in `unit`; 0 when not quantised.
};

/// Known before anything is opened (libiio v1 learned this late: describe first, open later).
struct DeviceDescription {
  std::string uri;     ///< As given by the user: "sim:floor?seed=7".
  std::string model;   ///< "Simulated floor platform"
  std::string serial;  ///< Identifies the unit; stable across plugging.
  std::vector<ChannelDescription> channels;
  double minimum_rate_hz = 0.0;
  double maximum_rate_hz = 0.0;
};

struct StartOptions {
  core::Rate rate;                   ///< Wanted; the device answers with what its clock can do.
  std::size_t max_block_scans = 64;  ///< Largest block that `read` will be given.
};

/// Closed --open--> Open --start--> Streaming --stop--> Open --close--> Closed; a lost device is Gone until close.
enum class DeviceState : std::uint8_t { Closed, Open, Streaming, Gone };

enum class ReadOutcome : std::uint8_t {
  Scans,         ///< `block` holds 1 or more scans.
  Timeout,       ///< Nothing by the deadline; the device is present and may deliver later.
  Gap,           ///< The stream broke (see `gap`) and goes on: indices of the next block start at 0 again.
  Gone,          ///< The device is lost; only stop and close make sense now.
  NotStreaming,  ///< `read` was called in a state other than Streaming.
};

struct ReadResult {
  ReadOutcome outcome = ReadOutcome::NotStreaming;
  core::Gap gap;  ///< Filled for Gap and Gone.
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
///
/// Thread: open, start, stop and close on one owner thread; `read` on one thread, between start and stop; `interrupt`
/// on any. The destructor closes.
class Device {
 public:
  virtual ~Device() = default;

  [[nodiscard]] virtual const DeviceDescription& describe() const noexcept = 0;
  [[nodiscard]] virtual DeviceState state() const noexcept = 0;

  [[nodiscard]] virtual core::Status open() = 0;
  /// Returns the exact rate the device will run at. Allocates everything `read` needs.
  [[nodiscard]] virtual core::Result<core::Rate> start(const StartOptions& options) = 0;
  /// Waits until `block.capacity()` scans have been taken or `deadline_ns` (host monotonic) has passed, and delivers what
  /// is there. Sets the block's count, first scan (continuing since start or since the last gap) and the host time of the
  /// first scan's instant; the block has one column per described channel, in its unit. Quality bits are set too: 0, or why a
  /// value is NaN. Realtime-safe: yes.
  [[nodiscard]] virtual ReadResult read(core::Block& block, std::int64_t deadline_ns) noexcept = 0;
  /// Makes a waiting `read` return within 100 ms. Thread: any. Realtime-safe: yes.
  virtual void interrupt() noexcept = 0;
  /// Returns within 250 ms.
  virtual core::Status stop() = 0;
  virtual core::Status close() = 0;
};

}  // namespace dts::device
