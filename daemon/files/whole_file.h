// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "core/descriptor.h"
#include "core/result.h"

namespace dts::files {

/// Writes `path` completely or not at all, even if the power fails: writes a temporary file in the same folder, synchronises it, renames it
/// to `path` and synchronises the folder. Follows links and keeps the permissions; a new file gets `new_mode` minus the umask. Writes into
/// a pipe or device instead of replacing it. Fails with Failed or NotAllowed, naming the file and the reason; the old file is then
/// unchanged.
[[nodiscard]] core::Status write_whole_file(const std::string& path, std::string_view text, mode_t new_mode = 0666);

/// Writes a file piece by piece, as `write_whole_file` does: completely or not at all. Without `commit`, the destructor deletes what was
/// written. Thread: one at a time.
class WholeFileWriter {
 public:
  /// Fails like `write_whole_file`.
  [[nodiscard]] static core::Result<WholeFileWriter> create(const std::string& path, mode_t new_mode = 0666);
  ~WholeFileWriter();
  WholeFileWriter(WholeFileWriter&& other) noexcept;
  WholeFileWriter& operator=(WholeFileWriter&&) = delete;

  /// Fails like `write_whole_file`; then the file must not be committed.
  [[nodiscard]] core::Status append(std::string_view text);
  [[nodiscard]] core::Status commit();

 private:
  WholeFileWriter(std::string path, std::string target, std::string temporary, core::Descriptor file)
      : path_(std::move(path)), target_(std::move(target)), temporary_(std::move(temporary)), file_(std::move(file)) {}

  std::string path_;
  std::string target_;
  std::string temporary_;  ///< Empty: `path` is not a regular file and is written directly, or the file is committed.
  core::Descriptor file_;
};

/// Returns the whole content of a regular file. Never waits for the writer of a pipe. Fails with InvalidArgument if the file cannot be
/// read, is no regular file (a folder, a pipe, a device), or is larger than `most_bytes`. The message has the reason, but not the file
/// name.
[[nodiscard]] core::Result<std::string> read_whole_file(const std::string& path, std::size_t most_bytes);

}  // namespace dts::files
