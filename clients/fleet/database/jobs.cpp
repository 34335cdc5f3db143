// SPDX-License-Identifier: Apache-2.0
#include "fleet/database/jobs.h"

namespace dts::fleet::database {
namespace {

/// Executes a statement that changes jobs, and wakes the workers. A selection of all recordings may take minutes.
core::Result<std::uint64_t> change_jobs(Database& database, const std::string& sql, std::initializer_list<Parameter> parameters) {
  return database.transaction([&]() -> core::Result<std::uint64_t> {
    DTS_TRY(database.run_script("SET LOCAL statement_timeout = 0"));
    DTS_TRY_ASSIGN(const Rows rows, database.run(sql, parameters));
    // With statistics of before, the workers' statement would sort all jobs at each take.
    DTS_TRY(database.run_script("ANALYZE job; NOTIFY job"));
    return rows.changed();
  });
}

}  // namespace

core::Result<std::uint64_t> add_jobs(Database& database, const NewJobs& jobs) {
  return change_jobs(database,
                     "INSERT INTO job (kind, version, clinic, session, part) SELECT $1, $2, p.clinic, p.session, p.part "
                     "FROM part p JOIN session s ON s.clinic = p.clinic AND s.id = p.session "
                     "WHERE p.store_key IS NOT NULL AND p.leading_part = 0 AND NOT s.is_deleted AND ($3 = '' OR p.clinic = $3) AND ($4 = "
                     "'' OR s.protocol = $4) "
                     "AND ($5 = '' OR s.started >= nullif($5, '')::date) ORDER BY s.started, p.clinic, p.session, p.part "
                     "ON CONFLICT DO NOTHING",
                     {jobs.kind, jobs.version, jobs.clinic, jobs.protocol, jobs.since});
}

core::Result<std::vector<Job>> list_jobs(Database& database, const JobFilter& filter) {
  DTS_TRY_ASSIGN(const Rows rows, database.run("SELECT id, kind, version, clinic, session, part, state, tries, worker, message FROM job "
                                               "WHERE ($1 = '' OR kind = $1) AND ($2 = '' OR clinic = $2) AND ($3 = '' OR state = $3) "
                                               "ORDER BY id DESC LIMIT $4",
                                               {filter.kind, filter.clinic, filter.state, filter.limit}));
  std::vector<Job> jobs;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    Job job{.kind = rows.text(row, 1),
            .version = rows.text(row, 2),
            .clinic = rows.text(row, 3),
            .session = rows.text(row, 4),
            .state = rows.text(row, 6),
            .worker = rows.text(row, 8),
            .message = rows.text(row, 9)};
    DTS_TRY_ASSIGN(job.id, rows.integer(row, 0));
    DTS_TRY_ASSIGN(job.part, rows.integer(row, 5));
    DTS_TRY_ASSIGN(job.tries, rows.integer(row, 7));
    jobs.push_back(std::move(job));
  }
  return jobs;
}

core::Result<std::uint64_t> retry_jobs(Database& database, const JobFilter& filter) {
  return change_jobs(database,
                     "UPDATE job SET state = 'waiting', tries = 0, lease_until = NULL, worker = NULL, message = '' "
                     "WHERE state = 'failed' AND ($1 = '' OR kind = $1) AND ($2 = '' OR clinic = $2)",
                     {filter.kind, filter.clinic});
}

}  // namespace dts::fleet::database
