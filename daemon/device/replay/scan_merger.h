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

/// Rebuilds the device's scans from three streams of a recording and its events: columns in the device's order with their
/// quality bits, and the gaps between scans.
///
///     raw     ----[chunk 0..24]----------[25..49]----------------------
///     aux     ---------[0..24]--------------[25..49]-------------------   --> add --> merged, one second late --> take
///     quality ------------(bits change at 7)--(at 31)------------------
///
/// A quality bit may be in the file after its scans; recorders write it within a quarter of a second. So `take` returns scans only when
/// one second of later raw scans has been added, or after `finish`.
class ScanMerger {
 public:
  explicit ScanMerger(const RecordedDevice& device);

  /// Adds the next item of the file; ignores items of other streams. Fails with DataDamaged if the streams contradict each other.
  [[nodiscard]] core::Status add(const record::RecordedItem& item);
  /// Marks the end of the file: `take` may return all remaining scans.
  void finish() noexcept { is_finished_ = true; }

  enum class Taken : std::uint8_t {
    Nothing,  ///< More items are needed; after `finish`: no scans are left.
    Scans,
    Gap,  ///< A gap before the next scans.
  };
  /// Fills `block` (one column per device channel) with consecutive scans, at most its capacity, and sets their recorded segment and index.
  [[nodiscard]] Taken take(core::Block& block, core::Gap& gap);

 private:
  struct Place {
    std::uint32_t segment = 0;
    std::uint64_t scan = 0;
    friend auto operator<=>(const Place&, const Place&) = default;
  };
  /// Waiting consecutive scans of one stream.
  struct Run {
    Place first;
    double first_time_s = 0.0;
    std::size_t count = 0;
    std::size_t left = 0;  ///< Number of scans that have not been taken: the last ones.
    std::vector<double> values;

    [[nodiscard]] Place next() const noexcept { return {first.segment, first.scan + (count - left)}; }
  };
  struct Change {
    Place at;
    std::vector<std::uint8_t> bits;
  };
  struct Column {
    std::vector<std::size_t> channels;  ///< Device channels.
    std::deque<Run> runs{};
    std::uint64_t waiting_scans = 0;  ///< Number of scans that have not been taken.
  };

  core::Status add_scans(const record::RecordedScans& scans, Column& column);
  core::Status align_aux();
  [[nodiscard]] bool is_too_much() const noexcept;
  core::Status add_change(const record::RecordedChange& change);
  void add_segment(const v1::Event& event);
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
  std::vector<std::uint8_t> bits_;  ///< Current quality bits per device channel.
  std::map<std::uint32_t, core::Gap> gaps_;
  std::optional<Place> expected_;  ///< The next scan if there is no gap.
  double next_time_s_ = 0.0;       ///< Time of that scan.
  bool is_finished_ = false;
};

}  // namespace dts::device::replay
