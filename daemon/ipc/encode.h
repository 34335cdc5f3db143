// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/block.h"
#include "core/clock.h"
#include "dts/v1/control.pb.h"
#include "dts/v1/stream.pb.h"
#include "ipc/encode_session.h"
#include "session/supervisor.h"

namespace dts::ipc {

/// Converts blocks of one stream to wire messages; reuses one message and its memory.
class StreamEncoder {
 public:
  StreamEncoder(std::uint64_t instance_id, const std::string& rig, const core::StreamFormat& format);

  /// Returns a message that is valid until the next call.
  [[nodiscard]] const dts::v1::StreamBlock& encode(const core::Block& block, std::uint64_t lost_scans_total,
                                                   std::uint64_t dropped_blocks_total);
  [[nodiscard]] const std::string& topic() const noexcept { return topic_; }

 private:
  std::string topic_;
  dts::v1::StreamBlock message_;
};

/// Constant facts of the running daemon, which identify it to clients.
struct Identity {
  std::uint64_t instance_id = 0;  ///< A new random number at each start.
  std::string version;
  std::string boot_id;
  std::int64_t started_ns = 0;  ///< Monotonic.
};

[[nodiscard]] dts::v1::StatusSnapshot status_snapshot(const Identity& identity, const core::Clock& clock,
                                                      const std::vector<session::RigState>& states,
                                                      const std::vector<std::string>& notices);
/// Returns cumulative bucket counts; the last bucket has no upper limit.
[[nodiscard]] dts::v1::LatencyHistogram latency_histogram(const session::LatencyReport& report);
[[nodiscard]] dts::v1::RigInfo rig_info(const session::Rig& rig);
[[nodiscard]] dts::v1::Error error_message(const core::Error& error);

}  // namespace dts::ipc
