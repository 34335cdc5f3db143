// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

#include "core/log.h"
#include "core/result.h"
#include "lsl/settings.h"

namespace dts::lsl {

/// Lets LabRecorder record one file for each session, through its remote control: TCP, one command a line, "OK" after each.
///
/// Has a thread of its own, so that a LabRecorder that does not answer delays no samples. If LabRecorder cannot be reached, retries every
/// 5 s while the session is under way. The destructor stops the recording under way.
class LabRecorder {
 public:
  LabRecorder(LabRecorderSettings settings, core::Log log);
  ~LabRecorder();
  LabRecorder(const LabRecorder&) = delete;
  LabRecorder& operator=(const LabRecorder&) = delete;

  /// Sets the session that LabRecorder shall record; empty: none. Returns immediately. Thread: any.
  void follow(const std::string& session_id);

 private:
  void run(const std::stop_token& stop);
  [[nodiscard]] bool is_settled() const { return wanted_ == recorded_ && wanted_ == asked_; }
  [[nodiscard]] core::Status start_file(const std::string& session_id, const std::stop_token& stop);
  [[nodiscard]] core::Status stop_file(const std::stop_token& stop);
  void switch_to(const std::string& wanted, const std::stop_token& stop);
  void report(const core::Error& error);

  LabRecorderSettings settings_;
  core::Log log_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::string wanted_;    ///< Guarded by `mutex_`.
  std::string asked_;     ///< Session of the last "start" without a confirmed "stop". Thread: its own, as the next.
  std::string recorded_;  ///< The same, after "start" was confirmed.
  bool is_failure_logged_ = false;
  std::jthread thread_;
};

}  // namespace dts::lsl
