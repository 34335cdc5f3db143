// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "record/export/output_files.h"

namespace dts::record {

/// Sorts the rows of events by time before they reach their file. A recording has events in the order in which dtsd reported them: after an
/// undo, it reports phases that were due up to some seconds before. Keeps the latest `kMostWaiting` rows, so that a file with any number of
/// events needs bounded memory.
class EventRows {
 public:
  static constexpr std::size_t kMostWaiting = 8192;

  explicit EventRows(OutputFile& file) : file_(&file) {}

  /// Adds a row with its line end. Rows of the same time keep their order.
  void add(std::int64_t time_ns, std::string row) {
    waiting_.emplace(time_ns, std::move(row));
    if (waiting_.size() > kMostWaiting) write_earliest();
  }
  void finish() {
    while (!waiting_.empty()) write_earliest();
  }
  [[nodiscard]] core::Status status() const { return file_->status(); }

 private:
  void write_earliest() {
    file_->append(waiting_.begin()->second);
    waiting_.erase(waiting_.begin());
  }

  OutputFile* file_;
  std::multimap<std::int64_t, std::string> waiting_{};
};

}  // namespace dts::record
