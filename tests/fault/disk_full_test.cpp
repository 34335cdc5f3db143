// SPDX-License-Identifier: Apache-2.0
// Real daemons on a disk of four megabytes that fills up.
#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>
#include <sys/mount.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "fault/child_process.h"
#include "fault/recorded_raw.h"
#include "fault/reference.h"
#include "fault/rigs.h"
#include "record/xdf/recovery.h"
#include "system/daemon_process.h"

namespace dts::fault {
namespace {

const std::string kSkip = "skip: ";

/// Mounts of this process alone; as a user in a user namespace of its own. Why not, or nothing.
std::string enter_own_mounts() {
  const auto user = ::getuid();
  const auto group = ::getgid();
  const int wanted = user == 0 ? CLONE_NEWNS : CLONE_NEWNS | CLONE_NEWUSER;
  if (::unshare(wanted) != 0) return kSkip + "no mount namespace here: " + std::strerror(errno);
  if (user != 0) {
    std::ofstream("/proc/self/setgroups") << "deny";
    std::ofstream("/proc/self/uid_map") << "0 " << user << " 1";
    std::ofstream("/proc/self/gid_map") << "0 " << group << " 1";
  }
  if (::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) return kSkip + "mounts cannot be private: " + std::strerror(errno);
  return {};
}

/// A daemon whose state folder is a disk of its own.
class SmallDisk {
 public:
  explicit SmallDisk(const std::string& stop_below_mib)
      : daemon_({.daemon = "[storage]\nrefuse_below_min = 0.0\nwarn_below_min = 0.0\nstop_below_mib = " + stop_below_mib + "\n"}) {
    end();
  }
  ~SmallDisk() {
    end();
    if (is_mounted_) ::umount2(daemon_.state_directory().c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  /// Why it cannot be done here, or nothing.
  std::string mount() {
    is_mounted_ = ::mount("tmpfs", daemon_.state_directory().c_str(), "tmpfs", 0, "size=4m,mode=0750") == 0;
    if (!is_mounted_) return kSkip + "no tmpfs can be mounted: " + std::strerror(errno);
    std::ofstream(daemon_.directory() / "rigs" / "floor.toml") << floor16_text();
    daemon_.restart();
    return daemon_.is_ready() ? "" : "the daemon does not start: " + daemon_.log();
  }
  [[nodiscard]] test::DaemonProcess& daemon() noexcept { return daemon_; }

 private:
  void end() {
    if (!daemon_.is_running()) return;
    daemon_.signal(SIGTERM);
    static_cast<void>(daemon_.wait());
  }
  test::DaemonProcess daemon_;
  bool is_mounted_ = false;
};

/// Starts a session and waits until the disk has ended it; its record, or what went wrong.
std::string session_until_full(test::DaemonProcess& daemon, v1::SessionRecord& found) {
  auto control = daemon.control();
  v1::StartSessionRequest request;
  request.set_rig("floor");
  request.set_protocol("free");
  const auto started = control.start_session(request);
  if (!started) return "no session starts: " + started.error().what;
  const bool is_over = test::eventually([&] {
    const auto shown = control.show_session(started->session_id());
    if (shown) found = *shown;
    return shown && found.state() != "running";
  });
  return is_over ? "" : "the session goes on though the disk is full: " + daemon.log();
}

/// Scans go on arriving.
std::string check_streams(test::DaemonProcess& daemon) {
  auto subscriber = daemon.subscribe({"floor/raw"});
  std::size_t blocks = 0;
  const bool streams = test::eventually([&] {
    const auto message = subscriber.receive(std::chrono::milliseconds(100));
    if (message && *message && std::holds_alternative<client::Block>(**message)) ++blocks;
    return blocks > 25;
  });
  if (!daemon.is_running()) return "the daemon died: " + daemon.log();
  return streams ? "" : "the daemon no longer streams";
}

/// The file is closed, says that it is incomplete, and holds what the simulator gave.
std::string check_closed(const v1::SessionPart& part, const Reference& reference) {
  const auto verified = record::verify(part.file());
  if (!verified) return core::to_string(verified.error());
  if (!verified->is_closed || verified->incomplete.empty()) return part.file() + " does not say that it is incomplete";
  if (verified->sha256 != part.sha256()) return "the catalogue's SHA-256 is not the file's";
  const auto raw = read_raw(part.file());
  if (!raw) return core::to_string(raw.error());
  if (raw->scans < 1500) return "only " + std::to_string(raw->scans) + " scans are in the file";
  return reference.difference(*raw);
}

std::string fill_to_the_last_byte() {
  if (std::string reason = enter_own_mounts(); !reason.empty()) return reason;
  const Reference reference = Reference::compute(floor16_rig(), 60.0);
  SmallDisk disk("0.0");
  test::DaemonProcess& daemon = disk.daemon();
  if (std::string problem = disk.mount(); !problem.empty()) return problem;
  v1::SessionRecord found;
  if (std::string problem = session_until_full(daemon, found); !problem.empty()) return problem;
  if (found.state() != "incomplete") return "the session is listed as " + found.state();
  if (found.message().empty() || found.parts(0).reason().empty()) return "nobody says why";
  if (std::string problem = check_streams(daemon); !problem.empty()) return problem;
  // There may be no room for the footers: then the file waits for its recovery, and says by its name that it is not closed.
  if (found.parts(0).state() == v1::PART_STATE_INTERRUPTED) return {};
  if (found.parts(0).state() != v1::PART_STATE_INCOMPLETE) return "listed as " + v1::PartState_Name(found.parts(0).state());
  return check_closed(found.parts(0), reference);
}

std::string stop_near_the_limit() {
  if (std::string reason = enter_own_mounts(); !reason.empty()) return reason;
  const Reference reference = Reference::compute(floor16_rig(), 60.0);
  SmallDisk disk("1.5");
  test::DaemonProcess& daemon = disk.daemon();
  if (std::string problem = disk.mount(); !problem.empty()) return problem;
  v1::SessionRecord found;
  if (std::string problem = session_until_full(daemon, found); !problem.empty()) return problem;
  if (found.state() != "incomplete") return "the session is listed as " + found.state();
  if (found.parts(0).state() != v1::PART_STATE_INCOMPLETE) return "listed as " + v1::PartState_Name(found.parts(0).state());
  if (found.parts(0).reason().find("nearly full") == std::string::npos) return "the reason given is " + found.parts(0).reason();
  if (std::string problem = check_streams(daemon); !problem.empty()) return problem;
  return check_closed(found.parts(0), reference);
}

void expect_nothing_wrong(const std::function<std::string()>& work) {
  const std::string problem = run_in_child(work, std::chrono::seconds(120));
  if (problem.starts_with(kSkip)) GTEST_SKIP() << problem.substr(kSkip.size());
  EXPECT_EQ(problem, "");
}

TEST(DiskFull, ToTheLastByte_DaemonStreamsOnAndSessionIsIncomplete) {
  RecordProperty("requirement", "REC-4");
  expect_nothing_wrong(fill_to_the_last_byte);
}
TEST(DiskFull, NearTheLimit_RecordingIsClosedInOrder) { expect_nothing_wrong(stop_near_the_limit); }

}  // namespace
}  // namespace dts::fault
