// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
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
  double sender_time_s = 0.0;     ///< As sent: with the stream and `repeat`, what makes the marker unique.
  std::uint32_t repeat = 0;       ///< How many markers before it had the same time: those of one chunk.
  std::int64_t host_time_ns = 0;  ///< The same on this machine's CLOCK_MONOTONIC.
};

/// Returns a request ID, the same for the same marker: dtsd then sets it once, however often it is sent.
[[nodiscard]] std::string request_id(const ReceivedMarker& marker);

/// Receives from all marker streams in LSL that match one of the predicates, and finds new ones as they appear. Skips streams of dts-lsl,
/// and streams with a regular rate, which are not markers. Has two threads of its own: one
/// receives, one calls `handle`, so that markers are taken from LSL also while `handle` waits.
class MarkerInlets {
 public:
  /// Returns soon after a stop.
  using Handle = std::function<void(const ReceivedMarker& marker, const std::stop_token& stop)>;

  /// `lsl` outlives the object. Fails with InvalidArgument if LSL does not accept a predicate.
  [[nodiscard]] static core::Result<std::unique_ptr<MarkerInlets>> start(const Liblsl& lsl, const std::vector<std::string>& predicates,
                                                                         Handle handle, core::Log log);
  ~MarkerInlets();
  MarkerInlets(const MarkerInlets&) = delete;
  MarkerInlets& operator=(const MarkerInlets&) = delete;

 private:
  using Time = std::chrono::steady_clock::time_point;
  struct Inlet {
    api::Inlet inlet = nullptr;
    std::string uid;
    std::string name;
    core::TokenBucket limit;
    std::optional<double> correction_s;  ///< Nothing: the sender's clock has not been measured yet.
    Time next_correction;
    Time opened;
    bool is_delay_logged = false;
    double last_sent_s = 0.0;
    std::uint32_t repeat = 0;
    std::deque<ReceivedMarker> unmeasured;  ///< Markers that wait for `correction_s`.
  };
  struct Waiting {
    ReceivedMarker marker;
    Time received;
  };
  struct Ended {
    std::string uid;
    Time at;
  };

  MarkerInlets(const Liblsl& lsl, Handle handle, core::Log log) : lsl_(lsl), handle_(std::move(handle)), log_(std::move(log)) {}
  void run(const std::stop_token& stop);
  void find_streams();
  void open(api::Info info);
  void measure_clock(Inlet& inlet);
  /// Returns false if the stream has ended.
  [[nodiscard]] bool receive(Inlet& inlet);
  void pass(Inlet& inlet);
  void close(Inlet& inlet);
  void report(const std::string& text);
  void hand_over(const std::stop_token& stop);

  const Liblsl& lsl_;
  Handle handle_;
  core::Log log_;
  std::vector<api::Resolver> resolvers_;
  std::vector<Inlet> inlets_;  ///< Thread: its own, as the next.
  std::vector<std::string> skipped_uids_;
  std::vector<Ended> ended_;
  bool is_full_logged_ = false;
  core::TokenBucket reports_{0.1, 5.0};
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Waiting> waiting_;  ///< Guarded by `mutex_`.
  std::jthread handler_;
  std::jthread thread_;
};

}  // namespace dts::lsl
