// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "core/result.h"

namespace dts::record {

/// Longest time between a scan leaving the pipeline and its chunk in the file, and between two synchronisations.
inline constexpr double kLongestUnwrittenS = 0.25;
inline constexpr double kLongestUnsynchronisedS = 0.5;

struct Recovery {
  std::string file;  ///< The repaired copy.
  std::string sha256;
  std::uint64_t kept_bytes = 0;
  std::uint64_t dropped_bytes = 0;
  std::uint64_t chunks = 0;
  double duration_s = 0.0;      ///< As `Verification`'s.
  double lost_s_at_most = 0.0;  ///< Dropped tail, and what had not reached the disk.
  std::string reason;           ///< Why the original ended: "no footer", "chunk torn at byte 1234", "checksum wrong at byte 1234"
};

/// How far a long piece of work is: done bytes of all. Returns false to stop it.
using Progress = std::function<bool(std::uint64_t done, std::uint64_t of)>;

/// Copies what is whole of `file` to `copy` and closes it properly: up to the last chunk whose length prefix, content and (where the index
/// has it) CRC are right; then a footer per stream with the facts `recovered` and `lost_s_at_most`. The original is not touched. Without an
/// index the lengths and contents alone decide. Fails with WrongState when `file` is whole, closed and has its final name (nothing to
/// recover; one that is still called .part is copied with nothing lost), and when `copy` exists; with DataDamaged when not even the file
/// header is whole. Nothing is left behind when it fails. A header of a regular stream without samples is left out: libxdf crashes on it.
[[nodiscard]] core::Result<Recovery> recover(const std::string& file, const std::string& copy, const Progress& progress = {});

/// "x.xdf.part" -> "x.recovered.xdf", beside it.
[[nodiscard]] std::string recovered_name(const std::string& file);

struct Verification {
  std::string sha256;
  std::uint64_t bytes = 0;
  std::uint64_t chunks = 0;
  std::uint64_t scans = 0;  ///< Of the stream that has most.
  double duration_s = 0.0;  ///< Of the same: from its first scan to the end of its last, gaps included.
  bool has_index = false;  ///< Checksums of all chunks were compared.
  bool is_closed = false;  ///< Every stream has its footer.
  std::string incomplete;  ///< The reason it says of itself; empty: complete.
  bool is_recovered = false;
  double lost_s_at_most = 0.0;
};
/// Reads the whole file: structure, counts against footers, checksums against the index. DataDamaged: says what is wrong, and where. A file
/// that is sound but has no footers is no error here: `is_closed` says so.
[[nodiscard]] core::Result<Verification> verify(const std::string& file, const Progress& progress = {});

}  // namespace dts::record
