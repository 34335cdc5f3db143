// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fleet/database/database.h"

// The operator's side of table `job`: one analysis of one recording by a worker. The worker's side is in fleet/worker/job_queue.h.
// All functions fail as `Database` does. Thread: that of the database.

namespace dts::fleet::database {

/// Recordings to analyse: those in the store, of the leading rigs of sessions that the clinic has not hidden. An empty text does not
/// select.
struct NewJobs {
  std::string kind;     ///< A name of worker::kind_names().
  std::string version;  ///< Of dtslab, "0.1.0": only workers with this dtslab take the jobs.
  std::string clinic{};
  std::string protocol{};
  std::string since{};  ///< Sessions that started on this day (UTC) or later: "2026-11-26".
};

/// Adds one job for each recording that has no job of this kind and version yet. Returns how many were added. Workers start at once. Fails
/// with InvalidArgument if `since` is not a date.
[[nodiscard]] core::Result<std::uint64_t> add_jobs(Database& database, const NewJobs& jobs);

struct JobFilter {
  std::string kind{};
  std::string clinic{};
  std::string state{};  ///< "waiting", "running", "done", "failed"; empty: all, as above.
  std::uint32_t limit = 100;
};

struct Job {
  std::int64_t id = 0;
  std::string kind;
  std::string version;
  std::string clinic;
  std::string session;
  std::int64_t part = 0;
  std::string state;
  std::int64_t tries = 0;
  std::string worker;   ///< That has or had it; empty: none.
  std::string message;  ///< Why it failed, or what was remarkable; may be empty.
};

/// Returns the newest jobs first.
[[nodiscard]] core::Result<std::vector<Job>> list_jobs(Database& database, const JobFilter& filter);

/// Makes failed jobs wait again, as if they were new. `state` and `limit` of the filter are not used. Returns how many.
[[nodiscard]] core::Result<std::uint64_t> retry_jobs(Database& database, const JobFilter& filter);

}  // namespace dts::fleet::database
