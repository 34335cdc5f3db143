// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <string>
#include <utility>

#include "report/report.h"

namespace dts::gateway {

using ReportPointer = std::shared_ptr<const report::Report>;

/// Recently requested reports. If there are too many, the one that was unused for longest is dropped.
class ReportShelf {
 public:
  explicit ReportShelf(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  /// Returns null if there is no such report.
  [[nodiscard]] ReportPointer find(const std::string& key);
  /// A report larger than the whole shelf is not kept.
  void keep(const std::string& key, ReportPointer report);
  void clear() noexcept {
    places_.clear();
    bytes_ = 0;
  }

 private:
  struct Place {
    std::string key;
    ReportPointer report;
    std::size_t bytes = 0;
  };
  std::size_t most_bytes_;
  std::size_t bytes_ = 0;
  std::list<Place> places_{};  ///< The most recently used is first.
};

}  // namespace dts::gateway
