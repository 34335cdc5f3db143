// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"

namespace dts::record {

/// An erasure of a subject that has begun. It is on the disk before the first thing is removed, so that an erasure that a crash interrupts
/// is completed at the next start. It is the only place that still has the subject ID, and it is removed last.
struct Erasure {
  std::string subject;
  std::string who;  ///< For the audit trail.
  std::int64_t utc_ns = 0;
  std::vector<std::string> sessions{};
  std::uint32_t mentions = 0;  ///< Other sessions from which mentions of the subject ID are removed.

  friend bool operator==(const Erasure&, const Erasure&) = default;
};

/// What an erasure has removed.
struct Erased {
  std::uint32_t sessions = 0;
  std::uint32_t files = 0;
  std::uint64_t bytes = 0;
  std::uint32_t mentions = 0;
  std::vector<std::string> left{};  ///< What remains, and why.
};

/// Returns the erasure that was written to this state folder; nothing if there is no such file. Fails with DataDamaged, and if the file
/// cannot be looked at.
[[nodiscard]] core::Result<std::optional<Erasure>> read_erasure(const std::string& state_folder);
/// Writes the erasure; it is on the disk when this returns.
[[nodiscard]] core::Status write_erasure(const std::string& state_folder, const Erasure& erasure);
[[nodiscard]] core::Status remove_erasure(const std::string& state_folder);

/// Removes all files of these sessions below `folder`: recordings, unfinished and repaired ones, their indexes and corrections; files whose
/// name begins with "SESSION." and recordings whose header names the session. It follows no link: a link is removed, its target stays and
/// is listed in `left`. So nothing outside the folder is removed, even if another process replaces a folder by a link meanwhile. Stops
/// early if `is_wanted` returns false. Thread: any.
[[nodiscard]] core::Result<Erased> remove_session_files(const std::string& folder, const std::vector<std::string>& sessions,
                                                        const std::function<bool()>& is_wanted);

/// Returns the text without `subject`, where it stands alone ("P017" in "see P017.", not in "P0170" or "P017-2"); nothing if it does not
/// occur. The text has at most `kLongestCorrectionText` bytes: the replacement of a short ID is longer.
[[nodiscard]] std::optional<std::string> without_mention(const std::string& text, const std::string& subject);

}  // namespace dts::record
