// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "record/session_facts.h"

namespace dts::record {

/// If one part has several files, the first in this order is used.
enum class FileRank : std::uint8_t { Closed, Repaired, Unfinished };
[[nodiscard]] FileRank rank(std::string_view file) noexcept;

struct FoundFiles {
  std::vector<std::string> recordings{};  ///< By rank, then by name.
  std::vector<std::string> corrections{};
  std::vector<std::string> unfinished{};  ///< Corrections that a crash left while they were written.
};
/// Looks in a folder and its subfolders. Fails with the system's reason if the folder cannot be read.
[[nodiscard]] core::Result<FoundFiles> files_in(const std::string& folder);

struct SessionFile {
  SessionFacts facts{};
  std::string file;
};
/// Returns the recordings of a session in a folder and its subfolders, one for each part, by part. Needs no catalogue; reads the first
/// chunk of every recording. Fails like `files_in`, and with NotFound if there are none. Thread: any.
[[nodiscard]] core::Result<std::vector<SessionFile>> files_of_session(const std::string& folder, const std::string& session_id);

}  // namespace dts::record
