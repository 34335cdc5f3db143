// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ctl/arguments.h"
#include "dts/error.h"

namespace dts::ctl {

/// A recording that can be read here.
struct RecordedFile {
  std::string path;
  std::string session_id;  ///< Empty: named on the command line.
  std::uint32_t part = 0;  ///< 0: named on the command line.
  std::string sha256;      ///< As the catalogue has it; empty: not known.
};

/// Whether an argument means a file rather than a session: there is one of that name, or it looks like a path or a recording.
[[nodiscard]] bool means_file(const std::string& argument);

/// Fails with InvalidArgument unless `path` is a file that can be read and begins as XDF does; with NotAllowed when only the permission is
/// missing.
[[nodiscard]] client::Result<void> check_recording(const std::string& path);

/// The file, or the files of all parts of the session as the daemon knows them. What is still being recorded is WrongState, a file that is
/// gone DataDamaged, one that lies elsewhere Failed.
[[nodiscard]] client::Result<std::vector<RecordedFile>> find_recordings(const Arguments& arguments);

}  // namespace dts::ctl
