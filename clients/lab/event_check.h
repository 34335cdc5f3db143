// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "core/event.h"
#include "lab/stream_check.h"
#include "record/event.h"

namespace dts::lab {

/// Compares the reaches and classes that a recording tells of with those that its raw stream gives again, one by one and to the last
/// digit. Either side may be ahead.
class EventCheck {
 public:
  void add_recorded(const record::RecordedEvent& event);
  void add_computed(const core::FrameEvents& events);
  /// What comes from here on is not compared.
  void stop() noexcept { is_stopped_ = true; }
  /// No more comes. Of a recording that is torn, one side may end early.
  void finish(bool is_torn);

  [[nodiscard]] std::uint64_t compared() const noexcept { return compared_; }
  [[nodiscard]] const std::optional<Difference>& difference() const noexcept { return difference_; }

 private:
  /// Frames of a replay hold other scans than those of the daemon, so what the two kinds have told stands interleaved otherwise.
  struct Kind {
    std::deque<record::RecordedEvent> recorded;
    std::deque<record::RecordedEvent> computed;
  };
  void match(Kind& kind);
  void note(const record::RecordedEvent& at, const std::string& recorded, const std::string& computed);

  Kind reaches_;
  Kind classes_;
  std::uint64_t compared_ = 0;
  bool is_stopped_ = false;
  std::optional<Difference> difference_;
};

}  // namespace dts::lab
