// SPDX-License-Identifier: Apache-2.0
#include "lab/compare/session_pair.h"

#include <algorithm>
#include <vector>

#include "core/join.h"
#include "record/catalogue/recording_files.h"

namespace dts::lab::compare {
namespace {

core::Result<std::uint32_t> leading_part_of(const std::vector<record::SessionFile>& files, const std::string& session_id,
                                            std::uint32_t part) {
  std::vector<std::uint32_t> leading;
  for (const record::SessionFile& file : files) {
    if (record::leading_part(file.facts) == file.facts.part) leading.push_back(file.facts.part);
  }
  if (part == 0 && leading.size() == 1) return leading.front();
  if (std::ranges::find(leading, part) != leading.end()) return part;
  const std::string parts = core::join(leading, ", ", [](std::uint32_t number) { return std::to_string(number); });
  if (part == 0) {
    return core::fail(core::ErrorCode::InvalidArgument, "session '" + session_id + "' was resumed: its leading rig has the parts " + parts,
                      "choose one: --part");
  }
  return core::fail(core::ErrorCode::NotFound, "the leading rig of session '" + session_id + "' has no part " + std::to_string(part),
                    "its parts: " + parts);
}

}  // namespace

core::Result<SessionPair> find_session_pair(const std::string& folder, const std::string& session_id, std::uint32_t part) {
  auto files = record::files_of_session(folder, session_id);
  if (!files) {
    core::Error error = files.error();
    if (error.hint.empty()) error.hint = "if the daemon stores its recordings elsewhere, set DTSD_STATE_DIR to that folder";
    return tl::make_unexpected(error);
  }
  DTS_TRY_ASSIGN(const std::uint32_t leading, leading_part_of(*files, session_id, part));
  std::vector<const record::SessionFile*> together;
  for (const record::SessionFile& file : *files) {
    if (record::leading_part(file.facts) == leading) together.push_back(&file);
  }
  std::ranges::stable_sort(together, {}, [&](const record::SessionFile* file) { return file->facts.part != leading; });
  if (together.size() == 2) {
    return SessionPair{
        .file_a = together[0]->file, .file_b = together[1]->file, .rig_a = together[0]->facts.rig, .rig_b = together[1]->facts.rig};
  }
  if (together.size() < 2) {
    return core::fail(core::ErrorCode::InvalidArgument,
                      "session '" + session_id + "' has the recording of one rig only: " + together[0]->file,
                      "name both recordings: dtslab compare A B");
  }
  return core::fail(
      core::ErrorCode::InvalidArgument,
      "session '" + session_id + "' has " + std::to_string(together.size()) +
          " rigs: " + core::join(together, ", ", [](const record::SessionFile* file) { return file->facts.rig + " (" + file->file + ")"; }),
      "name two of its recordings: dtslab compare A B");
}

}  // namespace dts::lab::compare
