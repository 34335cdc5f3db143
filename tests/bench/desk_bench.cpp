// SPDX-License-Identifier: Apache-2.0
// How long the pages of a fleet's dashboard take, with a million sessions in a real PostgreSQL. Prints a Markdown table.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>

#include "bench/percentiles.h"
#include "fleet/database/schema.h"
#include "fleet/desk/pages.h"
#include "support/postgres_server.h"

namespace {

using dts::fleet::database::Database;
using namespace dts::fleet::desk;

void check(const dts::core::Status& done) {
  if (!done) throw std::runtime_error(dts::core::to_string(done.error()));
}

/// 50 clinics; each session has 5 results and one part.
void fill(Database& database, int sessions) {
  check(dts::fleet::database::migrate(database));
  const std::string count = std::to_string(sessions);
  for (const std::string& statement :
       {std::string("SET statement_timeout = 0"),
        std::string("INSERT INTO clinic (id, title, nkey) SELECT 'clinic-' || c, 'Clinic ' || c, 'U' || c FROM generate_series(1, 50) c"),
        std::string("INSERT INTO beat SELECT id, now(), 0, '0.1.0', true, '0.1.0', 'fine', 500000000000, 360000, 0, 0, NULL, now(), 0 "
                    "FROM clinic"),
        std::string("INSERT INTO rig SELECT c.clinic, r, r, 16, 'streaming', 1500, 1500, 1, 0, 0, 'idle', '', 'c1', now(), '{cop}', c.at "
                    "FROM beat c, unnest(ARRAY['floor', 'chair']) r"),
        "INSERT INTO session (clinic, id, revision, rig, protocol, subject, state, started, planned_trials, is_deleted, fields) SELECT "
        "'clinic-' || 1 + (hashint4(i) & 31), to_char(t, 'YYYYMMDD\"T\"HH24MISS\"Z\"') || '-' || i, 1, CASE WHEN hashint4(i + 7) % 5 = 0 "
        "THEN "
        "'chair' ELSE 'floor' END, (ARRAY['quiet-standing', 'romberg', 'mctsib', 'reach'])[1 + (hashint4(i + 3) & 3)], 'P' || i % 20000, "
        "'complete', t, 4, false, '{}' FROM (SELECT i, timestamptz '2024-01-01' + i * interval '90 s' AS t FROM generate_series(1, " +
            count + ") i) x",
        std::string("INSERT INTO result (clinic, session, name, analysis, value, unit) SELECT clinic, id, m, 'clinic', 5 + 10 * random(), "
                    "'mm/s' FROM session, unnest(ARRAY['MVELO', 'RDIST', 'PEA95_F', 'RANGE_AP', 'RANGE_ML']) m"),
        std::string(
            "INSERT INTO part (clinic, session, part, bytes, duration_s, valid_trials, lost_scans, store_key) SELECT clinic, id, 1, "
            "20000000, 180, 4, 0, 'x' FROM session"),
        std::string("VACUUM ANALYZE"), std::string("RESET statement_timeout")}) {
    std::fprintf(stderr, "%.60s ...\n", statement.c_str());
    check(database.run_script(statement));
  }
}

void measure(Database& database, const char* name, int rounds, const std::function<dts::core::Result<std::string>(Database&)>& page) {
  dts::bench::Percentiles times(static_cast<std::size_t>(rounds));
  std::size_t bytes = 0;
  for (int round = 0; round < rounds; ++round) {
    const auto began = std::chrono::steady_clock::now();
    const auto document = page(database);
    times.add_ns(std::chrono::nanoseconds(std::chrono::steady_clock::now() - began).count());
    if (!document) throw std::runtime_error(dts::core::to_string(document.error()));
    bytes = document->size();
  }
  times.sort();
  std::printf("| %s | %.1f | %.1f | %.1f |\n", name, times.us(0.5) * 1e-3, times.us(1.0) * 1e-3, static_cast<double>(bytes) * 1e-3);
}

}  // namespace

int main(int count, char** words) {
  CLI::App app("Times of the pages of a fleet's dashboard");
  int sessions = 1'000'000;
  int rounds = 20;
  std::string connection;
  bool is_filled = false;
  app.add_option("--sessions", sessions, "Sessions in the database");
  app.add_option("--rounds", rounds, "Requests of each page");
  app.add_option("--connection", connection, "A database to use instead of a new PostgreSQL");
  app.add_flag("--filled", is_filled, "That database has its sessions already");
  CLI11_PARSE(app, count, words);
  if (connection.empty() && !dts::test::PostgresServer::programs()) {
    std::fprintf(stderr, "PostgreSQL is not installed\n");
    return 1;
  }
  const auto server = connection.empty() ? std::make_unique<dts::test::PostgresServer>() : nullptr;
  Database database({.connection = server ? server->connection() : connection, .name = "desk_bench"});
  if (!is_filled) fill(database, sessions);
  const auto list = [](SessionFilter filter) { return [filter](Database& with) { return sessions_page(with, filter); }; };
  const SessionKey middle{
      .started_us = 1'704'067'200'000'000 + static_cast<std::int64_t>(sessions) * 45'000'000, .clinic = "clinic-3", .id = "x"};
  std::printf("| page | median (ms) | longest (ms) | size (kB) |\n|---|---|---|---|\n");
  measure(database, "clinics", rounds, [](Database& with) { return clinics_page(with, "0.1.0"); });
  measure(database, "one clinic", rounds, [](Database& with) { return clinic_page(with, "0.1.0", "clinic-7"); });
  measure(database, "newest sessions", rounds, list({}));
  measure(database, "sessions from the middle", rounds, list({.before = middle}));
  measure(database, "sessions of a clinic", rounds, list({.clinic = "clinic-7"}));
  measure(database, "sessions of a rig", rounds, list({.rig = "chair"}));
  measure(database, "sessions of a protocol", rounds, list({.protocol = "reach"}));
  measure(database, "sessions of clinic, rig and protocol", rounds, list({.clinic = "clinic-7", .rig = "chair", .protocol = "mctsib"}));
  measure(database, "sessions of a subject", rounds, list({.subject = "P17"}));
  measure(database, "trend of one measure, all sessions", rounds, [](Database& with) { return trend_page(with, {.measure = "MVELO"}); });
  measure(database, "trend of one protocol", rounds,
          [](Database& with) { return trend_page(with, {.measure = "MVELO", .protocol = "reach"}); });
  measure(database, "trend of one clinic", rounds,
          [](Database& with) { return trend_page(with, {.measure = "MVELO", .clinic = "clinic-7"}); });
  measure(database, "measures", rounds, [](Database& with) { return measures_page(with); });
  return 0;
}
