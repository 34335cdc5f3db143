// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "dts/v1/control.pb.h"
#include "dts/v1/stream.pb.h"

namespace dts::client {

/// Scans per second as an exact fraction: scan i of a segment is i * denominator / numerator seconds after scan 0.
struct Rate {
  std::int64_t numerator = 1;    ///< 1..1e12
  std::int64_t denominator = 1;  ///< 1..1e12

  /// Returns scans per second, rounded to a double.
  [[nodiscard]] double hz() const noexcept { return static_cast<double>(numerator) / static_cast<double>(denominator); }
  /// Compares numerator and denominator: 2/2 is not equal to 1/1.
  friend bool operator==(const Rate&, const Rate&) = default;
};

/// Name and unit of one channel.
struct ChannelFormat {
  std::string name;  ///< "ml_mm"
  std::string unit;  ///< "mm"
};

/// Properties of a stream that stay constant while the daemon runs.
struct StreamFormat {
  std::string name;                     ///< "cop"
  Rate rate;                            ///< Scans per second.
  std::vector<ChannelFormat> channels;  ///< In the order of `Block::column`.
  std::int64_t delay_ns = 0;            ///< Group delay of the filters: a value describes the input this long before its scan.
};

/// Consecutive scans of one stream. A view: everything that it points to is valid until the next `Subscriber::receive`.
struct Block {
  std::string_view topic;                     ///< "floor/cop"
  std::string_view rig;                       ///< "floor"
  std::string_view stream;                    ///< "cop"
  const StreamFormat* format = nullptr;       ///< Never nullptr in a received block.
  std::uint32_t segment = 0;                  ///< Increases by 1 at every gap of the device; scan indices then restart.
  std::uint64_t first_scan = 0;               ///< Index within the segment.
  std::size_t scan_count = 0;                 ///< At least 1.
  Rate rate;                                  ///< Scans per second.
  std::int64_t host_time_ns = 0;              ///< Time of the first scan: CLOCK_MONOTONIC of the daemon's host.
  std::int64_t host_time_uncertainty_ns = 0;  ///< Largest error of `host_time_ns`; 0: exact (simulated).
  std::uint64_t sequence = 0;                 ///< Blocks of this stream since the daemon started.
  /// Scans of this stream that are missing between the previously delivered block and this one: lost in transit, dropped by a full queue,
  /// or skipped in mode Latest. Before the first block: scans received and dropped while the formats were not known yet. Scans that the
  /// device lost are not counted here; gap events report them.
  std::uint64_t lost_scans = 0;
  /// False if blocks around the end of a segment are missing. The length of that segment is then unknown, and `lost_scans` is a lower
  /// limit.
  bool is_lost_exact = true;
  /// Time from the newest scan to now; absent if the daemon runs on another host, or on another boot of this host.
  std::optional<std::int64_t> age_ns;
  std::uint64_t lost_before_pipeline_total = 0;  ///< Scans that the device lost since the daemon started.
  std::uint64_t dropped_blocks_total = 0;        ///< Blocks of this rig that the publisher dropped since the daemon started.
  std::span<const float> values;                 ///< Columns by channel; NaN where undefined.
  std::span<const std::uint8_t> quality;         ///< Per channel: bits of `v1::Quality`, combined with OR over the scans.
  const v1::StreamBlock* body = nullptr;         ///< The received message itself, for forwarding.

  /// Returns the number of channels: columns of `values`.
  [[nodiscard]] std::size_t channel_count() const noexcept { return quality.size(); }
  /// Returns the values of one channel, one per scan. `channel` must be below `channel_count()`.
  [[nodiscard]] std::span<const float> column(std::size_t channel) const noexcept {
    return values.subspan(channel * scan_count, scan_count);
  }
};

/// An event at one scan of a rig. A view, like Block.
struct Event {
  std::string_view topic;           ///< "floor/marker"
  std::string_view rig;             ///< "floor"
  std::string_view kind;            ///< "marker"
  const v1::Event* body = nullptr;  ///< The received message itself. Never nullptr in a received event.
};

/// The daemon's status, published about once a second. A view, like Block.
struct Status {
  const v1::StatusSnapshot* snapshot = nullptr;  ///< Never nullptr in a received status.
};

/// The daemon was restarted: segments, scan indices and sequences start again. The loss during the restart is unknown.
struct Restart {
  std::uint64_t old_instance_id = 0;  ///< Of the daemon before: a random number for each start.
  std::uint64_t new_instance_id = 0;  ///< Of the daemon now.
};

/// One item of `Subscriber::receive`.
using Message = std::variant<Block, Event, Status, Restart>;

}  // namespace dts::client
