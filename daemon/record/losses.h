// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "core/losses.h"
#include "record/event.h"

namespace dts::record {

/// Sums up what a recording lacks between its first scan and its last, from its events in the order of the file: "segment" after a gap,
/// and "loss". What was missing before the first segment began is not of the recording.
class LossCounter {
 public:
  void take(const RecordedEvent& event);
  [[nodiscard]] const core::Losses& losses() const noexcept { return losses_; }

 private:
  core::Losses losses_;
  bool has_begun_ = false;
};

/// {"ring_full":{"gaps":1,"scans":10560}}: the reasons that occurred.
[[nodiscard]] std::string to_json(const core::Losses& losses);
/// Returns what `to_json` wrote, and nothing if the text does not count losses. An unknown reason counts as `GapReason::None`, as in a
/// recording: a later version may know more reasons.
[[nodiscard]] std::optional<core::Losses> losses_of_json(const std::string& text);

}  // namespace dts::record
