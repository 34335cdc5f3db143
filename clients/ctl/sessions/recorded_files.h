// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ctl/arguments.h"
#include "dts/error.h"

namespace dts::ctl {

/// A recording that can be read on this machine.
struct RecordedFile {
  std::string path;
  std::string session_id;  ///< Empty: named on the command line.
  std::uint32_t part = 0;  ///< 0: named on the command line.
  std::string sha256;      ///< From the catalogue; empty: not known.
};

/// Returns true if an argument names a file rather than a session: a file of that name exists, or it looks like a path or a recording.
[[nodiscard]] bool means_file(const std::string& argument);

/// Fails with InvalidArgument unless `path` is a readable file that begins as XDF; fails with NotAllowed if only the permission is missing.
[[nodiscard]] client::Result<void> check_recording(const std::string& path);

/// Returns the file, or the files of all parts of the session from the daemon's catalogue. Fails with WrongState if a part is still being
/// recorded, with DataDamaged if a file is missing, with Failed if it is not on this machine.
[[nodiscard]] client::Result<std::vector<RecordedFile>> find_recordings(const Arguments& arguments);

}  // namespace dts::ctl
