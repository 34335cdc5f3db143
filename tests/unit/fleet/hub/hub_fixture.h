// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <sodium.h>

#include <array>
#include <atomic>
#include <fstream>
#include <iterator>
#include <memory>
#include <sstream>
#include <string>

#include "core/clock.h"
#include "core/log.h"
#include "fleet/database/schema.h"
#include "fleet/hub/catalogue.h"
#include "fleet/hub/ingest.h"
#include "support/postgres_server.h"
#include "support/temporary_folder.h"

namespace dts::fleet::hub {

using database::Database;
using database::DatabaseOptions;
using database::migrate;

inline std::string sum_of(const std::string& bytes) {
  std::array<unsigned char, crypto_hash_sha256_BYTES> digest{};
  crypto_hash_sha256(digest.data(), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  return {digest.begin(), digest.end()};
}

inline std::string content_of(const std::string& file) {
  std::ifstream opened(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(opened), {}};
}

/// One PostgreSQL for all tests of the program, and a new database for each.
class DatabaseTest : public testing::Test {
 protected:
  static test::PostgresServer& server() {
    static const auto running = std::make_unique<test::PostgresServer>();
    return *running;
  }
  void SetUp() override {
    if (!test::PostgresServer::programs()) GTEST_SKIP() << "PostgreSQL is not installed";
    static std::atomic<int> count{0};
    const std::string name = "test" + std::to_string(++count);
    Database main({.connection = server().connection(), .name = "test"});
    const auto created = main.run("CREATE DATABASE " + name);
    ASSERT_TRUE(created) << core::to_string(created.error());
    connection_ = server().connection() + " dbname=" + name;
    database_ = open_database();
    const auto migrated = migrate(*database_);
    ASSERT_TRUE(migrated) << core::to_string(migrated.error());
    catalogue_ = std::make_unique<Catalogue>(*database_);
  }
  [[nodiscard]] std::unique_ptr<Database> open_database() const {
    return std::make_unique<Database>(DatabaseOptions{.connection = connection_, .name = "test"});
  }
  /// Returns the first column of the first row.
  [[nodiscard]] std::string value(const std::string& sql) {
    const auto rows = database_->run(sql);
    if (!rows) return core::to_string(rows.error());
    return rows->empty() ? "no row" : rows->text(0, 0);
  }

  std::string connection_;
  std::unique_ptr<Database> database_;
  std::unique_ptr<Catalogue> catalogue_;
};

inline v1::FleetSession session_of(const std::string& id, std::uint64_t revision) {
  v1::FleetSession session;
  session.set_session_id(id);
  session.set_revision(revision);
  session.set_rig("floor");
  session.set_protocol("romberg");
  session.set_subject("P017");
  session.set_state("complete");
  session.set_started_utc_ns(1'763'736'325'125'000'000);
  session.set_ended_utc_ns(1'763'736'385'000'000'000);
  session.set_planned_trials(2);
  (*session.mutable_fields())["arm_length_cm"] = "71";
  auto& part = *session.add_parts();
  part.set_part(1);
  part.set_state(v1::PART_STATE_COMPLETE);
  part.set_sha256(sum_of("recording of " + id));
  part.set_bytes(1000);
  part.set_scans(100);
  part.set_duration_s(1.5);
  auto& trial = *session.add_trials();
  trial.set_part(1);
  trial.set_trial(1);
  trial.set_attempt(1);
  trial.set_block(1);
  trial.set_condition("eyes \"open\", \\ both");
  trial.set_outcome("done");
  auto& result = *session.add_results();
  result.set_name("MVELO");
  result.set_value(8.38);
  result.set_unit("mm/s");
  return session;
}

}  // namespace dts::fleet::hub
