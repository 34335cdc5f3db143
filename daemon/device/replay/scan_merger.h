// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/frame.h"
#include "core/result.h"
#include "device/replay/recorded_device.h"
#include "record/recording.h"

namespace dts::device::replay {

/// Makes the device's scans of what a recording holds in three streams and its events: columns in the device's order with their
/// quality bits, and the gaps between them.
///
///     raw     ----[chunk 0..24]----------[25..49]----------------------
///     aux     ---------[0..24]--------------[25..49]-------------------   --> add --> merged, one second late --> take
///     quality ------------(bits change at 7)--(at 31)------------------
///
/// A quality bit may stand in the file after the scans that it is about; recorders write within a quarter of a second. Scans therefore
/// leave only when a second of raw scans has come after them, or at `finish`.
class ScanMerger {
 public:
  explicit ScanMerger(const RecordedDevice& device);

  /// Takes the next item of the file; those of other streams are left alone. DataDamaged: the streams contradict each other.
  [[nodiscard]] core::Status add(const record::RecordedItem& item);
  /// Nothing more comes: the rest may leave.
  void finish() noexcept { is_finished_ = true; }

  enum class Taken : std::uint8_t {
    Nothing,  ///< More items are needed, or at the end: it is over.
    Scans,
    Gap,  ///< Before the next scans.
  };
  /// Fills `block` (as many columns as the device has channels) with consecutive scans at their recorded segment and index, at most its
  /// capacity.
  [[nodiscard]] Taken take(core::Block& block, core::Gap& gap);

 private:
  struct Place {
    std::uint32_t segment = 0;
    std::uint64_t scan = 0;
    friend auto operator<=>(const Place&, const Place&) = default;
  };
  /// Scans of one stream that wait, in a row.
  struct Run {
    Place first;
    double first_time_s = 0.0;
    std::size_t count = 0;
    std::size_t left = 0;  ///< The last so many have not been taken.
    std::vector<double> values;

    [[nodiscard]] Place next() const noexcept { return {first.segment, first.scan + (count - left)}; }
  };
  struct Change {
    Place at;
    std::vector<std::uint8_t> bits;
  };
  struct Column {
    std::vector<std::size_t> channels;  ///< Of the device.
    std::deque<Run> runs{};
    std::uint64_t waiting_scans = 0;  ///< Have not been taken.
  };

  core::Status add_scans(const record::RecordedScans& scans, Column& column);
  core::Status align_aux();
  [[nodiscard]] bool is_too_much() const noexcept;
  core::Status add_change(const record::RecordedChange& change);
  void add_segment(const record::RecordedEvent& event);
  [[nodiscard]] std::size_t ready_scans() const noexcept;
  [[nodiscard]] bool is_gap_ahead(const Run& run) const noexcept;
  [[nodiscard]] core::Gap gap_before(const Run& run) const;
  void apply_changes(Place at);
  [[nodiscard]] std::size_t until_change(Place from, std::size_t scans) const noexcept;
  void fill(core::Block& block);
  void copy(Column& column, core::Block& block, std::size_t at, std::size_t scans);
  void set_bits(core::Block& block, std::size_t at, std::size_t scans) const;

  RecordedDevice device_;
  std::size_t lag_scans_ = 0;
  Column raw_;
  Column aux_;
  std::deque<Change> changes_;
  std::vector<std::uint8_t> bits_;  ///< Per device channel, in force.
  std::map<std::uint32_t, core::Gap> gaps_;
  std::optional<Place> expected_;  ///< What continues without a gap.
  double next_time_s_ = 0.0;       ///< Time of that scan.
  bool is_finished_ = false;
};

}  // namespace dts::device::replay
