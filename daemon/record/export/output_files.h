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

/// A file that is written under a temporary name, with a buffer of its own. The first error stays: `append` may be called on.
class OutputFile {
 public:
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Room for `bytes` more, to be filled from the front and given to `advance`.
  [[nodiscard]] char* reserve(std::size_t bytes);
  /// `end`: behind the last byte that was written into what `reserve` gave.
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

/// Files that come into being together or not at all. Until `commit` they have names of their own (".NAME.part"), and what was made,
/// folders too, goes with the object.
class OutputFiles {
 public:
  /// `folder` is made when it is not there; empty: the present one.
  explicit OutputFiles(std::string folder);
  ~OutputFiles();
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;

  /// A new file; `name` may lead through folders below ours, which are made. WrongState when there is such a file. Ours; valid until
  /// `commit`.
  [[nodiscard]] core::Result<OutputFile*> create(const std::string& name);
  /// The same with its whole content.
  [[nodiscard]] core::Status put(const std::string& name, std::string_view text);
  /// Whole content that takes the place of what is there: for lists that grow.
  [[nodiscard]] core::Status replace(const std::string& name, std::string_view text);

  struct Written {
    std::vector<std::string> files{};  ///< Paths, in the order of their making.
    std::uint64_t bytes = 0;
  };
  /// Gives all files their names. Nothing is ever replaced but by `replace`; after a failure nothing new is left.
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
