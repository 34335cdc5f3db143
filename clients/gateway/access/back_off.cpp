// SPDX-License-Identifier: Apache-2.0
#include "gateway/access/back_off.h"

#include <algorithm>

namespace dts::gateway {

using std::chrono::seconds;

seconds BackOff::wait(const std::string& key, Time now) const {
  const auto found = failures_.find(key);
  if (found == failures_.end() || found->second.count < free_failures_ || now - found->second.last >= kMemory) return seconds{0};
  constexpr unsigned kMostDoublings = 20;
  const unsigned doublings = std::min(found->second.count - free_failures_, kMostDoublings);
  const seconds whole = std::min(longest_, seconds{1LL << doublings});
  return std::max(seconds{0}, std::chrono::ceil<seconds>(found->second.last + whole - now));
}

void BackOff::add_failure(const std::string& key, Time now) {
  if (!failures_.contains(key)) make_room(now);
  Failures& failures = failures_[key];
  if (now - failures.last >= kMemory) failures.count = 0;
  ++failures.count;
  failures.last = now;
}

void BackOff::make_room(Time now) {
  if (failures_.size() < kMostKeys) return;
  std::erase_if(failures_, [now](const auto& entry) { return now - entry.second.last >= kMemory; });
  if (failures_.size() < kMostKeys) return;
  failures_.erase(std::ranges::min_element(failures_, {}, [](const auto& entry) { return entry.second.last; }));
}

}  // namespace dts::gateway
