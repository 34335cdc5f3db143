// SPDX-License-Identifier: Apache-2.0
// How many sessions a second the catalogue of a centre takes, with four connections as the hub has them. Use a database that desk_bench has
// filled: desk_bench --connection "host=... dbname=..." --rounds 1. Prints a Markdown table.
#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "fleet/database/schema.h"
#include "fleet/hub/catalogue.h"

namespace {

using dts::fleet::database::Database;
using dts::fleet::hub::Catalogue;

constexpr int kConnections = 4;

/// A session of some protocol: one part, 9 trials, `results` results.
dts::v1::FleetSession session_of(int results) {
  dts::v1::FleetSession session;
  session.set_rig("floor");
  session.set_protocol("romberg");
  session.set_subject("P017");
  session.set_state("complete");
  session.set_started_utc_ns(1'763'736'325'000'000'000);
  auto& part = *session.add_parts();
  part.set_part(1);
  part.set_state(dts::v1::PART_STATE_COMPLETE);
  part.set_bytes(20'000'000);
  for (std::uint32_t number = 1; number <= 9; ++number) {
    auto& trial = *session.add_trials();
    trial.set_part(1);
    trial.set_trial(number);
    trial.set_attempt(1);
    trial.set_condition("eyes-open");
    trial.set_outcome("done");
  }
  for (int number = 0; number < results; ++number) {
    auto& result = *session.add_results();
    result.set_name("eyes-open/MEASURE" + std::to_string(number));
    result.set_value(number);
    result.set_unit("mm");
  }
  return session;
}

/// Returns sessions a second.
double put(const std::string& connection, const std::string& name, int sessions, int results, std::uint64_t revision) {
  std::atomic<int> next{0};
  std::atomic<int> done{0};
  const auto begun = std::chrono::steady_clock::now();
  {
    std::vector<std::jthread> threads;
    for (int thread = 0; thread < kConnections; ++thread) {
      threads.emplace_back([&, thread] {
        Database database({.connection = connection, .name = "catalogue_bench"});
        Catalogue catalogue(database, dts::fleet::hub::QuotaFigures{});
        auto session = session_of(results);
        session.set_revision(revision);
        for (int number = next++; number < sessions; number = next++) {
          session.set_session_id(name + "-" + std::to_string(number));
          done += catalogue.put_session("bench-" + std::to_string(number % 20), session) ? 1 : 0;
        }
      });
    }
  }
  if (done != sessions) throw std::runtime_error("some sessions were not stored");
  return sessions / std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

}  // namespace

int main(int count, char** words) {
  CLI::App app("Sessions a second that the catalogue of a centre takes");
  int sessions = 2000;
  std::string connection;
  app.add_option("--sessions", sessions, "Sessions of each line");
  app.add_option("--connection", connection, "A database, as libpq understands it")->required();
  CLI11_PARSE(app, count, words);
  Database database({.connection = connection, .name = "catalogue_bench"});
  if (const auto migrated = dts::fleet::database::migrate(database); !migrated) {
    std::fprintf(stderr, "%s\n", dts::core::to_string(migrated.error()).c_str());
    return 1;
  }
  const auto name = std::to_string(std::chrono::system_clock::now().time_since_epoch().count());
  std::printf("| results of a session | new sessions/s | newer revisions/s |\n|---|---|---|\n");
  for (const int results : {5, 50, 300}) {
    const std::string id = name + "-" + std::to_string(results);
    const double added = put(connection, id, sessions, results, 1);
    const double replaced = put(connection, id, sessions, results, 2);
    std::printf("| %d | %.0f | %.0f |\n", results, added, replaced);
  }
  return 0;
}
