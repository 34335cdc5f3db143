// SPDX-License-Identifier: Apache-2.0
// A local subscriber in mode Latest whose process is stopped for 5 s: its first block afterwards must be new. Compared are positions in the
// data, not times: a slow machine makes a block late, but not old.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "system/daemon_process.h"

namespace dts::test {
namespace {

using steady_clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kStop{5};
constexpr std::uint64_t kMostPeriods = 2;

class ReaderProcess {
 public:
  ReaderProcess(const std::string& endpoint, const std::string& prefix, const std::string& stream) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) return;
    pid_ = ::fork();
    if (pid_ == 0) {
      ::dup2(ends[1], STDOUT_FILENO);
      ::execl(DTS_LOCAL_READER, DTS_LOCAL_READER, endpoint.c_str(), prefix.c_str(), stream.c_str(), nullptr);
      ::_exit(127);
    }
    ::close(ends[1]);
    out_ = ends[0];
    ::fcntl(out_, F_SETFL, O_NONBLOCK);
  }
  ~ReaderProcess() {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
    ::close(out_);
  }
  ReaderProcess(const ReaderProcess&) = delete;
  ReaderProcess& operator=(const ReaderProcess&) = delete;

  void signal(int number) const { ::kill(pid_, number); }
  /// Waits for the next line: the last scan of a block.
  [[nodiscard]] std::optional<std::uint64_t> next() {
    const bool is_there = eventually([&] { return has_line(); });
    return is_there ? std::optional(take_line()) : std::nullopt;
  }
  /// Returns the last block that was printed so far.
  [[nodiscard]] std::optional<std::uint64_t> last() {
    std::optional<std::uint64_t> newest;
    while (has_line()) newest = take_line();
    return newest;
  }

 private:
  [[nodiscard]] bool has_line() {
    std::array<char, 4096> bytes{};
    for (ssize_t count = 1; count > 0;) {
      count = ::read(out_, bytes.data(), bytes.size());
      if (count > 0) text_.append(bytes.data(), static_cast<std::size_t>(count));
    }
    return text_.find('\n') != std::string::npos;
  }
  [[nodiscard]] std::uint64_t take_line() {
    const std::uint64_t scan = std::stoull(text_);
    text_.erase(0, text_.find('\n') + 1);
    return scan;
  }

  pid_t pid_ = -1;
  int out_ = -1;
  std::string text_;
};

/// The newest block of each stream, as a subscriber knows it that does not stop.
class Newest {
 public:
  explicit Newest(const DaemonProcess& daemon) : subscriber_(daemon.subscribe({"floor/cop", "fast/raw"})) {}

  void read_for(steady_clock::duration length) {
    for (const auto end = steady_clock::now() + length; steady_clock::now() < end;) read(std::chrono::milliseconds(10));
    while (read(std::chrono::milliseconds(0))) {
    }
  }
  struct Position {
    std::uint64_t scan = 0;
    std::uint64_t period_scans = 0;
  };
  [[nodiscard]] Position of(const std::string& topic) { return newest_[topic]; }

 private:
  bool read(std::chrono::milliseconds timeout) {
    const auto message = subscriber_.receive(timeout).value();
    const auto* block = message ? std::get_if<client::Block>(&*message) : nullptr;
    if (block != nullptr) newest_[std::string(block->topic)] = {block->first_scan + block->scan_count - 1, block->scan_count};
    return message.has_value();
  }

  client::Subscriber subscriber_;
  std::map<std::string, Position> newest_;
};

using Readers = std::map<std::string, std::unique_ptr<ReaderProcess>>;

/// Stops the readers of `rigs`, and compares their first blocks with the newest ones. `before_resume` runs at the end of the stop.
void expect_new_data_first(
    const DaemonProcess& daemon, const std::map<std::string, std::string>& rigs, const std::function<void()>& before_resume = [] {}) {
  Newest newest(daemon);
  Readers readers;
  for (const auto& [rig, topic] : rigs) readers[topic] = std::make_unique<ReaderProcess>(daemon.data_endpoint(), rig + "/", topic);
  for (const auto& [topic, reader] : readers) ASSERT_TRUE(reader->next());

  // A reader that is stopped just after it received a block prints that old block afterwards: another attempt, three at most.
  bool is_new = false;
  for (int attempt = 0; attempt < 3 && !is_new; ++attempt) {
    newest.read_for(std::chrono::milliseconds(1500));
    for (const auto& [topic, reader] : readers) reader->signal(SIGSTOP);
    newest.read_for(kStop);
    before_resume();
    newest.read_for(std::chrono::milliseconds(100));
    is_new = true;
    for (const auto& [topic, reader] : readers) {
      const auto before = reader->last();
      const Newest::Position at_resume = newest.of(topic);
      reader->signal(SIGCONT);
      const auto first = reader->next();
      ASSERT_TRUE(before && first);
      const auto behind = static_cast<long long>(at_resume.scan) - static_cast<long long>(*first);
      std::printf(
          "%s: %llu scans while stopped; the first block afterwards is %lld scans behind the newest one at the resume (period: %llu)\n",
          topic.c_str(), static_cast<unsigned long long>(at_resume.scan - *before), behind,
          static_cast<unsigned long long>(at_resume.period_scans));
      is_new = is_new && behind <= static_cast<long long>(kMostPeriods * at_resume.period_scans);
    }
  }
  EXPECT_TRUE(is_new);
}

class LocalLatest : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(daemon_.is_ready()); }

  DaemonProcess daemon_{
      {.further_rigs = {{.name = "fast", .device = "sim:floor?seed=8", .acquire = "rate_hz = 1500.0\nlow_latency = true"}}}};
};

TEST_F(LocalLatest, ReaderThatWasStopped_GetsNewDataFirst) {
  expect_new_data_first(daemon_, {{"floor", "floor/cop"}, {"fast", "fast/raw"}});
}

/// The queue of the reader is full of blocks; then more events follow than it has room for.
TEST_F(LocalLatest, ReaderThatMissedEvents_ConnectsAgainAndGetsNewDataFirst) {
  expect_new_data_first(daemon_, {{"fast", "fast/raw"}}, [&] {
    auto control = daemon_.control();
    for (int i = 0; i < 300; ++i) EXPECT_TRUE(control.mark(std::string(200, 'x'), "fast"));
  });
  EXPECT_TRUE(eventually([&] { return daemon_.log().find("was disconnected: it read too slowly") != std::string::npos; }));
}

}  // namespace
}  // namespace dts::test
