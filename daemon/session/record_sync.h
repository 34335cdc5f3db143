// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "core/result.h"

namespace dts::session {

/// Synchronises open recordings on its own thread: fdatasync may need 1 s or more on a busy disk (measured: 0.9 s each for file and index),
/// and whatever the record thread could not write in that time would be lost if the daemon were killed. Opens its own descriptors of the
/// same files and shares nothing with the writer.
/// Thread: all calls on the record thread; start and stop while that thread does not run.
class RecordSync {
 public:
  RecordSync() = default;
  ~RecordSync() { stop(); }
  RecordSync(const RecordSync&) = delete;
  RecordSync& operator=(const RecordSync&) = delete;

  void start();
  /// Waits for the current fdatasync.
  void stop() noexcept;

  /// Adds NAME.part and NAME.idx. Fails if they cannot be opened.
  [[nodiscard]] core::Status add(const std::string& rig, const std::string& name);
  /// Does not wait. No effect for an unknown rig.
  void remove(const std::string& rig);
  /// Requests an fdatasync of everything written so far, which covers the data received up to `taken_ns`. Fails with the first error of
  /// earlier requests.
  [[nodiscard]] core::Status request(const std::string& rig, std::int64_t taken_ns);
  /// Returns the newest `taken_ns` whose fdatasync is done; 0: none yet, or the rig is unknown.
  [[nodiscard]] std::int64_t done_ns(const std::string& rig);

 private:
  struct Files;
  void run(const std::stop_token& stop);
  [[nodiscard]] std::map<std::string, std::shared_ptr<Files>>::iterator next_due();

  std::mutex mutex_;  ///< Never held across I/O.
  std::condition_variable_any is_asked_;
  std::map<std::string, std::shared_ptr<Files>> files_;  ///< By rig.
  std::string last_;                                     ///< The rig that was synchronised last.
  std::jthread thread_;
};

}  // namespace dts::session
