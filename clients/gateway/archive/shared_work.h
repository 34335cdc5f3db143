// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"
#include "gateway/archive/worker.h"

namespace dts::gateway {

/// Makes things on workers: each thing once, even if several callers request it meanwhile. Thread: io, but for `Make`.
template <class Thing>
class SharedWork {
 public:
  using Make = std::function<core::Result<Thing>(const std::stop_token& stop)>;
  using Made = std::function<void(const core::Result<Thing>& thing)>;

  /// Calls `keep` once for each thing, before the callers get it.
  explicit SharedWork(std::function<void(const std::string& key, const Thing& thing)> keep) : keep_(std::move(keep)) {}

  /// Returns false and starts nothing if too much work is waiting for this worker, which must end before this object.
  [[nodiscard]] bool ask(Worker& worker, const std::string& key, Make make, Made made) {
    if (const auto under_way = askers_.find(key); under_way != askers_.end()) {
      under_way->second.push_back(std::move(made));
      return true;
    }
    const bool is_accepted = worker.submit([this, key, make = std::move(make)](const std::stop_token& stop) -> Worker::Answer {
      auto thing = std::make_shared<core::Result<Thing>>(made_by(make, stop));
      return [this, key, thing] { answer(key, *thing); };
    });
    if (is_accepted) askers_[key].push_back(std::move(made));
    return is_accepted;
  }

 private:
  /// If memory runs out, one answer fails, not the gateway.
  static core::Result<Thing> made_by(const Make& make, const std::stop_token& stop) {
    try {
      return make(stop);
    } catch (const std::exception& problem) {
      return core::fail(core::ErrorCode::Failed, std::string("cannot prepare this: ") + problem.what());
    }
  }

  void answer(const std::string& key, const core::Result<Thing>& thing) {
    if (thing) keep_(key, *thing);
    const auto askers = askers_.extract(key);  // a caller may request again
    for (const Made& made : askers.mapped()) made(thing);
  }

  std::function<void(const std::string& key, const Thing& thing)> keep_;
  std::map<std::string, std::vector<Made>> askers_;
};

}  // namespace dts::gateway
