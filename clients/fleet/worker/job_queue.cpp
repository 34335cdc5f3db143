// SPDX-License-Identifier: Apache-2.0
#include "fleet/worker/job_queue.h"

#include <limits>

#include "fleet/worker/kinds.h"

namespace dts::fleet::worker {
namespace {

using database::Column;
using database::Rows;

/// Worker and tries together name this take: a job that was taken again has other ones.
constexpr const char* kIsMine = " WHERE id = $1 AND worker = $2 AND tries = $3 AND state = 'running'";

}  // namespace

core::Result<std::optional<TakenJob>> JobQueue::take() {
  Column kinds;
  for (const std::string_view kind : kind_names()) kinds.add(kind);
  // SKIP LOCKED: workers that take at the same time take different jobs, and none waits.
  DTS_TRY_ASSIGN(
      const Rows rows,
      database_.run("UPDATE job j SET state = 'running', worker = $1, lease_until = now() + $2::bigint * interval '1 second', "
                    "tries = tries + 1, message = '' WHERE id = (SELECT id FROM job WHERE state IN ('waiting', 'running') AND version = $3 "
                    "AND kind = ANY ($4::text[]) AND (lease_until IS NULL OR lease_until < now()) AND tries < $5::bigint "
                    "ORDER BY tries, id LIMIT 1 FOR UPDATE SKIP LOCKED) "
                    "RETURNING id, kind, clinic, session, part, tries, "
                    "(SELECT encode(p.sha256, 'hex') FROM part p WHERE p.clinic = j.clinic AND p.session = j.session AND p.part = j.part), "
                    "(SELECT p.store_key FROM part p WHERE p.clinic = j.clinic AND p.session = j.session AND p.part = j.part)",
                    {options_.worker, options_.lease.count(), options_.version, kinds.parameter(), kMostTries}));
  if (rows.empty()) {
    DTS_TRY(
        database_.run("UPDATE job SET state = 'failed', lease_until = NULL, message = 'the worker ended during each try' "
                      "WHERE state = 'running' AND lease_until < now() AND tries >= $1::bigint",
                      {kMostTries}));
    return std::optional<TakenJob>();
  }
  TakenJob job{.kind = rows.text(0, 1),
               .clinic = rows.text(0, 2),
               .session = rows.text(0, 3),
               .sha256 = rows.text(0, 6),
               .store_key = rows.text(0, 7)};
  DTS_TRY_ASSIGN(job.id, rows.integer(0, 0));
  DTS_TRY_ASSIGN(job.tries, rows.integer(0, 5));
  DTS_TRY_ASSIGN(const std::int64_t part, rows.integer(0, 4));
  if (part < 1 || part > std::numeric_limits<std::uint32_t>::max())
    return core::fail(core::ErrorCode::DataDamaged, "job " + std::to_string(job.id) + ": no part " + std::to_string(part));
  job.part = static_cast<std::uint32_t>(part);
  return std::optional(std::move(job));
}

core::Result<bool> JobQueue::renew(const TakenJob& job) {
  DTS_TRY_ASSIGN(const Rows rows,
                 database_.run(std::string("UPDATE job SET lease_until = now() + $4::bigint * interval '1 second'") + kIsMine,
                               {job.id, options_.worker, job.tries, options_.lease.count()}));
  return rows.changed() == 1;
}

core::Result<bool> JobQueue::finish(const TakenJob& job, const std::vector<Figure>& figures, const std::string& message) {
  return database_.transaction([&] { return write(job, figures, message); });
}

core::Result<bool> JobQueue::write(const TakenJob& job, const std::vector<Figure>& figures, const std::string& message) {
  // First the job: until the commit nobody can take it again, and an erasure waits, and then removes these results as well.
  DTS_TRY_ASSIGN(const Rows rows, database_.run(std::string("UPDATE job SET state = 'done', lease_until = NULL, message = $4") + kIsMine,
                                                {job.id, options_.worker, job.tries, message}));
  if (rows.changed() != 1) return false;
  Column names, values, units, details;
  for (const Figure& figure : figures) {
    names.add(figure.name);
    values.add(figure.value);
    units.add(figure.unit);
    details.add(figure.details);
  }
  if (figures.empty()) return true;
  DTS_TRY(
      database_.run("INSERT INTO result (clinic, session, name, analysis, value, unit, details) "
                    "SELECT $1, $2, u.name, $3, u.value, u.unit, nullif(u.details, '')::jsonb "
                    "FROM unnest($4::text[], $5::float8[], $6::text[], $7::text[]) AS u (name, value, unit, details) "
                    "ON CONFLICT (clinic, session, name, analysis) "
                    "DO UPDATE SET value = excluded.value, unit = excluded.unit, details = excluded.details",
                    {job.clinic, job.session, job.kind + " " + options_.version, names.parameter(), values.parameter(), units.parameter(),
                     details.parameter()}));
  return true;
}

core::Result<bool> JobQueue::fail(const TakenJob& job, const std::string& message, bool is_final) {
  DTS_TRY_ASSIGN(
      const Rows rows,
      database_.run(std::string("UPDATE job SET state = CASE WHEN $4::boolean OR tries >= $5::bigint THEN 'failed' ELSE 'waiting' "
                                "END, lease_until = CASE WHEN $4::boolean OR tries >= $5::bigint THEN NULL ELSE now() + "
                                "$6::bigint * interval '1 second' END, message = $7") +
                        kIsMine,
                    {job.id, options_.worker, job.tries, is_final, kMostTries, options_.retry_pause.count(), message}));
  return rows.changed() == 1;
}

core::Result<bool> JobQueue::postpone(const TakenJob& job, const std::string& message) {
  DTS_TRY_ASSIGN(const Rows rows, database_.run(std::string("UPDATE job SET state = 'waiting', tries = tries - 1, worker = NULL, "
                                                            "lease_until = now() + $4::bigint * interval '1 second', message = $5") +
                                                    kIsMine,
                                                {job.id, options_.worker, job.tries, kMostTries * options_.retry_pause.count(), message}));
  return rows.changed() == 1;
}

core::Result<bool> JobQueue::give_back(const TakenJob& job) {
  DTS_TRY_ASSIGN(
      const Rows rows,
      database_.run(std::string("UPDATE job SET state = 'waiting', tries = tries - 1, lease_until = NULL, worker = NULL") + kIsMine,
                    {job.id, options_.worker, job.tries}));
  if (rows.changed() == 1) DTS_TRY(database_.run_script("NOTIFY job"));
  return rows.changed() == 1;
}

}  // namespace dts::fleet::worker
