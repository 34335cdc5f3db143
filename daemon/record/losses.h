// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/losses.h"
#include "core/result.h"
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
/// DataDamaged: no such object, an unknown reason, or no counts.
[[nodiscard]] core::Result<core::Losses> losses_of_json(const std::string& text);

}  // namespace dts::record
