// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "core/log.h"
#include "core/result.h"
#include "core/token_bucket.h"
#include "lsl/liblsl.h"

namespace dts::lsl {

/// A marker that another program has sent through LSL.
struct ReceivedMarker {
  std::string stream_uid;  ///< Different for each run of the sender.
  std::string stream_name;
  std::string text;
  double sender_time_s = 0.0;     ///< As sent: with the stream, what makes the marker unique.
  std::int64_t host_time_ns = 0;  ///< The same on this machine's CLOCK_MONOTONIC.
};

/// Returns a request ID, the same for the same marker: dtsd then sets it once, however often it is sent.
[[nodiscard]] std::string request_id(const ReceivedMarker& marker);

/// Receives from all marker streams in LSL that match one of the predicates, and finds new ones as they appear. Skips streams of dts-lsl,
/// and streams with a regular rate, which are not markers. Has a thread of its own, on which it calls `handle`.
class MarkerInlets {
 public:
  using Handle = std::function<void(const ReceivedMarker& marker)>;

  /// `lsl` outlives the object. Fails with InvalidArgument if LSL does not accept a predicate.
  [[nodiscard]] static core::Result<std::unique_ptr<MarkerInlets>> start(const Liblsl& lsl, const std::vector<std::string>& predicates,
                                                                         Handle handle, core::Log log);
  ~MarkerInlets();
  MarkerInlets(const MarkerInlets&) = delete;
  MarkerInlets& operator=(const MarkerInlets&) = delete;

 private:
  struct Inlet {
    api::Inlet inlet = nullptr;
    std::string uid;
    std::string name;
    double correction_s = 0.0;
    core::TokenBucket limit;
  };

  MarkerInlets(const Liblsl& lsl, Handle handle, core::Log log) : lsl_(lsl), handle_(std::move(handle)), log_(std::move(log)) {}
  void run(const std::stop_token& stop);
  void find_streams();
  void open(api::Info info);
  /// Returns false if the stream has ended.
  [[nodiscard]] bool receive(Inlet& inlet);

  const Liblsl& lsl_;
  Handle handle_;
  core::Log log_;
  std::vector<api::Resolver> resolvers_;
  std::vector<Inlet> inlets_;  ///< Thread: its own, as the next.
  std::vector<std::string> skipped_uids_;
  core::TokenBucket reports_{0.1, 5.0};
  std::jthread thread_;
};

}  // namespace dts::lsl
