// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <mutex>

#include "core/log.h"
#include "core/result.h"
#include "fleet/link/link.h"

namespace dts::fleet::desk {

/// The connection to nats-server. A link whose key was rejected is replaced by a new one, at most every 5 s. Thread: any.
class Nats {
 public:
  /// Fails with InvalidArgument for wrong options; does not wait for the server.
  [[nodiscard]] static core::Result<std::unique_ptr<Nats>> open(const link::LinkOptions& options, const core::Log& log);

  [[nodiscard]] std::shared_ptr<link::Link> link();

 private:
  Nats(link::LinkOptions options, core::Log log, std::shared_ptr<link::Link> link);

  const link::LinkOptions options_;
  const core::Log log_;
  std::mutex mutex_;
  std::shared_ptr<link::Link> link_;
  std::chrono::steady_clock::time_point opened_at_ = std::chrono::steady_clock::now();
};

}  // namespace dts::fleet::desk
