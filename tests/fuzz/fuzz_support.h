// SPDX-License-Identifier: Apache-2.0
// What all fuzz targets share.
#pragma once

#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace dts::fuzz {

/// A promise that is broken is as much of a find as a crash.
inline void promise(bool is_kept, const char* what) {
  if (is_kept) return;
  std::fprintf(stderr, "broken promise: %s\n", what);
  std::abort();
}

inline std::string text_of(const std::uint8_t* bytes, std::size_t size) { return {reinterpret_cast<const char*>(bytes), size}; }

inline void put_file(const std::string& file, std::string_view bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// One folder for the whole run, in memory where there is such a place.
class Folder {
 public:
  Folder() {
    std::string name = ::access("/dev/shm", W_OK) == 0 ? "/dev/shm/dts-fuzz-XXXXXX" : "/tmp/dts-fuzz-XXXXXX";
    if (::mkdtemp(name.data()) == nullptr) std::abort();
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string file(const char* name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

/// The input in pieces: [length, 2 bytes, low first][bytes] ... the last takes what is left. Several messages fit into one input.
class Pieces {
 public:
  explicit Pieces(std::string_view input) : rest_(input) {}

  [[nodiscard]] bool is_over() const noexcept { return rest_.empty(); }
  std::uint8_t byte() {
    if (rest_.empty()) return 0;
    const auto first = static_cast<std::uint8_t>(rest_.front());
    rest_.remove_prefix(1);
    return first;
  }
  std::string_view piece() {
    const std::size_t low = byte();
    const std::size_t length = low + 256U * byte();
    const std::string_view taken = rest_.substr(0, length);
    rest_.remove_prefix(taken.size());
    return taken;
  }
  [[nodiscard]] std::string_view rest() const noexcept { return rest_; }

 private:
  std::string_view rest_;
};

/// Bytes that may be anything; breaks a promise, or crashes, when they lead astray.
using TryBytes = void (*)(const std::uint8_t* bytes, std::size_t size);

#ifndef DTS_LIBFUZZER
/// For fuzz_driver.cpp: all targets are in one program. Called before main().
void add_target(const char* name, TryBytes try_bytes);
#endif

}  // namespace dts::fuzz

/// Ends a file NAME_fuzz.cpp, which defines dts::fuzz::NAME::try_bytes. With libFuzzer each target is a program of its own.
#ifdef DTS_LIBFUZZER
#define DTS_FUZZ_TARGET(name)                                                         \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) { \
    dts::fuzz::name::try_bytes(bytes, size);                                           \
    return 0;                                                                          \
  }
#else
#define DTS_FUZZ_TARGET(name) [[maybe_unused]] static const bool name##_is_added = (dts::fuzz::add_target(#name, dts::fuzz::name::try_bytes), true);
#endif
