// SPDX-License-Identifier: Apache-2.0
#include "gateway/archive/report_shelf.h"

#include <algorithm>

namespace dts::gateway {

ReportPointer ReportShelf::find(const std::string& key) {
  const auto found = std::ranges::find(places_, key, &Place::key);
  if (found == places_.end()) return nullptr;
  places_.splice(places_.begin(), places_, found);
  return places_.front().report;
}

void ReportShelf::keep(const std::string& key, ReportPointer report) {
  std::size_t bytes = 0;
  for (const report::Page& page : report->pages) bytes += page.text.size();
  if (bytes > most_bytes_) return;
  places_.push_front({.key = key, .report = std::move(report), .bytes = bytes});
  bytes_ += bytes;
  while (bytes_ > most_bytes_) {
    bytes_ -= places_.back().bytes;
    places_.pop_back();
  }
}

}  // namespace dts::gateway
