// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

#include "core/log.h"
#include "core/result.h"

namespace dts::fleet::hub {

/// A matter that may fail again and again. Logs a failure once, and its end. Thread: one at a time.
class Problem {
 public:
  /// `log` must outlive this object.
  explicit Problem(const core::Log& log) : log_(log) {}

  void report(const core::Status& status) {
    std::string now = status ? "" : core::to_string(status.error());
    if (!now.empty() && now != last_) log_.error(now);
    if (now.empty() && !last_.empty()) log_.info("no longer: " + last_);
    last_ = std::move(now);
  }

 private:
  const core::Log& log_;
  std::string last_{};
};

}  // namespace dts::fleet::hub
