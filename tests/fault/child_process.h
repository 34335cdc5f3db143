// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <string>

namespace dts::fault {

/// Runs `work` in a forked process, so that a crash or a hang of it is a finding and no end of the run: returns what `work` returned, or
/// how the process ended instead. Empty means that all is well. Thread: fork while no other thread of this process holds a lock that the
/// work needs; in practice from a process with one thread.
[[nodiscard]] std::string run_in_child(const std::function<std::string()>& work, std::chrono::seconds limit);

/// A folder of its own below /tmp, removed with this object.
class TemporaryFolder {
 public:
  /// In the system's folder for temporary files, or in `parent` when that can be written.
  explicit TemporaryFolder(const std::string& parent = {});
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  std::string path_;
};

}  // namespace dts::fault
