// SPDX-License-Identifier: Apache-2.0
#include "lab/base/small_file.h"

#include <filesystem>
#include <fstream>

namespace dts::lab {

core::Result<std::string> read_small_file(const std::string& file) {
  constexpr std::size_t kMostBytes = std::size_t{16} << 20U;
  std::error_code unknown;
  std::ifstream stream;
  if (std::filesystem::is_regular_file(file, unknown)) stream.open(file, std::ios::binary);  // opening a pipe would block
  if (!stream.is_open()) return core::fail(core::ErrorCode::InvalidArgument, file + " cannot be read", "give an existing file");
  std::string text(kMostBytes + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() <= kMostBytes) return text;
  return core::fail(core::ErrorCode::InvalidArgument, file + " is larger than 16 MiB: not a network of this kind", "give another file");
}

}  // namespace dts::lab
