// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "core/block.h"
#include "record/recording.h"

namespace dts::lab::replay {

/// The first place at which a recorded stream differs from the values computed from the raw stream.
struct Difference {
  std::uint32_t segment = 0;
  std::uint64_t scan = 0;
  std::string channel;  ///< Empty: the whole scan.
  std::string recorded;
  std::string computed;
};

/// Compares one recorded derived stream with the computed stream, scan by scan and bit for bit in the recorded type; all NaNs are equal.
/// Either side may be ahead.
class StreamCheck {
 public:
  explicit StreamCheck(const record::StreamInfo& info) : info_(info) {}

  void add_recorded(const record::RecordedScans& scans);
  void add_computed(const core::Block& block);
  /// Ends the comparison here, because the state of the stages is unknown after this point.
  void stop() noexcept { is_stopped_ = true; }
  /// Marks the end of both sides. If the recording is torn, one side may end early.
  void finish(bool is_torn);

  [[nodiscard]] const std::string& name() const noexcept { return info_.name; }
  [[nodiscard]] std::uint64_t compared_scans() const noexcept { return compared_scans_; }
  [[nodiscard]] const std::optional<Difference>& difference() const noexcept { return difference_; }

 private:
  struct Place {
    std::uint32_t segment = 0;
    std::uint64_t scan = 0;
    friend auto operator<=>(const Place&, const Place&) = default;
  };
  struct Run {
    Place next;
    std::size_t left = 0;
    std::vector<double> values;  ///< Row by row; the last `left` scans are not compared yet.
  };

  void match();
  void match_together(Run& recorded, Run& computed);
  void note(Place at, const std::string& channel, const std::string& recorded, const std::string& computed);
  [[nodiscard]] bool is_same(double recorded, double computed) const noexcept;
  [[nodiscard]] std::string text_of(double value) const;
  void drop(std::deque<Run>& runs, std::size_t scans);

  record::StreamInfo info_;
  std::deque<Run> recorded_;
  std::deque<Run> computed_;
  std::size_t waiting_values_ = 0;  ///< Values of both sides that are still stored, including the compared part of a run.
  std::uint64_t compared_scans_ = 0;
  bool is_stopped_ = false;
  std::optional<Difference> difference_;
};

}  // namespace dts::lab::replay
