// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "core/log.h"
#include "core/result.h"
#include "fleet/s3/settings.h"
#include "fleet/worker/confined_program.h"

namespace dts::fleet::worker {

struct WorkerOptions {
  std::string dtslab = "/usr/bin/dtslab";
  std::string connection{};          ///< To PostgreSQL, as libpq understands it.
  std::string store{};               ///< Folder of the recordings, [store] directory of dts-hub.
  std::optional<s3::Settings> s3{};  ///< The bucket of the recordings, [store.s3] of dts-hub; `store` is then not used.
  Limits limits{};                   ///< Of one run of dtslab.
  std::chrono::seconds lease{60};
  std::chrono::seconds retry_pause{10};
};

/// Takes jobs and executes them one after another, until SIGTERM or SIGINT, which the caller has blocked. A job that was not ended by then
/// goes back to the others. Without the database it tries again, without end. Fails if dtslab cannot be started or has no version.
/// Thread: the process must have only one.
[[nodiscard]] core::Status run_worker(const WorkerOptions& options, const core::Log& log);

}  // namespace dts::fleet::worker
