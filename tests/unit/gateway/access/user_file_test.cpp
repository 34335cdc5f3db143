// SPDX-License-Identifier: Apache-2.0
#include "gateway/access/user_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "unit/libdts/fake_daemon.h"

namespace dts::gateway {
namespace {

namespace fs = std::filesystem;

// What `hash_password` makes has this form; the words hashed are of no interest here.
const std::string kHash = "$argon2id$v=19$m=65536,t=2,p=1$c29tZXNhbHRzb21lc2FsdA$RdescudvJCsgt3ub+b+ded4qt7Rr5Vw4kbj4UO/vbBE";

std::string line_of(const std::string& name, const std::string& role = "viewer") { return name + ":" + role + ":" + kHash + "\n"; }

std::string problem_with(const std::string& text) {
  const auto users = parse_users(text, "users");
  return users ? "" : users.error().what;
}

TEST(Users, NamesRolesAndCommentsAreRead) {
  const auto users = parse_users("# the clinic\n\n" + line_of("anna", "operator") + line_of("b.c_d-9", "engineer") + "# end", "users");

  ASSERT_TRUE(users.has_value()) << users.error().what;
  EXPECT_EQ(*users, (std::vector<User>{{"anna", v1::ROLE_OPERATOR, kHash}, {"b.c_d-9", v1::ROLE_ENGINEER, kHash}}));
  EXPECT_TRUE(parse_users("", "users")->empty());
}

TEST(Users, WhatIsNoUserIsRefusedWithItsLine) {
  const std::string name = "a name is 1 to 32 of a-z, 0-9, '.', '_', '-'";
  const std::string hash = "the hash of 'anna' was not made by `dts-gateway user add`";
  const std::string weak = "$argon2id$v=19$m=1024,t=2,p=1" + kHash.substr(kHash.find("$c29"));
  for (const auto& [text, problem] :
       {std::pair("# one\n" + line_of("anna") + "anna\n", std::string("3: expected NAME:ROLE:HASH")),
        {"anna:viewer\n", "1: expected NAME:ROLE:HASH"},
        {line_of("Anna"), "1: " + name},
        {line_of(""), "1: " + name},
        {line_of(std::string(33, 'a')), "1: " + name},
        {line_of(std::string(32, 'a')), ""},
        {line_of("local2"), ""},
        {line_of("anna") + line_of("local"), "2: 'local' is the name of users without a login: choose another name"},
        {line_of("anna", "none"), "1: the role of 'anna' is not viewer, operator or engineer"},
        {line_of("anna") + line_of("anna"), "2: 'anna' appears twice"},
        {"anna:viewer:secret\n", "1: " + hash},
        {"anna:viewer:\n", "1: " + hash},
        {"anna:viewer:$2b$12$abcdefghijklmnopqrstuv\n", "1: " + hash},
        {"anna:viewer:" + weak, "1: " + hash},
        {"anna:viewer:" + kHash + "\r\n", "1: " + hash},
        {"anna:viewer:" + kHash + std::string(500, 'A'), "1: " + hash},
        {"anna:viewer:" + kHash + '\0' + "A\n", "1: " + hash}}) {
    EXPECT_EQ(problem_with(text), problem.empty() ? "" : "users:" + problem) << text;
  }
}

TEST(Users, AThousandFitAndNotOneMore) {
  std::string text;
  for (int number = 0; number < 1000; ++number) text += line_of("u" + std::to_string(number));

  EXPECT_EQ(problem_with(text), "");
  EXPECT_EQ(problem_with(text + line_of("last")), "users:1001: more than 1000 users");
}

class UserFileTest : public ::testing::Test {
 protected:
  void write(const std::string& text, fs::perms mode = fs::perms(0640)) const {
    std::ofstream(file_) << text;
    fs::permissions(file_, mode);
  }
  [[nodiscard]] std::string content() const {
    std::ostringstream text;
    text << std::ifstream(file_).rdbuf();
    return text.str();
  }
  [[nodiscard]] std::size_t files_beside() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(directory_.path()), fs::directory_iterator()));
  }

  testing::TemporaryDirectory directory_;
  std::string file_ = (directory_.path() / "users").string();
};

TEST_F(UserFileTest, ThatOthersMayReadOrChange_IsRefused) {
  for (const unsigned mode : {0644U, 0660U, 0642U, 0604U}) {
    write(line_of("anna"), fs::perms(mode));
    EXPECT_EQ(read_users(file_).error(),
              (client::Error{client::ErrorCode::InvalidArgument,
                             "'" + file_ + "': other users can read it, or users other than the owner can write it",
                             "chmod 640 '" + file_ + "'"}))
        << mode;
  }
  for (const unsigned mode : {0640U, 0600U, 0400U}) {
    fs::permissions(file_, fs::perms(mode));
    EXPECT_TRUE(read_users(file_).has_value()) << mode;
  }
}

TEST_F(UserFileTest, OfAnotherGroup_IsNamedWithWhatToDo) {
  if (::getuid() != 0) GTEST_SKIP() << "only root can act as another user";
  write("");
  constexpr uid_t kNobody = 65534;
  ASSERT_EQ(::seteuid(kNobody), 0);
  const auto users = read_users(file_);
  ASSERT_EQ(::seteuid(0), 0);
  ASSERT_FALSE(users);
  EXPECT_EQ(users.error().what, "cannot read '" + file_ + "': Permission denied");
  EXPECT_NE(users.error().hint.find("chgrp "), std::string::npos) << users.error().hint;
}

TEST_F(UserFileTest, ThatIsNoneOrTooLarge_IsRefused) {
  EXPECT_EQ(read_users(file_).error(),
            (client::Error{client::ErrorCode::InvalidArgument, "cannot read '" + file_ + "': No such file or directory",
                           "make the first user: dts-gateway user add NAME --role engineer --users FILE"}));
  const std::string folder = directory_.path().string();
  EXPECT_EQ(read_users(folder).error().what, "'" + folder + "' is not a file");
  write(std::string(1U << 20U, '\n'));
  EXPECT_TRUE(read_users(file_).has_value());
  write(std::string((1U << 20U) + 1, '\n'));
  EXPECT_EQ(read_users(file_).error().what, "'" + file_ + "' is larger than 1 MiB");
}

TEST_F(UserFileTest, FirstUser_MakesTheFile) {
  ASSERT_TRUE(add_user(file_, {"anna", v1::ROLE_OPERATOR, kHash}).has_value());

  EXPECT_EQ(content(), line_of("anna", "operator"));
  EXPECT_EQ(fs::status(file_).permissions(), fs::perms(0640));
  EXPECT_EQ(files_beside(), 1U);
}

TEST_F(UserFileTest, Changes_KeepCommentsOrderAndMode) {
  write("# the clinic\n" + line_of("anna") + "\n# tablets\n" + line_of("tablet"), fs::perms(0600));

  ASSERT_TRUE(add_user(file_, {"bert", v1::ROLE_ENGINEER, kHash}).has_value());
  ASSERT_TRUE(remove_user(file_, "anna").has_value());

  EXPECT_EQ(content(), "# the clinic\n\n# tablets\n" + line_of("tablet") + line_of("bert", "engineer"));
  EXPECT_EQ(fs::status(file_).permissions(), fs::perms(0600));
  EXPECT_EQ(files_beside(), 1U);
}

TEST_F(UserFileTest, LastLineWithoutItsEnd_StaysALineOfItsOwn) {
  write("# the clinic\n" + line_of("anna").substr(0, line_of("anna").size() - 1));

  ASSERT_TRUE(add_user(file_, {"bert", v1::ROLE_VIEWER, kHash}).has_value());

  EXPECT_EQ(content(), "# the clinic\n" + line_of("anna") + line_of("bert"));
}

TEST_F(UserFileTest, RemovingOne_LeavesThoseWhoseNamesAreAlike) {
  write(line_of("anna") + line_of("hanna") + line_of("ann"));

  ASSERT_TRUE(remove_user(file_, "ann").has_value());
  EXPECT_EQ(content(), line_of("anna") + line_of("hanna"));
  ASSERT_TRUE(remove_user(file_, "anna").has_value());
  EXPECT_EQ(content(), line_of("hanna"));
}

TEST_F(UserFileTest, WrongChange_ChangesNothing) {
  const std::string before = line_of("anna");
  write(before);

  EXPECT_EQ(add_user(file_, {"anna", v1::ROLE_VIEWER, kHash}).error().code, client::ErrorCode::WrongState);
  EXPECT_EQ(remove_user(file_, "bert").error().code, client::ErrorCode::NotFound);
  EXPECT_FALSE(add_user(file_, {"x:engineer", v1::ROLE_VIEWER, kHash}).has_value());
  EXPECT_FALSE(add_user(file_, {"bert", v1::ROLE_VIEWER, "no hash"}).has_value());

  EXPECT_EQ(content(), before);
  EXPECT_EQ(files_beside(), 1U);
}

TEST_F(UserFileTest, RemovingFromNone_DoesNotMakeOne) {
  EXPECT_FALSE(remove_user(file_, "anna").has_value());
  EXPECT_FALSE(fs::exists(file_));
}

TEST_F(UserFileTest, ThatIsALink_IsNotReplaced) {
  const fs::path target = directory_.path() / "target";
  std::ofstream(target) << line_of("anna");
  fs::permissions(target, fs::perms(0640));
  fs::create_symlink(target, file_);

  EXPECT_FALSE(add_user(file_, {"bert", v1::ROLE_VIEWER, kHash}).has_value());

  EXPECT_TRUE(fs::is_symlink(file_));
}

TEST_F(UserFileTest, StampTellsChangesApart) {
  write(line_of("anna"));
  const auto first = stamp_of(file_);
  ASSERT_TRUE(add_user(file_, {"bert", v1::ROLE_VIEWER, kHash}).has_value());
  ASSERT_TRUE(remove_user(file_, "bert").has_value());

  EXPECT_NE(stamp_of(file_), first) << "of the same size, and perhaps within the same tick of the file system's clock";
  EXPECT_EQ(stamp_of(file_), read_users(file_)->stamp);
  EXPECT_EQ(stamp_of(file_ + "x"), std::nullopt);
}

}  // namespace
}  // namespace dts::gateway
