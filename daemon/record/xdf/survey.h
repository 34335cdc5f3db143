// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "core/result.h"
#include "record/xdf/recovery.h"
#include "record/xdf/xdf_reader.h"

namespace dts::record {

/// Content of one stream in the readable part of a file.
struct StreamSurvey {
  std::string name;
  double scan_s = 0.0;  ///< 1 / rate; 0: irregular.
  std::uint64_t samples = 0;
  double first_time_s = 0.0;
  double last_time_s = 0.0;
  std::optional<StreamFooter> footer;
};

/// Result of one pass through a whole file and its index.
struct Survey {
  std::uint64_t size = 0;
  std::uint64_t end = 0;          ///< End of the last chunk that is whole, readable and matches the checksum in the index.
  std::uint64_t indexed_end = 0;  ///< End of the last chunk in the index; greater than `size` if chunks were lost.
  std::uint64_t chunks = 0;
  bool has_file_header = false;
  std::optional<core::Error> fault;        ///< Why the readable part ends at `end`, before the end of the file.
  std::optional<core::Error> index_fault;  ///< The index contradicts the file, and not only by a checksum.
  bool is_all_indexed = false;             ///< The index has a matching checksum for every chunk.
  std::map<std::uint32_t, StreamSurvey> streams{};
  std::string sha256;  ///< SHA-256 of the bytes up to `end`.

  [[nodiscard]] bool is_closed() const noexcept;  ///< The whole file is readable, and every stream has its footer.
  /// Returns the regular stream with the most samples; without regular streams, any stream with the most; nullptr if there is no sample.
  [[nodiscard]] const StreamSurvey* longest_stream() const noexcept;
  /// Returns the duration of that stream: from its first scan to the end of its last, gaps included.
  [[nodiscard]] double duration_s() const noexcept;
  [[nodiscard]] std::string footer_fact(const std::string& name) const;  ///< From the first footer that has it.
};

/// Fails if the file cannot be opened or is no XDF, or if `progress` stops it.
[[nodiscard]] core::Result<Survey> survey(const std::string& file, const Progress& progress);

/// Calls `progress` only once every 8 MiB.
class ProgressMeter {
 public:
  ProgressMeter(const Progress& progress, std::uint64_t of) : progress_(progress), of_(of) {}
  /// Fails if `progress` stops the work.
  [[nodiscard]] core::Status advance(std::uint64_t done);

 private:
  const Progress& progress_;
  std::uint64_t of_;
  std::uint64_t reported_ = 0;
};

}  // namespace dts::record
