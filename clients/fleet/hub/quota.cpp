// SPDX-License-Identifier: Apache-2.0
#include "fleet/hub/quota.h"

namespace dts::fleet::hub {
namespace {

constexpr double kBytesOfOne = 16.0 * 1024.0;
constexpr double kChunkWeight = 0.05;
constexpr double kBeatsPerS = 1.0;

}  // namespace

bool MessageQuota::take(const std::string& clinic, wire::Matter matter, std::size_t bytes, core::TokenBucket::Time now) {
  const double per_second = matter == wire::Matter::Beat ? kBeatsPerS : messages_per_s_;
  const double weight = matter == wire::Matter::Chunk ? kChunkWeight : 1.0 + static_cast<double>(bytes) / kBytesOfOne;
  const std::lock_guard lock(mutex_);
  Clinic& counted = clinics_[clinic];
  const bool is_taken = counted.buckets.try_emplace(matter, per_second).first->second.take(now, weight);
  counted.slowed += is_taken ? 0U : 1U;
  return is_taken;
}

std::map<std::string, std::uint64_t> MessageQuota::slowed() const {
  const std::lock_guard lock(mutex_);
  std::map<std::string, std::uint64_t> slowed;
  for (const auto& [clinic, counted] : clinics_) slowed.emplace(clinic, counted.slowed);
  return slowed;
}

}  // namespace dts::fleet::hub
