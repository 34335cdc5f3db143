// SPDX-License-Identifier: Apache-2.0
#include "device/sim/stack/stack_time.h"

#include <map>
#include <mutex>
#include <utility>

namespace dts::device::sim {

std::shared_ptr<StackTime> StackTime::join(const core::Clock& clock, std::uint64_t seed) {
  static std::mutex mutex;
  static std::map<std::pair<const core::Clock*, std::uint64_t>, std::weak_ptr<StackTime>> known;
  const std::scoped_lock lock(mutex);
  std::erase_if(known, [](const auto& one) { return one.second.expired(); });
  std::weak_ptr<StackTime>& entry = known[{&clock, seed}];
  if (auto shared = entry.lock()) return shared;
  auto fresh = std::make_shared<StackTime>();
  entry = fresh;
  return fresh;
}

std::int64_t StackTime::zero_ns(std::int64_t now_ns) noexcept {
  std::int64_t zero_ns = kNotStarted;
  return zero_ns_.compare_exchange_strong(zero_ns, now_ns) ? now_ns : zero_ns;
}

}  // namespace dts::device::sim
