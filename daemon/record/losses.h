// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "core/losses.h"
#include "dts/v1/stream.pb.h"

namespace dts::record {

/// Adds up the scans that are missing between the first and the last scan of a recording. Reads its segment starts and losses in file
/// order. Ignores the gap before the first segment, because it lies before the recording.
class LossCounter {
 public:
  void add(const v1::Event& event);
  [[nodiscard]] const core::Losses& losses() const noexcept { return losses_; }

 private:
  core::Losses losses_;
  bool has_begun_ = false;
};

/// Returns {"ring_full":{"gaps":1,"scans":10560}}, with only the reasons that occurred.
[[nodiscard]] std::string to_json(const core::Losses& losses);
/// Reads the text of `to_json`; returns nothing if the text has another form. Counts an unknown reason as `GapReason::None`, because a
/// later version may have more reasons.
[[nodiscard]] std::optional<core::Losses> losses_of_json(const std::string& text);

}  // namespace dts::record
