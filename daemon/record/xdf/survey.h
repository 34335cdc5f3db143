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

/// What is in a file of one stream, up to where the file makes sense.
struct StreamSurvey {
  std::string name;
  double scan_s = 0.0;  ///< 1 / rate; 0: irregular.
  std::uint64_t samples = 0;
  double first_time_s = 0.0;
  double last_time_s = 0.0;
  std::optional<StreamFooter> footer;
};

/// One look through a whole file and its index.
struct Survey {
  std::uint64_t size = 0;
  std::uint64_t end = 0;          ///< Of the last chunk that is whole, makes sense and has the checksum of the index.
  std::uint64_t indexed_end = 0;  ///< As far as the index tells of chunks: beyond `size` when some have been lost.
  std::uint64_t chunks = 0;
  bool has_file_header = false;
  std::optional<core::Error> fault;        ///< Why it ends at `end`, when that is not the end of the file.
  std::optional<core::Error> index_fault;  ///< The index contradicts the file, otherwise than by a checksum.
  bool is_all_indexed = false;             ///< The checksums of all chunks were compared.
  std::map<std::uint32_t, StreamSurvey> streams{};
  std::string sha256;  ///< Of the bytes up to `end`.

  [[nodiscard]] bool is_closed() const noexcept;  ///< Read to its end, and every stream has its footer.
  /// The regular stream that has most samples; the one that has most when none is regular; nullptr: there is no sample.
  [[nodiscard]] const StreamSurvey* longest_stream() const noexcept;
  /// Of that stream: from its first scan to the end of its last, gaps included.
  [[nodiscard]] double duration_s() const noexcept;
  [[nodiscard]] std::string footer_fact(const std::string& name) const;  ///< Of the first footer that has it.
};

/// Fails when the file cannot be opened, is no XDF, or `progress` stops it.
[[nodiscard]] core::Result<Survey> survey(const std::string& file, const Progress& progress);

/// Calls `progress` every 8 MiB only.
class ProgressMeter {
 public:
  ProgressMeter(const Progress& progress, std::uint64_t of) : progress_(progress), of_(of) {}
  /// Fails when the work is to be stopped.
  [[nodiscard]] core::Status advance(std::uint64_t done);

 private:
  const Progress& progress_;
  std::uint64_t of_;
  std::uint64_t told_ = 0;
};

}  // namespace dts::record
