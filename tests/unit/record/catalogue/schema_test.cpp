// SPDX-License-Identifier: Apache-2.0
#include "record/catalogue/schema.h"

#include <gmock/gmock.h>

#include <array>
#include <fstream>

#include "unit/record/catalogue/catalogue_fixture.h"

namespace dts::record {
namespace {

using catalogue_test::code;
using catalogue_test::what;
using testing::HasSubstr;

class CatalogueSchema : public catalogue_test::CatalogueFixture {
 protected:
  [[nodiscard]] Database open() const {
    auto opened = Database::open(path());
    if (!opened) throw std::runtime_error(core::to_string(opened.error()));
    return std::move(*opened);
  }
};

constexpr std::array<const char*, 3> kMade{"CREATE TABLE a (x TEXT) STRICT", "ALTER TABLE a ADD COLUMN y INTEGER NOT NULL DEFAULT 7",
                                           "CREATE TABLE b (z TEXT) STRICT"};

TEST_F(CatalogueSchema, OlderVersion_IsLedForwardAndKeepsItsRows) {
  {
    const Database old = open();
    ASSERT_TRUE(migrate(old, std::span(kMade).first(1)));
    old.run("INSERT INTO a (x) VALUES (?)", "kept");
  }
  const Database database = open();
  ASSERT_TRUE(migrate(database, kMade));
  EXPECT_EQ(database.number("PRAGMA user_version"), 3);
  EXPECT_EQ(database.number("SELECT y FROM a WHERE x = 'kept'"), 7);
  EXPECT_EQ(database.number("SELECT count(*) FROM b"), 0);
}

TEST_F(CatalogueSchema, TrialsOfAnOlderCatalogue_AreCountedAsThoseOfANewOne) {
  {
    const Database old = open();
    ASSERT_TRUE(migrate(old, catalogue_migrations().first(3)));
    old.execute(
        "INSERT INTO protocols VALUES (1, 'p', '', ''); INSERT INTO sessions VALUES ('s1', 'floor', 1, NULL, '', 'complete', '', 1, 2);"
        "INSERT INTO parts (session_id, part, file, state, sha256, bytes, scans, duration_s, lost_s_at_most, reason,"
        " started_utc_ns, calibration_id) VALUES ('s1', 1, 'f', 2, '', 0, 0, 0, 0, '', 1, '')");
    for (const char* row : {R"(1, 'done', '{"event":"sway","segment":0,"scan":0,"is_valid":true}')",
                            R"(2, 'done', '{"event":"sway","segment":0,"scan":0,"is_valid":false}')",
                            R"(3, 'done', '{"event":"sway","segment":0,"scan":0,"problem":"x"}')", R"(4, 'redone', '')", R"(5, 'done', '')",
                            R"(6, 'done', '{')", R"(7, 'done', '{"scan":9,"trial_result":{"trial":7}}')",
                            R"(8, 'done', '{"scan":9,"trial_result":{"trial":8,"reach":{"number":1}}}')"}) {
      old.execute(
          "INSERT INTO trials (session_id, part, attempt, block, condition, segment, first_scan, last_segment,"
          " last_scan, trial, outcome, result) VALUES ('s1', 1, 1, 1, '', 0, 0, 0, 0, " +
          std::string(row) + ")");
    }
  }
  EXPECT_EQ(catalogue().session("s1")->parts[0].valid_trials, 3U);
}

TEST_F(CatalogueSchema, NothingToDo_IsDoneAgainWithoutHarm) {
  const Database database = open();
  ASSERT_TRUE(migrate(database, kMade));
  EXPECT_TRUE(migrate(database, kMade));
}

TEST_F(CatalogueSchema, MigrationThatFails_LeavesTheVersionBefore) {
  constexpr std::array<const char*, 2> kBroken{"CREATE TABLE a (x TEXT) STRICT", "CREATE TABLE c (y TEXT) STRICT; CREATE TABLE a (x TEXT)"};
  const Database database = open();
  EXPECT_FALSE(migrate(database, kBroken));
  EXPECT_EQ(database.number("PRAGMA user_version"), 1);
  EXPECT_EQ(database.number("SELECT count(*) FROM sqlite_schema WHERE name = 'c'"), 0);
  EXPECT_TRUE(migrate(database, kMade));  // a program whose migrations work goes on from there
}

TEST_F(CatalogueSchema, NewerVersion_IsRefusedAndNotTouched) {
  static_cast<void>(catalogue());
  close();
  ASSERT_TRUE(meddle("PRAGMA user_version = 99"));
  const auto opened = Catalogue::open(path());
  EXPECT_EQ(code(opened), core::ErrorCode::Unsupported);
  EXPECT_THAT(what(opened), HasSubstr("version 99, this dtsd knows up to 10"));
  EXPECT_EQ(open().number("PRAGMA user_version"), 99);
}

TEST_F(CatalogueSchema, NegativeVersion_IsRefused) {
  static_cast<void>(catalogue());
  close();
  ASSERT_TRUE(meddle("PRAGMA user_version = -1"));
  EXPECT_EQ(code(Catalogue::open(path())), core::ErrorCode::Unsupported);
}

TEST_F(CatalogueSchema, DatabaseOfAnotherProgram_IsRefusedAndNotTouched) {
  ASSERT_TRUE(meddle("CREATE TABLE theirs (x); PRAGMA journal_mode = DELETE"));
  const auto opened = Catalogue::open(path());
  EXPECT_EQ(code(opened), core::ErrorCode::WrongState);
  EXPECT_THAT(what(opened), HasSubstr("database of another program"));
  EXPECT_EQ(open().number("SELECT count(*) FROM sqlite_schema"), 1);
}

TEST_F(CatalogueSchema, MarkOfAnotherProgram_IsRefusedEvenWithoutTables) {
  ASSERT_TRUE(meddle("PRAGMA application_id = 12345"));
  EXPECT_EQ(code(Catalogue::open(path())), core::ErrorCode::WrongState);
}

TEST_F(CatalogueSchema, EveryTable_RefusesTextInANumber) {
  static_cast<void>(catalogue());
  ASSERT_TRUE(catalogue().begin_part(catalogue_test::facts(), "f"));
  EXPECT_FALSE(meddle("UPDATE parts SET scans = 'many'"));
  EXPECT_FALSE(meddle("UPDATE parts SET state = 7"));
  EXPECT_FALSE(meddle("UPDATE sessions SET state = 'odd'"));
  EXPECT_TRUE(meddle("UPDATE parts SET scans = 5"));
}

}  // namespace
}  // namespace dts::record
