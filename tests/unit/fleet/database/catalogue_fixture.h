// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "fleet/database/database.h"
#include "fleet/database/schema.h"
#include "support/postgres_server.h"

namespace dts::fleet::database {

/// A database with the tables of the centre: each test has a new one in a PostgreSQL that all tests of the program share.
class CatalogueTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (!server() && test::PostgresServer::programs()) server() = std::make_unique<test::PostgresServer>();
  }
  void SetUp() override {
    if (!server()) GTEST_SKIP() << "PostgreSQL is not installed";
    static int number = 0;
    name_ = "test" + std::to_string(++number);
    Database first({.connection = server()->connection(), .name = "test"});
    ASSERT_TRUE(first.run_script("CREATE DATABASE " + name_));
    database_ = std::make_unique<Database>(DatabaseOptions{.connection = connection(), .name = "test"});
    const auto migrated = migrate(*database_);
    ASSERT_TRUE(migrated) << migrated.error().what;
  }

  [[nodiscard]] static std::unique_ptr<test::PostgresServer>& server() {
    static std::unique_ptr<test::PostgresServer> only;
    return only;
  }
  [[nodiscard]] std::string connection(const std::string& user = "dts_hub") const { return server()->connection(name_, user); }
  [[nodiscard]] Database& database() { return *database_; }

  /// Executes a statement that must succeed.
  Rows sql(const std::string& statement, std::initializer_list<Parameter> parameters = {}) {
    auto rows = database_->run(statement, parameters);
    EXPECT_TRUE(rows) << statement << ": " << rows.error().what;
    return rows ? *std::move(rows) : Rows();
  }
  [[nodiscard]] std::int64_t number(const std::string& statement) { return sql(statement).integer(0, 0).value(); }
  [[nodiscard]] std::string text(const std::string& statement) { return sql(statement).text(0, 0); }

  void put_session(const std::string& clinic, const std::string& session, const std::string& protocol = "romberg",
                   const std::string& started = "2026-11-20", bool is_deleted = false) {
    sql("INSERT INTO session (clinic, id, revision, rig, protocol, state, started, planned_trials, is_deleted, fields) "
        "VALUES ($1, $2, 1, 'floor', $3, 'complete', $4, 4, $5, '{}')",
        {clinic, session, protocol, started, is_deleted});
  }
  /// `key`: in the store; empty: the recording has not arrived.
  void put_part(const std::string& clinic, const std::string& session, int part, const std::string& sha256, const std::string& key) {
    sql("INSERT INTO part (clinic, session, part, sha256, bytes, store_key) VALUES ($1, $2, $3, decode($4, 'hex'), 1, nullif($5, ''))",
        {clinic, session, part, sha256, key});
  }

 private:
  std::string name_;
  std::unique_ptr<Database> database_;
};

}  // namespace dts::fleet::database
