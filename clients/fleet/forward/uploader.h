// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>

#include "core/clock.h"
#include "core/log.h"
#include "fleet/forward/settings.h"
#include "fleet/forward/store.h"
#include "fleet/forward/transfer.h"
#include "fleet/forward/uplink.h"

namespace dts::fleet::forward {

/// Limits how many bytes are sent in a second. Has no clock. Thread: one.
class Pace {
 public:
  using Time = std::chrono::steady_clock::time_point;

  [[nodiscard]] bool is_free(Time now) const noexcept { return now >= free_at_; }
  /// `count` bytes are sent now, at most `rate` bytes/s; absent: no limit.
  void add(std::size_t count, std::optional<double> rate, Time now) noexcept;

 private:
  Time free_at_{};
};

/// What `dts-forward status` shows of the upload.
struct UploadProgress {
  std::string session{};  ///< Empty: nothing is sent now.
  std::uint32_t part = 0;
  std::uint64_t bytes = 0;
  std::uint64_t have = 0;    ///< Bytes that the centre has.
  double bytes_per_s = 0.0;  ///< Over the last seconds; 0: not known.
  std::string problem{};     ///< Why nothing is sent, or why it waits; empty: nothing prevents it.
};

struct UploaderOptions {
  std::string clinic;
  wire::SendRules rules;
  UploadLimits limits;
};

/// Sends recordings to the centre, the oldest first, each until there is a receipt for it. Compares each file with dtsd's checksum before
/// it is sent.
class Uploader {
 public:
  Uploader(UploaderOptions options, Uplink& uplink, Store& store, core::Clock& clock, core::Log log);

  /// Works on the next recording: reads it, or sends it until there is a receipt or a reason to stop. Returns false if there was nothing to
  /// do. Thread: one.
  bool work(const std::stop_token& stop);

  /// A session runs: the lower rate applies. Thread: any.
  void set_session_running(bool is_running) noexcept { is_session_running_.store(is_running, std::memory_order_relaxed); }
  /// Ends a pause: the centre answers again. Thread: any.
  void retry() noexcept { is_retry_due_.store(true, std::memory_order_relaxed); }
  /// Thread: any.
  [[nodiscard]] UploadProgress progress() const;

 private:
  [[nodiscard]] std::int64_t utc_ns() const noexcept { return clock_.now_ns() + clock_.utc_minus_monotonic_ns(); }
  [[nodiscard]] std::optional<double> rate() const noexcept;
  [[nodiscard]] bool is_time() const;
  void read(const FileRow& file, const std::stop_token& stop);
  void send(const FileRow& file, const std::stop_token& stop);
  /// Does what the transfer wants. Fails if the file cannot be read any more.
  [[nodiscard]] core::Status do_step(const Transfer::Step& step, const FileRow& file, SentBytes& bytes, const std::string& reply);
  void show(const FileRow& file, const Transfer& transfer);
  void set_problem(const std::string& problem);
  void complain(const core::Status& status);
  void put_off(const FileRow& file, const std::string& why_not);
  void finish(const FileRow& file, const Transfer& transfer, const std::stop_token& stop);

  UploaderOptions options_;
  Uplink& uplink_;
  Store& store_;
  core::Clock& clock_;
  core::Log log_;
  Pace pace_;
  std::atomic<bool> is_session_running_ = false;
  std::atomic<bool> is_retry_due_ = false;
  mutable std::mutex mutex_;
  UploadProgress progress_;                              ///< Behind the mutex.
  std::chrono::steady_clock::time_point measured_at_{};  ///< When `measured_have_` was counted.
  std::uint64_t measured_have_ = 0;
};

}  // namespace dts::fleet::forward
