// SPDX-License-Identifier: Apache-2.0
#include "core/log.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <functional>
#include <string>

namespace dts::core {
namespace {

constexpr const char* kJournalVariable = "JOURNAL_STREAM";

std::string device_and_inode_of(int fd) {
  struct stat actual {};
  fstat(fd, &actual);
  return std::to_string(actual.st_dev) + ":" + std::to_string(actual.st_ino);
}

/// What `body` writes to the standard error, which is a pipe meanwhile.
std::string stderr_of(const std::function<void()>& body) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) return "no pipe";
  const int before = dup(STDERR_FILENO);
  dup2(ends[1], STDERR_FILENO);
  body();
  dup2(before, STDERR_FILENO);
  close(before);
  close(ends[1]);
  std::string text;
  std::array<char, 4096> chunk{};
  for (ssize_t count = 0; (count = read(ends[0], chunk.data(), chunk.size())) > 0;)
    text.append(chunk.data(), static_cast<std::size_t>(count));
  close(ends[0]);
  return text;
}

/// As under systemd, when `stderr` leads to the journal.
std::string journal_of(const std::function<void()>& body) {
  const std::string text = stderr_of([&body] {
    setenv(kJournalVariable, device_and_inode_of(STDERR_FILENO).c_str(), 1);
    body();
  });
  unsetenv(kJournalVariable);
  return text;
}

TEST(Log, DefaultConstructed_SwallowsEverything) {
  EXPECT_EQ(stderr_of([] { Log{}.error("nobody listens"); }), "");
}

TEST(Log, ToJournal_PrefixesThePriority_AndLeavesOutWhatIsBelowTheMinimum) {
  const std::string all[]{"<7>d\n", "<6>i {} 21 \u00b5s {0}\n", "<4>w\n", "<3>e\n"};
  std::string expected;
  for (const LogLevel minimum : {LogLevel::Error, LogLevel::Warning, LogLevel::Info, LogLevel::Debug}) {
    const std::string lines = journal_of([minimum] {
      const Log log = Log::to_stderr(minimum);
      log.debug("d");
      log.info("i {} 21 \u00b5s {0}");
      log.warning("w");
      log.error("e");
    });
    expected = all[static_cast<std::size_t>(minimum)] + expected;
    EXPECT_EQ(lines, expected);
  }
}

TEST(Log, ToTerminal_HasTimeAndLevel) {
  unsetenv(kJournalVariable);

  const std::string line = stderr_of([] { Log::to_stderr(LogLevel::Info).info("ready"); });

  EXPECT_NE(line.find("info ready\n"), std::string::npos) << line;
  EXPECT_EQ(line.find("<6>"), std::string::npos) << line;
}

// A shell in a desktop session inherits the variable of the session's service; its stderr is a terminal all the same.
TEST(Log, InheritedJournalVariable_IsNotBelieved) {
  setenv(kJournalVariable, "1:2", 1);

  const std::string line = stderr_of([] { Log::to_stderr(LogLevel::Info).info("ready"); });

  unsetenv(kJournalVariable);
  EXPECT_EQ(line.find("<6>"), std::string::npos) << line;
}

TEST(Log, TextOfAPeer_CannotForgeALine) {
  const std::string lines = journal_of([] { Log::to_stderr(LogLevel::Info).info("label \"a\n<0>b\r\x1b[31m\x7f\""); });

  EXPECT_EQ(lines, "<6>label \"a <0>b  [31m \"\n");
}

}  // namespace
}  // namespace dts::core
