// SPDX-License-Identifier: Apache-2.0
#include "fleet/database/database.h"

#include "unit/fleet/database/catalogue_fixture.h"

namespace dts::fleet::database {
namespace {

using ::testing::HasSubstr;

using DatabaseTest = CatalogueTest;

TEST_F(DatabaseTest, ServerThatEnds_IsUnreachable_UntilItIsBack) {
  Database listening({.connection = connection(), .name = "listening"});
  listening.listen("job");
  ASSERT_TRUE(listening.wait_notification(std::chrono::milliseconds(0)).value());
  server()->stop(SIGQUIT);
  for (Database* const each : {&database(), &listening}) {
    for (int statement = 0; statement < 3; ++statement) {
      const auto rows = each->run("SELECT 1");
      ASSERT_FALSE(rows);
      EXPECT_EQ(rows.error().code, core::ErrorCode::Unreachable) << rows.error().what;
      EXPECT_GT(rows.error().what.size(), std::string("PostgreSQL: ").size());
    }
    const auto written = each->transaction([&] { return each->run("SELECT 1"); });
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, core::ErrorCode::Unreachable) << written.error().what;
  }
  server()->start();
  while (!database().run("SELECT 1") || !listening.run("SELECT 1")) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_TRUE(listening.wait_notification(std::chrono::milliseconds(0)).value()) << "it may have missed some";
}

TEST_F(DatabaseTest, ConnectionThatEndsWithinATransaction_DoesNotExecuteTheRest) {
  const auto done = database().transaction([&]() -> core::Result<Rows> {
    DTS_TRY(database().run("CREATE TABLE first ()"));
    Database other({.connection = connection(), .name = "other"});
    EXPECT_TRUE(other.run("SELECT pg_terminate_backend(pid, 10000) FROM pg_stat_activity WHERE application_name = 'test'"));
    EXPECT_FALSE(database().run("CREATE TABLE second ()"));
    return database().run("CREATE TABLE third ()");
  });
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, core::ErrorCode::Unreachable) << done.error().what;
  while (!database().run("SELECT 1")) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(number("SELECT count(*) FROM pg_tables WHERE tablename IN ('first', 'second', 'third')"), 0);
}

TEST_F(DatabaseTest, Errors_HaveTheirCodes) {
  EXPECT_EQ(database().run("SELECT '2026-13-40'::date").error().code, core::ErrorCode::InvalidArgument);
  EXPECT_EQ(database().run("INSERT INTO clinic (id, title, nkey) VALUES ('NOT A NAME', '', '')").error().code, core::ErrorCode::WrongState);
  EXPECT_EQ(database().run("SELECT nothing").error().code, core::ErrorCode::Failed);
  EXPECT_THAT(database().run("SELECT nothing").error().what, HasSubstr("nothing"));
}

TEST_F(DatabaseTest, Column_KeepsEveryText) {
  Column column;
  for (const char* const text : {"plain", "a \"quote\"", "back\\slash", "{a,b}", "", "NULL"}) column.add(text);
  column.add(nullptr);
  const Rows rows = sql("SELECT u, u IS NULL FROM unnest($1::text[]) u", {column.parameter()});
  ASSERT_EQ(rows.size(), 7U);
  EXPECT_EQ(rows.text(1, 0), "a \"quote\"");
  EXPECT_EQ(rows.text(2, 0), "back\\slash");
  EXPECT_EQ(rows.text(3, 0), "{a,b}");
  EXPECT_EQ(rows.text(5, 0), "NULL");
  EXPECT_FALSE(rows.boolean(5, 1));
  EXPECT_TRUE(rows.boolean(6, 1));
}

}  // namespace
}  // namespace dts::fleet::database
