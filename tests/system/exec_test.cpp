// SPDX-License-Identifier: Apache-2.0
// A program as a device of the real daemon: it works, and it fails in every way that a program can. dtsd reports why and continues.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>

#include "support/sanitized.h"
#include "system/daemon_process.h"

namespace dts::test {
namespace {

using testing::HasSubstr;

constexpr const char* kOptions = "?format=lines&channels=4&rate_hz=100&counter=1";
constexpr const char* kAllowed = "[devices]\nallow_exec = true\n";

/// The documented example.
std::string example() { return std::string("exec:/usr/bin/python3 ") + DTS_SOURCE_DIR + "/clients/python/examples/board.py" + kOptions; }

/// A folder for the scripts of a test.
class Scripts {
 public:
  Scripts() {
    std::string name = (std::filesystem::temp_directory_path() / "dts-exec-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = name;
  }
  ~Scripts() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  Scripts(const Scripts&) = delete;
  Scripts& operator=(const Scripts&) = delete;

  [[nodiscard]] std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  /// A program that sends `scans` good lines at 100 Hz, then does what `fault` says. Returns its device address.
  [[nodiscard]] std::string device(const std::string& fault, int scans = 100) const {
    const auto file = path("board.py");
    std::ofstream(file) << "import os, signal, subprocess, sys, time\n"
                        << "start = time.monotonic()\n"
                        << "for scan in range(" << scans << "):\n"
                        << "    time.sleep(max(0.0, start + scan / 100 - time.monotonic()))\n"
                        << "    print(f'{scan},1.0,2.0,3.0,4.0', flush=True)\n"
                        << fault << "\n";
    return "exec:/usr/bin/python3 " + file.string() + kOptions;
  }

 private:
  std::filesystem::path folder_;
};

/// A daemon with a healthy simulated rig "other" beside the rig "floor" of a program.
DaemonProcess::Options with_program(const std::string& device) {
  DaemonProcess::Options options;
  options.device = device;
  options.daemon = kAllowed;
  options.acquire = "rate_hz = 100\n";
  options.further_rigs = {{.name = "other", .device = "sim:floor?seed=7"}};
  return options;
}

bool has_scans(const DaemonProcess& daemon, const std::string& rig) {
  const auto status = daemon.control().status();
  if (!status) return false;
  for (const auto& state : status->rigs()) {
    if (state.rig().name() == rig) return state.device() == v1::DEVICE_STATE_STREAMING && state.scans_total() > 50;
  }
  return false;
}

/// Expects that the daemon names `reason`, starts the program again, and that the other rig runs.
void expect_reported_and_survived(const std::string& device, const std::string& reason) {
  DaemonProcess daemon(with_program(device));
  ASSERT_TRUE(daemon.is_ready()) << daemon.log();
  EXPECT_TRUE(eventually([&] { return daemon.log().find(reason) != std::string::npos; })) << "no '" << reason << "' in:\n" << daemon.log();
  EXPECT_TRUE(eventually([&] { return has_scans(daemon, "other"); })) << daemon.log();
  EXPECT_TRUE(daemon.is_running());
  daemon.signal(SIGTERM);
  EXPECT_EQ(daemon.wait(), 0) << daemon.log();
}

TEST(ProgramAsDevice, WithoutPermission_TheConfigurationIsRejectedAtItsPlace) {
  RecordProperty("requirement", "ACQ-15");
  DaemonProcess::Options options;
  options.device = example();
  options.acquire = "rate_hz = 100\n";
  DaemonProcess daemon(options);
  EXPECT_FALSE(daemon.is_ready());
  const Finished checked = run_program({DTSD_PROGRAM, "--config", daemon.config_file(), "--check-config"}, daemon.environment());
  EXPECT_EQ(checked.status, 2);
  EXPECT_THAT(checked.err, HasSubstr(daemon.config_file() + ":"));
  EXPECT_THAT(checked.err, HasSubstr("allow_exec = true under [devices]"));
}

TEST(ProgramAsDevice, TheDocumentedExampleStreams_AndItsWordsAreInTheLog) {
  DaemonProcess daemon(with_program(example()));
  ASSERT_TRUE(daemon.is_ready()) << daemon.log();
  EXPECT_TRUE(eventually([&] { return has_scans(daemon, "floor"); })) << daemon.log();
  EXPECT_TRUE(eventually([&] { return daemon.log().find("board.py: 4 channels") != std::string::npos; }));
  const Finished listed = daemon.ctl({"device", "list"});
  EXPECT_THAT(listed.out, HasSubstr(example()));
  EXPECT_TRUE(eventually([&] { return daemon.ctl({"device", "test", "floor"}).status == 0; }));
}

TEST(ProgramAsDevice, ThatDies_IsReportedWithItsLastWords_AndStartedAgain) {
  const Scripts scripts;
  DaemonProcess daemon(with_program(scripts.device("sys.exit('the sensor is not there')")));
  ASSERT_TRUE(daemon.is_ready()) << daemon.log();
  EXPECT_TRUE(eventually([&] { return daemon.log().find("exit status 1; its last words: the sensor is not there") != std::string::npos; }))
      << daemon.log();
  EXPECT_TRUE(eventually([&] {
    const auto status = daemon.control().status();
    return status && status->rigs(0).reconnects_total() >= 2;
  })) << daemon.log();
}

TEST(ProgramAsDevice, ThatDies_IsReportedToo_IfDtsdWasStartedWithSigchldIgnored) {
  const Scripts scripts;
  auto* const handler = ::signal(SIGCHLD, SIG_IGN);  // dtsd inherits it
  DaemonProcess daemon(with_program(scripts.device("sys.exit(3)")));
  ::signal(SIGCHLD, handler);
  ASSERT_TRUE(daemon.is_ready()) << daemon.log();
  EXPECT_TRUE(eventually([&] { return daemon.log().find("ended with exit status 3") != std::string::npos; })) << daemon.log();
}

TEST(ProgramAsDevice, ThatHangsAndIgnoresSigterm_IsKilledAndReported) {
  const Scripts scripts;
  const auto note = scripts.path("pid");
  expect_reported_and_survived(scripts.device("signal.signal(signal.SIGTERM, signal.SIG_IGN)\nopen('" + note.string() +
                                              "', 'a').write(f'{os.getpid()} ')\n"
                                              "while True: time.sleep(1000)"),
                               "silent");
  std::ifstream pids(note);
  int count = 0;
  for (pid_t pid = 0; pids >> pid; ++count) EXPECT_NE(::kill(pid, 0), 0) << "it still runs";
  EXPECT_GT(count, 0);
}

TEST(ProgramAsDevice, ThatFloodsBothStreams_HarmsNobody) {
  const Scripts scripts;
  DaemonProcess daemon(with_program(scripts.device("while True:\n    os.write(1, b'x' * 65536)\n    os.write(2, b'noise\\n' * 10000)")));
  ASSERT_TRUE(daemon.is_ready()) << daemon.log();
  EXPECT_TRUE(eventually([&] { return daemon.log().find("were not logged") != std::string::npos; })) << daemon.log();
  EXPECT_TRUE(eventually([&] { return has_scans(daemon, "other"); })) << daemon.log();
  EXPECT_LT(daemon.log().size(), 1'000'000U);
  if (!kIsSanitized) {  // a sanitizer keeps freed memory
    EXPECT_LT(resident_kb(daemon.pid()), 400'000);
  }
}

TEST(ProgramAsDevice, ThatWritesGarbage_GivesNoScanAndIsReported) {
  const Scripts scripts;
  DaemonProcess daemon(with_program(scripts.device("while True:\n    os.write(1, os.urandom(100))\n    time.sleep(0.01)", 0)));
  ASSERT_TRUE(daemon.is_ready()) << daemon.log();
  EXPECT_TRUE(eventually([&] { return has_scans(daemon, "other"); })) << daemon.log();
  EXPECT_TRUE(eventually([&] { return daemon.log().find("device closed: cannot open exec:") != std::string::npos; })) << daemon.log();
  const auto status = daemon.control().status();
  ASSERT_TRUE(status.has_value());
  EXPECT_EQ(status->rigs(0).scans_total(), 0U);
}

TEST(ProgramAsDevice, ThatForks_LeavesNoProcess) {
  const Scripts scripts;
  const auto note = scripts.path("pid");
  {
    DaemonProcess daemon(
        with_program(scripts.device("sleeper = subprocess.Popen(['sleep', '100000'], start_new_session=True)\n"
                                    "open('" +
                                    note.string() + "', 'a').write(f'{sleeper.pid} ')\nos._exit(0)")));
    ASSERT_TRUE(daemon.is_ready()) << daemon.log();
    EXPECT_TRUE(eventually([&] { return daemon.log().find("ended with exit status 0") != std::string::npos; })) << daemon.log();
    daemon.signal(SIGTERM);
    EXPECT_EQ(daemon.wait(), 0);
  }
  std::ifstream pids(note);
  int count = 0;
  for (pid_t pid = 0; pids >> pid; ++count) {
    const auto has_ended = [pid] {
      return ::kill(pid, 0) != 0 || read_file("/proc/" + std::to_string(pid) + "/stat").find(") Z") != std::string::npos;
    };
    EXPECT_TRUE(eventually(has_ended));
  }
  EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace dts::test
