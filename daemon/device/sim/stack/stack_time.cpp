// SPDX-License-Identifier: Apache-2.0
#include "device/sim/stack/stack_time.h"

#include <map>
#include <mutex>
#include <utility>

namespace dts::device::sim {

std::shared_ptr<const StackTime> StackTime::join(const core::Clock& clock, std::uint64_t seed) {
  static std::mutex mutex;
  static std::map<std::pair<const core::Clock*, std::uint64_t>, std::weak_ptr<const StackTime>> known;
  const std::scoped_lock lock(mutex);
  std::erase_if(known, [](const auto& one) { return one.second.expired(); });
  std::weak_ptr<const StackTime>& entry = known[{&clock, seed}];
  if (auto shared = entry.lock()) return shared;
  auto fresh = std::make_shared<const StackTime>(StackTime{clock.now_ns()});
  entry = fresh;
  return fresh;
}

}  // namespace dts::device::sim
