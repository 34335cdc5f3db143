// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>

namespace dts::fleet::hub {

/// The clinics that are not revoked, as the database had them last. nats-server rejects revoked clinics; this rejects what they have sent
/// before. Thread: any.
class ClinicList {
 public:
  void set(std::set<std::string> active) {
    const std::lock_guard lock(mutex_);
    active_ = std::move(active);
  }
  /// Returns true also while nothing is known, because the database has not answered yet: nats-server has checked the clinic.
  [[nodiscard]] bool is_allowed(const std::string& clinic) const {
    const std::lock_guard lock(mutex_);
    return !active_ || active_->contains(clinic);
  }

 private:
  mutable std::mutex mutex_;
  std::optional<std::set<std::string>> active_{};
};

}  // namespace dts::fleet::hub
