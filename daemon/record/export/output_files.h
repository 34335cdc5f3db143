// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace dts::record {

/// A file with a temporary name and its own buffer. Keeps the first error, so that callers need not check each `append`.
class OutputFile {
 public:
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Returns room for `bytes` more bytes. Fill it from the front, then call `advance`.
  [[nodiscard]] char* reserve(std::size_t bytes);
  /// `end`: one past the last byte written into the room that `reserve` returned.
  void advance(const char* end) noexcept { used_ = static_cast<std::size_t>(end - buffer_.data()); }
  void append(std::string_view text);
  [[nodiscard]] core::Status status() const;

 private:
  friend class OutputFiles;
  OutputFile(std::string name, std::string temporary, int descriptor, bool may_replace);
  void flush() noexcept;
  void write_all(const char* from, std::size_t bytes) noexcept;
  void close() noexcept;

  std::string name_;
  std::string temporary_;
  int descriptor_ = -1;
  bool may_replace_ = false;
  std::vector<char> buffer_{};
  std::size_t used_ = 0;
  std::uint64_t bytes_ = 0;
  int system_errno_ = 0;
};

/// A group of files of which all or none appear. Before `commit` they have temporary names (".NAME.part"). Without `commit` the destructor
/// removes all files and folders that were created.
class OutputFiles {
 public:
  /// `folder` is created if it does not exist; empty: the current directory.
  explicit OutputFiles(std::string folder);
  ~OutputFiles();
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;

  /// Creates a file and the subfolders in `name`. Fails with WrongState if the file exists. This object owns the file; the pointer is valid
  /// until `commit`.
  [[nodiscard]] core::Result<OutputFile*> create(const std::string& name);
  /// Creates a file with its whole content. Fails like `create`.
  [[nodiscard]] core::Status put(const std::string& name, std::string_view text);
  /// Creates a file with its whole content, or replaces an existing one: for lists that grow.
  [[nodiscard]] core::Status replace(const std::string& name, std::string_view text);

  struct Written {
    std::vector<std::string> files{};  ///< Paths, in the order of creation.
    std::uint64_t bytes = 0;
  };
  /// Renames all files to their final names. Only `replace` replaces existing files. If it fails, no new file is left.
  [[nodiscard]] core::Result<Written> commit();

  [[nodiscard]] std::string path(const std::string& name) const { return folder_ + "/" + name; }

 private:
  [[nodiscard]] core::Result<OutputFile*> open(const std::string& name, bool may_replace);
  [[nodiscard]] core::Status make_folder(const std::string& path);

  std::string folder_;
  std::vector<std::unique_ptr<OutputFile>> files_{};
  std::vector<std::string> made_folders_{};
  bool is_committed_ = false;
};

}  // namespace dts::record
