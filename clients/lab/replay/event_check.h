// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "core/event.h"
#include "dts/v1/stream.pb.h"
#include "lab/replay/stream_check.h"

namespace dts::lab::replay {

/// Compares the recorded reaches and classes with those recomputed from the raw stream, one by one and to the last digit. Either side may
/// be ahead.
class EventCheck {
 public:
  void add_recorded(const v1::Event& event);
  void add_computed(const core::FrameEvents& events);
  /// Ends the comparison here.
  void stop() noexcept { is_stopped_ = true; }
  /// Marks the end of both sides. If the recording is torn, one side may end early.
  void finish(bool is_torn);

  [[nodiscard]] std::uint64_t compared() const noexcept { return compared_; }
  [[nodiscard]] const std::optional<Difference>& difference() const noexcept { return difference_; }

 private:
  /// Reaches and classes are compared separately: the frames of a replay have other scans than those of the daemon, so the two kinds may be
  /// interleaved differently.
  struct Kind {
    std::deque<v1::Event> recorded;
    std::deque<v1::Event> computed;
  };
  void match(Kind& kind);
  void note(const v1::Event& at, const std::string& recorded, const std::string& computed);

  Kind reaches_;
  Kind classes_;
  std::uint64_t compared_ = 0;
  bool is_stopped_ = false;
  std::optional<Difference> difference_;
};

}  // namespace dts::lab::replay
