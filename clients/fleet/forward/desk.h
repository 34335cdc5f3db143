// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <stop_token>
#include <string>

#include "core/log.h"
#include "fleet/forward/store.h"
#include "fleet/forward/transfer.h"
#include "fleet/forward/uplink.h"

namespace dts::fleet::forward {

/// Sends facts and erasures of the store to the centre, one at a time, until the centre has answered each. A session that fails waits,
/// longer after each failure; the others do not wait for it. Thread: one.
class Desk {
 public:
  Desk(std::string clinic, Uplink& uplink, Store& store, core::Log log);

  /// Sends what waits. Returns early if the centre does not answer or asks for a pause; the next call continues after it.
  void serve(std::chrono::steady_clock::time_point now, const std::stop_token& stop);
  /// Ends a pause: the centre answers again.
  void retry() noexcept;
  /// Why it does not send; empty: nothing prevents it.
  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }

 private:
  /// A session that failed.
  struct PutOff {
    Backoff backoff;
    std::chrono::steady_clock::time_point until{};
    std::string problem{};
  };

  struct Waiting {
    std::optional<std::string> erased{};
    std::optional<v1::FleetSession> facts{};
  };

  /// Returns false if the rest must wait.
  bool send_facts(const v1::FleetSession& facts, const std::stop_token& stop);
  bool reject(const v1::FleetSession& facts, const std::string& reason);
  bool send_erasure(const std::string& session, const std::stop_token& stop);
  bool fail(const std::string& problem);
  bool fail(const std::string& session, const core::Error& why);
  bool wait(const std::string& session, const v1::Later& later);
  void put_off(const std::string& session, const std::string& problem);
  [[nodiscard]] core::Result<Waiting> next(const std::set<std::string>& without) const;
  /// `without_due`: without those whose time has come.
  [[nodiscard]] std::set<std::string> sessions_put_off(bool without_due) const;

  std::string clinic_;
  Uplink& uplink_;
  Store& store_;
  core::Log log_;
  Backoff backoff_;
  std::map<std::string, PutOff> put_off_;
  std::chrono::steady_clock::time_point now_{};
  std::chrono::milliseconds pause_{0};
  std::chrono::steady_clock::time_point not_before_{};
  std::uint64_t connections_ = 0;
  std::string problem_;
};

}  // namespace dts::fleet::forward
