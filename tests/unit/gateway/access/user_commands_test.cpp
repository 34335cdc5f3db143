// SPDX-License-Identifier: Apache-2.0
#include "gateway/access/user_commands.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <future>
#include <sstream>

#include "cli/exit_status.h"
#include "cli/run.h"
#include "gateway/access/descriptor.h"
#include "gateway/access/password.h"
#include "gateway/access/user_file.h"
#include "unit/libdts/fake_daemon.h"

namespace dts::gateway {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class UserCommandsTest : public ::testing::Test {
 protected:
  int run(const std::vector<std::string>& words) {
    out_.str({});
    talk_.str({});
    cli::CommandLine line({.name = "dts-gateway", .version = "0", .description = "Gateway", .examples = ""});
    add_user_commands(line, [this](cli::Console&) -> client::Result<Secret> { return Secret(std::string(password_)); });
    return cli::run(line, words, console_);
  }

  testing::TemporaryDirectory directory_;
  std::string file_ = (directory_.path() / "users").string();
  std::string password_ = "correct horse battery";
  std::ostringstream out_;
  std::ostringstream talk_;
  cli::Console console_{.out = out_, .talk = talk_};
};

TEST_F(UserCommandsTest, AddListRemove_DoAsTheySay) {
  EXPECT_EQ(run({"user", "add", "anna", "--role", "operator", "--users", file_}), cli::kOk) << talk_.str();
  EXPECT_EQ(run({"user", "list", "--users", file_}), cli::kOk);
  EXPECT_EQ(out_.str(), "user  role\nanna  operator\n");
  const auto users = read_users(file_);
  ASSERT_TRUE(users.has_value());
  EXPECT_TRUE(is_password(users->users.at(0).password_hash, Secret("correct horse battery")));

  EXPECT_EQ(run({"user", "remove", "anna", "--users", file_}), cli::kOk);

  EXPECT_TRUE(read_users(file_)->users.empty());
  EXPECT_EQ(run({"user", "remove", "anna", "--users", file_}), 5);
}

TEST_F(UserCommandsTest, PasswordOfWrongLength_IsRefused) {
  for (const std::string& password : {std::string("nine char"), std::string("\u00e4\u00e4\u00e4\u00e4\u00e4"), std::string(201, 'a')}) {
    password_ = password;
    EXPECT_EQ(run({"user", "add", "anna", "--role", "viewer", "--users", file_}), cli::kUsage) << password;
  }
  EXPECT_FALSE(std::ifstream(file_).is_open());

  password_ = "ten chars.";
  EXPECT_EQ(run({"user", "add", "anna", "--role", "viewer", "--users", file_}), cli::kOk);
}

TEST_F(UserCommandsTest, WrongNameRoleOrFile_IsWrongUse) {
  for (const auto& [words, says] :
       {std::pair(std::vector<std::string>{"add", "Anna", "--role", "viewer", "--users", file_},
                  "NAME: 'Anna': a name is 1 to 32 of a-z, 0-9, '.', '_', '-'"),
        {{"add", "local", "--role", "viewer", "--users", file_},
         "NAME: 'local': 'local' is the name of users without a login: choose another name"},
        {{"add", "anna", "--role", "none", "--users", file_}, "--role: 'none' is not viewer, operator or engineer"},
        {{"add", "anna", "--users", file_}, "--role is required"},
        {{"add", "anna", "--role", "viewer"}, "--users is required"},
        {{"list"}, "--users is required"}}) {
    std::vector<std::string> all = words;
    all.insert(all.begin(), "user");
    EXPECT_EQ(run(all), cli::kUsage);
    EXPECT_EQ(talk_.str(), "dts-gateway: user " + words[0] + ": " + says + "\n  try: dts-gateway user " + words[0] + " --help\n");
  }
  EXPECT_FALSE(std::ifstream(file_).is_open());
}

class AskPasswordTest : public ::testing::Test {
 protected:
  /// A pipe that holds `text` and then ends.
  static Descriptor piped(const std::string& text) {
    std::array<int, 2> ends{};
    EXPECT_EQ(::pipe(ends.data()), 0);
    const Descriptor in(ends[1]);
    EXPECT_EQ(::write(*in, text.data(), text.size()), static_cast<ssize_t>(text.size()));
    return Descriptor(ends[0]);
  }
  std::string asked(const std::string& text) {
    const Descriptor in = piped(text);
    const auto password = ask_password(*in, console_);
    return password ? std::string(password->text()) : "error: " + password.error().what;
  }

  std::ostringstream out_;
  std::ostringstream talk_;
  cli::Console console_{.out = out_, .talk = talk_};
};

TEST_F(AskPasswordTest, FromAPipe_TakesOneLine) {
  EXPECT_EQ(asked("correct horse battery\nnot this\n"), "correct horse battery");
  EXPECT_EQ(asked("without an end"), "without an end");
  EXPECT_EQ(asked("\n"), "");
  EXPECT_EQ(asked(""), "error: no password was given");
  EXPECT_EQ(asked(std::string(5000, 'a')).size(), kMostPasswordBytes + 1) << "enough to be refused";
  EXPECT_EQ(talk_.str(), "");
}

/// Plays the keyboard and the screen of a terminal.
class TerminalTest : public AskPasswordTest {
 protected:
  /// Once the echo is off: what is typed before is thrown away.
  void type(const std::string& text) {
    const auto deadline = std::chrono::steady_clock::now() + testing::kDeadline;
    termios now{};
    do {
      ASSERT_EQ(::tcgetattr(*keyboard_, &now), 0);
      ASSERT_LT(std::chrono::steady_clock::now(), deadline);
    } while ((now.c_lflag & static_cast<tcflag_t>(ECHO)) != 0);
    ASSERT_EQ(::write(*keyboard_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  std::future<client::Result<Secret>> ask() {
    return std::async(std::launch::async, [this] { return ask_password(*terminal_, console_); });
  }
  [[nodiscard]] std::string screen() const {
    std::string shown;
    std::array<char, 256> piece{};
    pollfd waiting{.fd = *keyboard_, .events = POLLIN, .revents = 0};
    while (::poll(&waiting, 1, 0) > 0 && (waiting.revents & POLLIN) != 0) {
      const ssize_t got = ::read(*keyboard_, piece.data(), piece.size());
      if (got <= 0) break;
      shown.append(piece.data(), static_cast<std::size_t>(got));
    }
    return shown;
  }
  [[nodiscard]] bool is_echo_on() const {
    termios now{};
    return ::tcgetattr(*keyboard_, &now) == 0 && (now.c_lflag & static_cast<tcflag_t>(ECHO)) != 0;
  }

  static Descriptor new_terminal() {
    Descriptor keyboard(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC));
    EXPECT_TRUE(keyboard && ::grantpt(*keyboard) == 0 && ::unlockpt(*keyboard) == 0);
    return keyboard;
  }

  Descriptor keyboard_ = new_terminal();
  Descriptor terminal_{::open(::ptsname(*keyboard_), O_RDWR | O_NOCTTY | O_CLOEXEC)};
};

TEST_F(TerminalTest, AsksTwiceWithoutEcho) {
  auto asked = ask();
  type("correct horse battery\ncorrect horse battery\n");

  const auto password = asked.get();

  ASSERT_TRUE(password.has_value()) << password.error().what;
  EXPECT_EQ(password->text(), "correct horse battery");
  EXPECT_THAT(screen(), Not(HasSubstr("horse")));
  EXPECT_THAT(talk_.str(), HasSubstr("Again: "));
  EXPECT_TRUE(is_echo_on());
}

TEST_F(TerminalTest, TwoThatDiffer_AreRefused) {
  auto asked = ask();
  type("correct horse battery\ncorrect house battery\n");

  const auto password = asked.get();

  ASSERT_FALSE(password.has_value());
  EXPECT_EQ(password.error().what, "the two passwords differ");
}

TEST_F(TerminalTest, Interrupted_GivesTheEchoBack) {
  auto asked = ask();
  type("correct hor");

  std::raise(SIGINT);  // as Ctrl-C; noted, since the echo is off already

  const auto password = asked.get();
  ASSERT_FALSE(password.has_value());
  EXPECT_THAT(password.error().what, HasSubstr("interrupted"));
  EXPECT_TRUE(is_echo_on());
}

}  // namespace
}  // namespace dts::gateway
