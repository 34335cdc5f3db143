// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "fault/faulty_disk.h"

namespace dts::fault {

/// What would be left of a folder after a power cut, on the strictest disk that POSIX allows: of a file what stood in it when fsync or
/// fdatasync was last called, of names those that a folder had when it was synchronised itself. The root is there in any case.
/// Thread: any.
class DurableModel {
 public:
  explicit DurableModel(std::string root) : root_(std::move(root)) {}

  /// For `FaultyDisk::on_synchronise`.
  [[nodiscard]] FaultyDisk::Done synchronising(int descriptor, const std::string& path);

  /// Contents by path relative to the root; a folder has none and ends in "/".
  using Survivors = std::map<std::string, std::shared_ptr<const std::string>>;
  /// Copies no content: as good as at once.
  [[nodiscard]] Survivors cut() const;

 private:
  struct Entry {
    ino_t inode = 0;
    bool is_folder = false;
  };
  using Names = std::map<std::string, Entry>;
  void collect(const std::string& folder, const std::string& prefix, Survivors& survivors) const;

  std::string root_;
  mutable std::mutex mutex_;
  std::map<ino_t, std::shared_ptr<const std::string>> contents_;
  std::map<std::string, Names> names_;  ///< By folder.
};

/// Writes them into `folder`, which is made.
void put(const DurableModel::Survivors& survivors, const std::string& folder);

}  // namespace dts::fault
