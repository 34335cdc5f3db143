// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <list>
#include <memory>
#include <string>

#include "dts/error.h"

namespace dts::gateway {

/// Recent exports, as files in their own folder. If there is no room, the export that was unused for longest is removed, but never one that
/// is in use. The exports hold data of subjects: only the gateway's user may read the folder, and it is emptied at the start and at the
/// end.
/// Thread: one.
class ExportCache {
 public:
  struct Export {
    std::filesystem::path file;
    std::uint64_t bytes = 0;
  };
  using Held = std::shared_ptr<const Export>;

  /// Removes everything in `folder`.
  [[nodiscard]] static client::Result<std::unique_ptr<ExportCache>> open(const std::filesystem::path& folder, std::uint64_t most_bytes);
  ~ExportCache();
  ExportCache(const ExportCache&) = delete;
  ExportCache& operator=(const ExportCache&) = delete;

  /// Returns null if there is no such export.
  [[nodiscard]] Held find(const std::string& key);
  /// Moves `file`, which must be below the folder, into the cache. Returns false and leaves the file if exports in use leave no room.
  [[nodiscard]] bool keep(const std::string& key, const std::filesystem::path& file, std::uint64_t bytes);
  /// Removes all exports. One that is being sent is removed too: what was opened can still be read to its end.
  void clear() noexcept;
  /// Returns an unused name for a folder inside the cache's folder.
  [[nodiscard]] std::filesystem::path new_folder();

 private:
  ExportCache(std::filesystem::path folder, std::uint64_t most_bytes) : folder_(std::move(folder)), most_bytes_(most_bytes) {}
  [[nodiscard]] bool make_room(std::uint64_t bytes);

  struct Place {
    std::string key;
    Held held;
  };
  std::filesystem::path folder_;
  std::uint64_t most_bytes_;
  std::uint64_t bytes_ = 0;
  std::uint64_t names_ = 0;
  std::list<Place> places_{};  ///< The most recently used is first.
};

}  // namespace dts::gateway
