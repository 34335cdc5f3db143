// SPDX-License-Identifier: Apache-2.0
#include "gateway/archive/export_cache.h"

#include <algorithm>
#include <system_error>
#include <utility>

namespace dts::gateway {

namespace fs = std::filesystem;

client::Result<std::unique_ptr<ExportCache>> ExportCache::open(const fs::path& folder, std::uint64_t most_bytes) {
  std::error_code failed;
  fs::remove_all(folder, failed);
  if (!failed) fs::create_directories(folder, failed);
  if (!failed) fs::permissions(folder, fs::perms::owner_all, failed);
  if (!failed) return std::unique_ptr<ExportCache>(new ExportCache(folder, most_bytes));
  return client::fail(client::ErrorCode::Failed, "cannot use the cache directory '" + folder.string() + "': " + failed.message(),
                      "give a writable directory: --cache DIR");
}

ExportCache::~ExportCache() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

ExportCache::Held ExportCache::find(const std::string& key) {
  const auto found = std::ranges::find(places_, key, &Place::key);
  if (found == places_.end()) return nullptr;
  places_.splice(places_.begin(), places_, found);
  return places_.front().held;
}

bool ExportCache::keep(const std::string& key, const fs::path& file, std::uint64_t bytes) {
  if (!make_room(bytes)) return false;
  const fs::path name = folder_ / (std::to_string(++names_) + ".zip");
  std::error_code failed;
  fs::rename(file, name, failed);
  if (failed) return false;
  places_.push_front({.key = key, .held = std::make_shared<const Export>(Export{.file = name, .bytes = bytes})});
  bytes_ += bytes;
  return true;
}

bool ExportCache::make_room(std::uint64_t bytes) {
  if (bytes > most_bytes_) return false;
  while (bytes_ > most_bytes_ - bytes) {
    const auto is_free = [](const Place& place) { return place.held.use_count() == 1; };
    const auto oldest = std::find_if(places_.rbegin(), places_.rend(), is_free);
    if (oldest == places_.rend()) return false;
    std::error_code ignored;
    fs::remove(oldest->held->file, ignored);
    bytes_ -= oldest->held->bytes;
    places_.erase(std::prev(oldest.base()));
  }
  return true;
}

void ExportCache::clear() noexcept {
  for (const Place& place : places_) {
    std::error_code ignored;
    fs::remove(place.held->file, ignored);
  }
  places_.clear();
  bytes_ = 0;
}

fs::path ExportCache::new_folder() { return folder_ / ("work-" + std::to_string(++names_)); }

}  // namespace dts::gateway
