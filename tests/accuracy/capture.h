// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "accuracy/cases.h"
#include "dts/subscriber.h"

namespace dts::accuracy {

/// Three columns of one stream, indexed by scan of the first segment; NaN where nothing was received.
struct Track {
  double rate_hz = 0.0;
  double delay_s = 0.0;  ///< As published: a value describes the input this long before its scan.
  std::array<std::vector<double>, 3> columns;
  std::vector<std::uint8_t> doubts;  ///< Quality bits of the block that brought the scan.

  [[nodiscard]] std::size_t size() const noexcept { return doubts.size(); }
};

/// What a client saw of one rig.
struct RigCapture {
  Track cop;                          ///< ml_mm, ap_mm, load_n
  Track truth;                        ///< The simulator's true_ml_mm, true_ap_mm, true_load_n, from "aux".
  std::uint64_t lost_on_the_way = 0;  ///< Scans missing between the daemon and here.
  std::uint64_t lost_before_pipeline = 0;
  std::uint64_t dropped_blocks = 0;  ///< By the publisher; their scans are among those lost on the way.
};

using Captures = std::map<std::string, RigCapture, std::less<>>;

/// Receives "<rig>/cop" and "<rig>/aux" until every case has its last scan. Fails with Timeout when they do not come, with
/// DeviceGone at a new segment or a restarted daemon, with DataDamaged when a channel is missing.
[[nodiscard]] client::Result<Captures> capture(client::Subscriber& subscriber, const std::vector<Case>& cases);

/// The topics that `capture` needs.
[[nodiscard]] std::vector<std::string> topics(const std::vector<Case>& cases);

}  // namespace dts::accuracy
