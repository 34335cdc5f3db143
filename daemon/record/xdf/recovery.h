// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "core/result.h"

namespace dts::record {

/// Longest time from a scan's exit from the pipeline until its chunk is in the file, and longest time between two synchronisations.
inline constexpr double kLongestUnwrittenS = 0.25;
inline constexpr double kLongestUnsynchronisedS = 0.5;

struct Recovery {
  std::string file;  ///< The repaired copy.
  std::string sha256;
  std::uint64_t kept_bytes = 0;
  std::uint64_t dropped_bytes = 0;
  std::uint64_t chunks = 0;
  double duration_s = 0.0;      ///< Same meaning as in `Verification`.
  double lost_s_at_most = 0.0;  ///< Time in the removed end of the file and in data that was not yet on the disk, upper limit.
  std::string
      reason;  ///< Why the readable part of the original ends: "no footer", "chunk torn at byte 1234", "checksum wrong at byte 1234"
};

/// Called with the progress of long work, in bytes: `done` of `of`. Returns false to stop the work.
using Progress = std::function<bool(std::uint64_t done, std::uint64_t of)>;

/// Copies the whole chunks of `file` to `copy` and closes the copy. Stops after the last chunk with a correct length prefix, content and
/// (if the index has it) CRC; then adds a footer per stream with the facts `recovered` and `lost_s_at_most`. Does not change the original.
/// Without an index, checks only lengths and contents. Fails with WrongState if `file` is whole, closed and has its final name (a whole
/// file still named .part is copied without loss), or if `copy` exists. Fails with DataDamaged if the file header is not whole. If it
/// fails, it leaves no files behind. Skips the header of a regular stream without samples, because libxdf crashes on it.
[[nodiscard]] core::Result<Recovery> recover(const std::string& file, const std::string& copy, const Progress& progress = {});

/// Returns "x.recovered.xdf" for "x.xdf.part", in the same folder.
[[nodiscard]] std::string recovered_name(const std::string& file);

struct Verification {
  std::string sha256;
  std::uint64_t bytes = 0;
  std::uint64_t chunks = 0;
  std::uint64_t scans = 0;  ///< Of the longest stream, see `Survey::longest_stream`.
  double duration_s = 0.0;  ///< Of the same stream: from its first scan to the end of its last, gaps included.
  bool has_index = false;   ///< The index has checksums of all chunks, and they match.
  bool is_closed = false;   ///< Every stream has its footer.
  std::string incomplete;   ///< The reason in its footers; empty: complete.
  bool is_recovered = false;
  double lost_s_at_most = 0.0;
};
/// Reads the whole file and checks its structure, its counts against the footers and its checksums against the index. Fails with
/// DataDamaged if something is wrong; the message names the fault and its place. A sound file without footers is no error: see `is_closed`.
[[nodiscard]] core::Result<Verification> verify(const std::string& file, const Progress& progress = {});

}  // namespace dts::record
