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

/// Synchronises recordings under way, on a thread of its own: fdatasync takes a second and more on a busy disk (measured: 0.9 s each for
/// file and index), and what the record thread cannot write meanwhile is lost when the daemon is killed. Works on descriptors of its own of
/// the same files, so that nothing is shared with whoever writes.
/// Thread: all of it on the record thread, start and stop when that does not run.
class RecordSync {
 public:
  RecordSync() = default;
  ~RecordSync() { stop(); }
  RecordSync(const RecordSync&) = delete;
  RecordSync& operator=(const RecordSync&) = delete;

  void start();
  /// Waits for the synchronisation under way.
  void stop() noexcept;

  /// Looks after NAME.part and NAME.idx from now on. Fails when they cannot be opened.
  [[nodiscard]] core::Status add(const std::string& rig, const std::string& name);
  /// Waits for nothing. No effect for a rig that is not known.
  void remove(const std::string& rig);
  /// Asks for a synchronisation of what has been written by now: all that was taken up to `taken_ns`. Fails with the first error of those
  /// before.
  [[nodiscard]] core::Status request(const std::string& rig, std::int64_t taken_ns);
  /// `taken_ns` of the newest that is done; 0: none is, or the rig is not known.
  [[nodiscard]] std::int64_t done_ns(const std::string& rig);

 private:
  struct Files;
  void run(const std::stop_token& stop);
  [[nodiscard]] std::map<std::string, std::shared_ptr<Files>>::iterator next_due();

  std::mutex mutex_;  ///< Never held across I/O.
  std::condition_variable_any is_asked_;
  std::map<std::string, std::shared_ptr<Files>> files_;  ///< By rig.
  std::string last_;                                     ///< The rig whose turn it was.
  std::jthread thread_;
};

}  // namespace dts::session
