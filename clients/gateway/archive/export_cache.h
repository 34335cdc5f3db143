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

/// Exports that were made lately, as files in a folder of its own: of too many the one that was not asked for longest goes, but none that
/// somebody holds. Other people's data lie here: nobody else may look into the folder, and it is empty before and after.
/// Thread: one.
class ExportCache {
 public:
  struct Export {
    std::filesystem::path file;
    std::uint64_t bytes = 0;
  };
  using Held = std::shared_ptr<const Export>;

  /// Removes all that is in `folder`.
  [[nodiscard]] static client::Result<std::unique_ptr<ExportCache>> open(const std::filesystem::path& folder, std::uint64_t most_bytes);
  ~ExportCache();
  ExportCache(const ExportCache&) = delete;
  ExportCache& operator=(const ExportCache&) = delete;

  /// Null: not here.
  [[nodiscard]] Held find(const std::string& key);
  /// Moves `file`, which lies below the folder, to its place. False, and the file is left: what is here is being sent and leaves no room.
  [[nodiscard]] bool keep(const std::string& key, const std::filesystem::path& file, std::uint64_t bytes);
  /// The name of a folder in the cache's that is not there yet.
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
  std::list<Place> places_{};  ///< The latest in front.
};

}  // namespace dts::gateway
