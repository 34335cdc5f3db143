// SPDX-License-Identifier: Apache-2.0
#include "record/catalogue/recording_files.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <utility>

#include "record/catalogue/corrections.h"
#include "record/recording.h"

namespace dts::record {

namespace fs = std::filesystem;

FileRank rank(std::string_view file) noexcept {
  if (file.ends_with(".part")) return FileRank::Unfinished;
  return file.ends_with(".recovered.xdf") ? FileRank::Repaired : FileRank::Closed;
}

core::Result<FoundFiles> files_in(const std::string& folder) {
  FoundFiles files;
  std::error_code error;
  fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error);
  for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    const std::string file = entry->path().string();
    std::error_code unknown;
    if (!entry->is_regular_file(unknown)) continue;  // opening a pipe would block
    if (file.ends_with(".xdf") || file.ends_with(".xdf.part")) files.recordings.push_back(file);
    if (file.ends_with(kCorrectionsEnding)) files.corrections.push_back(file);
    if (file.ends_with(std::string(kCorrectionsEnding) + ".new")) files.unfinished.push_back(file);
  }
  if (error)
    return core::fail_errno(error.value(), "cannot look for recordings in " + folder, "check that the disk with the recordings is mounted");
  std::ranges::sort(files.recordings, {}, [](const std::string& file) { return std::pair{rank(file), file}; });
  std::ranges::sort(files.corrections);
  return files;
}

core::Result<std::vector<SessionFile>> files_of_session(const std::string& folder, const std::string& session_id) {
  DTS_TRY_ASSIGN(const FoundFiles found, files_in(folder));
  std::map<std::uint32_t, SessionFile> parts;
  for (const std::string& file : found.recordings) {
    auto facts = read_session_facts(file);
    if (!facts || facts->session_id != session_id) continue;
    const std::uint32_t part = facts->part;
    parts.emplace(part, SessionFile{.facts = std::move(*facts), .file = file});  // of the best rank: those come first
  }
  if (parts.empty()) return core::fail(core::ErrorCode::NotFound, "there is no recording of session '" + session_id + "' in " + folder);
  std::vector<SessionFile> files;
  for (auto& [part, file] : parts) files.push_back(std::move(file));
  return files;
}

}  // namespace dts::record
