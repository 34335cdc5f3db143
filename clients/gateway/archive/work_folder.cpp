// SPDX-License-Identifier: Apache-2.0
#include "gateway/archive/work_folder.h"

namespace dts::gateway {

namespace fs = std::filesystem;

std::uint64_t bytes_below(const std::filesystem::path& folder) noexcept {
  std::uint64_t bytes = 0;
  std::error_code failed;
  fs::recursive_directory_iterator entry(folder, failed);
  for (; !failed && entry != fs::recursive_directory_iterator(); entry.increment(failed)) {
    std::error_code gone;
    const std::uint64_t size = fs::is_regular_file(entry->symlink_status(gone)) ? fs::file_size(entry->path(), gone) : 0;
    if (!gone) bytes += size;
  }
  return bytes;
}

}  // namespace dts::gateway
