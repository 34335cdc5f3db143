// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/result.h"
#include "dts/control_client.h"
#include "dts/v1/control.pb.h"
#include "dts/v1/sessions.pb.h"

namespace dts::fleet::forward {

inline constexpr std::uint32_t kMostListed = 10'000;  ///< Longest list of sessions or audit entries that dtsd sends.

/// What the outbox asks dtsd. A seam: the tests have one without a daemon. Thread: one.
class Clinic {
 public:
  Clinic() = default;
  virtual ~Clinic() = default;
  Clinic(const Clinic&) = delete;
  Clinic& operator=(const Clinic&) = delete;

  /// Returns sessions, newest first, or the deleted ones. Fails with Unreachable while dtsd does not answer, as all functions here.
  [[nodiscard]] virtual core::Result<v1::ListSessionsResponse> list(std::uint32_t limit, bool deleted) = 0;
  /// Fails with NotFound if dtsd does not have the session.
  [[nodiscard]] virtual core::Result<v1::SessionRecord> show(const std::string& session) = 0;
  /// Returns the newest entries of the audit trail, oldest first.
  [[nodiscard]] virtual core::Result<v1::GetAuditResponse> audit(std::uint32_t limit) = 0;
};

/// dtsd on this machine. `endpoint`: of its control socket. Fails with InvalidArgument for one that cannot be.
[[nodiscard]] core::Result<std::unique_ptr<Clinic>> open_clinic(const std::string& endpoint);

/// Returns an error of libdts as one of ours: both have the same codes.
[[nodiscard]] core::Error error_of(const client::Error& error);

}  // namespace dts::fleet::forward
