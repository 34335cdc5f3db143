// SPDX-License-Identifier: Apache-2.0
#include "record/catalogue/sqlite.h"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "unit/record/catalogue/catalogue_fixture.h"

namespace dts::record {
namespace {

using catalogue_test::code;
using catalogue_test::what;
using testing::HasSubstr;

class CatalogueFile : public catalogue_test::CatalogueFixture {
 protected:
  void write(const std::string& bytes) const { std::ofstream(path(), std::ios::binary) << bytes; }
  [[nodiscard]] std::string bytes() const {
    std::ifstream file(path(), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
};

/// Returns the error that `work` causes; an empty error if it causes none.
core::Error error_of(const Database& database, const std::function<void()>& work) {
  try {
    work();
  } catch (const SQLite::Exception& exception) {
    return database.failure(exception).value();
  }
  return {};
}

TEST_F(CatalogueFile, New_IsReadableForTheGroupOnly) {
  const mode_t before = ::umask(0);
  static_cast<void>(catalogue());
  ASSERT_TRUE(catalogue().append_audit({.who = "local"}));
  ::umask(before);
  for (const char* name : {"catalogue.sqlite", "catalogue.sqlite-wal", "catalogue.sqlite-shm", "catalogue.sqlite.audit"}) {
    struct stat facts {};
    ASSERT_EQ(::stat(path(name).c_str(), &facts), 0) << name;
    EXPECT_EQ(facts.st_mode & 07777U, 0640U) << name;
  }
}

TEST_F(CatalogueFile, OpenedAgain_IsTheSame) {
  ASSERT_TRUE(catalogue().begin_part(catalogue_test::facts(), "f"));
  close();
  EXPECT_TRUE(catalogue().session("s1"));
}

TEST_F(CatalogueFile, EveryWrite_IsDurableAndLoggedAhead) {
  static_cast<void>(catalogue());
  const auto database = Database::open(path());
  ASSERT_TRUE(database);
  auto mode = database->query("PRAGMA journal_mode");
  ASSERT_TRUE(mode.step());
  EXPECT_EQ(mode.text(0), "wal");
  EXPECT_EQ(database->number("PRAGMA synchronous"), 2);  // FULL
  EXPECT_EQ(database->number("PRAGMA foreign_keys"), 1);
  for (const char* wrong : {"SELECT x FROM none", "SELECT", R"(SELECT "text, not a name")"}) {
    const auto error = error_of(*database, [&] { static_cast<void>(database->number(wrong)); });
    EXPECT_THAT(error.what, testing::StartsWith("the catalogue (" + path() + "): ")) << wrong;
  }
}

TEST_F(CatalogueFile, NoFolder_IsNotFound) {
  const auto opened = Catalogue::open(path("none/catalogue.sqlite"));
  EXPECT_EQ(code(opened), core::ErrorCode::NotFound);
  EXPECT_THAT(what(opened), HasSubstr("none/catalogue.sqlite"));
}

TEST_F(CatalogueFile, FolderInItsPlace_FailsWithAReason) {
  std::filesystem::create_directory(path());
  EXPECT_THAT(what(Catalogue::open(path())), HasSubstr("Is a directory"));
}

TEST_F(CatalogueFile, PipeInItsPlace_DoesNotBlock) {
  ASSERT_EQ(::mkfifo(path().c_str(), 0600), 0);
  EXPECT_EQ(code(Catalogue::open(path())), core::ErrorCode::DataDamaged);
}

TEST_F(CatalogueFile, ReadOnlyFolder_IsNotAllowed) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  ASSERT_EQ(::chmod(folder_.c_str(), 0500), 0);
  const auto opened = Catalogue::open(path());
  EXPECT_EQ(::chmod(folder_.c_str(), 0700), 0);
  EXPECT_EQ(code(opened), core::ErrorCode::NotAllowed);
}

TEST_F(CatalogueFile, Garbage_SaysWhatToDo) {
  write("this is no database at all, whatever its name says" + std::string(4096, 'x'));
  const auto opened = Catalogue::open(path());
  EXPECT_EQ(code(opened), core::ErrorCode::DataDamaged);
  EXPECT_THAT(what(opened), HasSubstr("makes a new one from the recordings, without the audit trail"));
}

TEST_F(CatalogueFile, DamagedPages_AreNeverTakenForGood) {
  for (int index = 0; index < 200; ++index) {
    ASSERT_TRUE(catalogue().begin_part(catalogue_test::facts("s" + std::to_string(index)), std::string(200, 'f')));
  }
  close();
  const std::string good = bytes();
  ASSERT_GT(good.size(), 40'000U);
  int noticed = 0;
  for (std::size_t page = 1; page * 4096 < good.size(); ++page) {
    std::string bad = good;
    bad.replace(page * 4096, 64, 64, '\x5a');  // where a page says what it is
    write(bad);
    noticed += code(Catalogue::open(path())) == core::ErrorCode::DataDamaged ? 1 : 0;
  }
  EXPECT_EQ(static_cast<std::size_t>(noticed), good.size() / 4096 - 1);
}

TEST_F(CatalogueFile, OverwritingIsInterrupted_BeforeAllPagesAreRead) {
  for (int index = 0; index < 200; ++index) {
    ASSERT_TRUE(catalogue().begin_part(catalogue_test::facts("s" + std::to_string(index)), std::string(200, 'f')));
  }
  close();
  std::string bad = bytes();
  bad.replace(bad.size() - 4096, 64, 64, '\x5a');
  write(bad);
  ASSERT_EQ(code(Database::open(path())), core::ErrorCode::DataDamaged);
  EXPECT_THAT(what(Catalogue::overwrite_removed(path(), folder_, [] { return false; })), HasSubstr("interrupted"));
}

TEST_F(CatalogueFile, CutOff_IsDamaged) {
  for (int index = 0; index < 50; ++index) ASSERT_TRUE(catalogue().begin_part(catalogue_test::facts("s" + std::to_string(index)), "f"));
  close();
  write(bytes().substr(0, bytes().size() / 2));
  EXPECT_EQ(code(Catalogue::open(path())), core::ErrorCode::DataDamaged);
}

/// Files cannot grow beyond `bytes` in this process while it lives: what a full disk does.
class NoRoom {
 public:
  explicit NoRoom(std::uint64_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{.rlim_cur = bytes, .rlim_max = before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~NoRoom() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  NoRoom(const NoRoom&) = delete;
  NoRoom& operator=(const NoRoom&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int) = nullptr;
};

TEST_F(CatalogueFile, NoRoomForAWrite_FailsWithAReasonAndGoesOnLater) {
  ASSERT_TRUE(catalogue().begin_part(catalogue_test::facts("s1"), "f"));
  core::Status refused;
  {
    const NoRoom full(std::filesystem::file_size(path("catalogue.sqlite-wal")));
    refused = catalogue().begin_part(catalogue_test::facts("s2"), "f");
  }
  EXPECT_FALSE(refused);
  EXPECT_THAT(what(refused), HasSubstr("catalogue.sqlite"));
  EXPECT_EQ(code(catalogue().session("s2")), core::ErrorCode::NotFound);
  EXPECT_TRUE(catalogue().session("s1"));
  EXPECT_TRUE(catalogue().begin_part(catalogue_test::facts("s2"), "f"));
}

TEST_F(CatalogueFile, NoRoomAtAll_CannotBeOpenedAndIsNotLeftHalfMade) {
  bool is_open = true;
  {
    const NoRoom full(100);
    is_open = Catalogue::open(path()).has_value();
  }
  EXPECT_FALSE(is_open);
  EXPECT_TRUE(Catalogue::open(path()));
}

TEST_F(CatalogueFile, HeldByAnother_TimesOutWithAReason) {
  static_cast<void>(catalogue());
  const auto other = Database::open(path());
  ASSERT_TRUE(other);
  const Transaction held(*other);
  const auto refused = catalogue().begin_part(catalogue_test::facts(), "f");
  EXPECT_EQ(code(refused), core::ErrorCode::Timeout);
  EXPECT_THAT(what(refused), HasSubstr("only one dtsd"));
}

TEST_F(CatalogueFile, TransactionNotCommitted_IsUndone) {
  const auto database = Database::open(path());
  ASSERT_TRUE(database);
  database->execute("CREATE TABLE a (x TEXT)");
  {
    const Transaction outer(*database);
    Transaction inner(*database);
    database->run("INSERT INTO a VALUES (?)", "x");
    inner.commit();  // only as far as the outer one is
    EXPECT_TRUE(database->is_in_transaction());
  }
  EXPECT_FALSE(database->is_in_transaction());
  EXPECT_EQ(database->number("SELECT count(*) FROM a"), 0);
}

TEST_F(CatalogueFile, NumberBeyondSigned64Bit_IsRefusedNotWrapped) {
  const auto database = Database::open(path());
  ASSERT_TRUE(database);
  const auto error = error_of(*database, [&] { database->run("SELECT ?", std::numeric_limits<std::uint64_t>::max()); });
  EXPECT_EQ(error.code, core::ErrorCode::LimitExceeded);
}

TEST_F(CatalogueFile, ValueOfAnotherType_IsDamageAndNoCrash) {
  const auto database = Database::open(path());
  ASSERT_TRUE(database);
  auto row = database->query("SELECT 'text' AS a, NULL AS b, -1 AS c, 4294967296 AS d, x'00' AS e");
  ASSERT_TRUE(row.step());
  const std::vector<std::pair<std::string, std::function<void()>>> reads{
      {"a is of the wrong type", [&] { static_cast<void>(row.integer(0)); }},
      {"b is of the wrong type", [&] { static_cast<void>(row.text(1)); }},
      {"c = -1", [&] { static_cast<void>(row.count(2)); }},
      {"d = 4294967296", [&] { static_cast<void>(row.count32(3)); }},
      {"e is of the wrong type", [&] { static_cast<void>(row.text(4)); }},
      {"a is of the wrong type", [&] { static_cast<void>(row.number(0)); }},
  };
  for (const auto& [why, read] : reads) {
    const auto error = error_of(*database, read);
    EXPECT_EQ(error.code, core::ErrorCode::DataDamaged) << why;
    EXPECT_THAT(error.what, HasSubstr(path() + " is damaged: " + why));
  }
}

TEST_F(CatalogueFile, Text_ComesBackByteForByte) {
  const auto database = Database::open(path());
  ASSERT_TRUE(database);
  for (const std::string& text : {std::string(), std::string("a\0b", 3), std::string("'); DROP TABLE a; --"), std::string("\xff\xfe")}) {
    auto select = database->query("SELECT ?", text);
    ASSERT_TRUE(select.step());
    EXPECT_EQ(select.text(0), text);
  }
}

}  // namespace
}  // namespace dts::record
