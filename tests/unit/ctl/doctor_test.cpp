// SPDX-License-Identifier: Apache-2.0
#include "ctl/doctor.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <pthread.h>
#include <sched.h>
#include <sys/socket.h>
#include <unistd.h>

#include <limits>
#include <thread>

#include "unit/ctl/run_fixture.h"

namespace dts::ctl {
namespace {

std::string text_of(const std::vector<Check>& checks) {
  std::string text;
  for (const Check& check : checks)
    text += (check.is_good ? "good " : "bad ") + check.name + ": " + check.finding + "; " + check.fix + "\n";
  return text;
}

TEST(DoctorWithoutDaemon, MachineIsJudgedByWhatThisUserMayDo) {
  const std::string good =
      "good scheduling: SCHED_FIFO is allowed for this user; \ngood locked memory: no limit; \n"
      "good clock: synchronised; \n";
  SystemFacts facts{.may_use_fifo = true, .lockable_bytes = std::numeric_limits<std::uint64_t>::max(), .clock_source = {}};
  for (const std::string source : {"tsc", "hyperv_clocksource_tsc_page", "arch_sys_counter", "kvm-clock"}) {
    facts.clock_source = source;
    EXPECT_EQ(text_of(check_system(facts, std::nullopt)), good + "good clock source: " + source + "; \n");
  }
  EXPECT_EQ(
      text_of(check_system({.may_use_fifo = false, .lockable_bytes = (3U << 20U) - 1, .clock_source = ""}, std::nullopt)),
      "good scheduling: SCHED_FIFO is not allowed for this user; run dtsd by its systemd unit, or add 'USER - rtprio 60' to "
      "/etc/security/limits.d/dtsd.conf and log in again\n"
      "good locked memory: at most 2 MiB for this user; run dtsd by its systemd unit, or add 'USER - memlock unlimited' to "
      "/etc/security/limits.d/dtsd.conf and log in again\n"
      "good clock: synchronised; \n"
      "good clock source: unknown; select a faster clock: echo tsc > /sys/devices/system/clocksource/clocksource0/current_clocksource; "
      "if that fails, search dmesg for 'tsc'\n");
}

TEST(DoctorClock, ThatIsNotSynchronisedIsANote_AndOneBehindTheNewestSessionIsWrong) {
  RecordProperty("requirement", "REC-14");
  const auto clock_of = [](const SystemFacts& facts, const std::optional<v1::StatusSnapshot>& status) {
    return text_of({check_system(facts, status).at(2)});
  };
  EXPECT_EQ(clock_of({.clock_source = "tsc", .is_clock_set = false}, std::nullopt),
            "good clock: not synchronised, so date and order of visits are those of this machine alone; turn on time synchronisation: "
            "timedatectl set-ntp true; without a network, compare the time with a watch\n");
  EXPECT_EQ(clock_of({.clock_source = "tsc", .is_clock_set = std::nullopt}, std::nullopt),
            "good clock: unknown if it is synchronised: the system does not say; \n");
  EXPECT_EQ(text_of({check_system({.clock_source = "tsc", .is_clock_set = false}, std::nullopt, Daemon::Elsewhere).at(2)}),
            "good clock: not synchronised, of this machine; dtsd may run on another one; \n");
  v1::StatusSnapshot status;
  status.add_notices("the clock of this machine says 2020-01-01T00:00 UTC, and session s began later; set the clock (timedatectl), or X");
  EXPECT_EQ(
      clock_of({.clock_source = "tsc"}, status),
      "bad clock: the clock of this machine says 2020-01-01T00:00 UTC, and session s began later; set the clock (timedatectl), or X\n");
}

TEST(DoctorCalibration, NamesItsDate_AndWhatTheDaemonDoubts) {
  RecordProperty("requirement", "COP-14");
  v1::StatusSnapshot status;
  v1::RigInfo rig;
  rig.set_name("floor");
  EXPECT_FALSE(check_calibration(status, rig)) << "not of a floor";
  rig.set_kind("floor");
  rig.set_device_uri("sim:floor");
  EXPECT_FALSE(check_calibration(status, rig)) << "the simulated plate is the plate model";
  rig.set_device_uri("mcc:usb-1408fs");
  EXPECT_EQ(text_of({check_calibration(status, rig).value()}),
            "good floor calibration: no calibration: the plate model is used; dtsctl calibrate cop --rig floor\n");
  rig.set_is_force_plate(true);
  EXPECT_FALSE(check_calibration(status, rig)) << "the maker calibrated it";
  for (const auto& [id, date] : {std::pair{"cop-20260131T120000Z-1a2b3c4d", ", of 2026-01-31"}, std::pair{"cop-2026013", ""},
                                 std::pair{"cop-x0260131T", ""}, std::pair{"mine", ""}}) {
    rig.set_calibration(id);
    EXPECT_EQ(text_of({check_calibration(status, rig).value()}), "good floor calibration: " + std::string(id) + date + "; \n");
  }
  status.add_notices("rig 'chair': the calibration of 2026-01-31 was measured with A, not with B; calibrate again");
  EXPECT_TRUE(check_calibration(status, rig)->fix.empty()) << "it is another rig's";
  status.add_notices("rig 'floor': the calibration of 2026-01-31 was measured with A, not with B; calibrate again");
  EXPECT_EQ(text_of({check_calibration(status, rig).value()}),
            "bad floor calibration: rig 'floor': the calibration of 2026-01-31 was measured with A, not with B; calibrate again\n");
  status.set_notices(1,
                     "rig 'floor': the calibration of 2026-01-31 was measured with A 1, and the device is 2, another unit of the same "
                     "model; compare a known weight");
  EXPECT_TRUE(check_calibration(status, rig)->is_good);
  EXPECT_EQ(check_calibration(status, rig)->fix, "compare a known weight");
  status.set_notices(1, "rig 'floor': the calibration of 2026-01-31 is more than 180 days old; compare a known weight");
  EXPECT_TRUE(check_calibration(status, rig)->is_good) << "it may be as good as on its first day";
}

TEST(DoctorSensorCurves, WhatTheDaemonDoubtsIsNamed) {
  RecordProperty("requirement", "SIG-8");
  v1::StatusSnapshot status;
  v1::RigInfo rig;
  rig.set_name("floor");
  status.add_notices("rig 'chair': sensor curves (s1) are of rig 'old'; calibrate again");
  EXPECT_TRUE(check_sensor_curves(status, rig).empty()) << "another rig's";
  status.add_notices("rig 'floor': sensor curves (w1, w2) were measured at other sensors (w2, w1); name the files");
  status.add_notices(
      "rig 'floor': sensor curves (w3) were measured with A 1, and the device is 2, another unit of the same model; compare");
  EXPECT_EQ(text_of(check_sensor_curves(status, rig)),
            "bad floor sensor curves: rig 'floor': sensor curves (w1, w2) were measured at other sensors (w2, w1); name the files\n"
            "good floor sensor curves: rig 'floor': sensor curves (w3) were measured with A 1, and the device is 2, another unit of the "
            "same model; compare\n");
}

TEST(DoctorRate, ThatIsNoNumber_IsNotKnown) {
  v1::RigStatus rig = testing::floor_status().rigs(0);
  for (const double rate_hz : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    rig.set_measured_rate_hz(rate_hz);
    EXPECT_EQ(text_of({check_rig(rig).at(2)}), "bad floor rate: not measured yet; wait 10 s, then run dtsctl doctor again\n");
  }
}

TEST(DoctorSessions, InterruptedOnes_AreNamedAndAreNoFault) {
  v1::ListSessionsResponse sessions;
  EXPECT_EQ(text_of({check_sessions(sessions)}), "good sessions: none is interrupted; \n");
  for (const char* id : {"a", "b", "c", "d"}) {
    v1::SessionRecord& session = *sessions.add_sessions();
    session.set_session_id(id);
    session.set_state(id == std::string("b") ? "complete" : "interrupted");
  }
  const std::string fix = "; see dtsctl session show ID; to continue: dtsctl session resume ID\n";
  EXPECT_EQ(text_of({check_sessions(sessions)}), "good sessions: 3 sessions are interrupted: a, c, d" + fix);
  sessions.mutable_sessions(1)->set_state("interrupted");
  EXPECT_EQ(text_of({check_sessions(sessions)}), "good sessions: 4 sessions are interrupted: a, b, c, ..." + fix);
}

TEST(SystemFacts, OfThisMachine_AreWhatAThreadFinds) {
  int refused = -1;
  std::thread([&refused] {
    const sched_param lowest{.sched_priority = 1};
    refused = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &lowest);
  }).join();

  EXPECT_EQ(gather_system_facts().may_use_fifo, refused == 0);
  EXPECT_GT(gather_system_facts().lockable_bytes, 0U);
}

TEST(DoctorNetwork, AListenerIsFoundByItsPort) {
  const int listening = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ASSERT_EQ(::bind(listening, reinterpret_cast<const sockaddr*>(&address), size), 0);
  ASSERT_EQ(::getsockname(listening, reinterpret_cast<sockaddr*>(&address), &size), 0);
  const std::string endpoint = "tcp://*:" + std::to_string(ntohs(address.sin_port));
  EXPECT_FALSE(has_listener(endpoint)) << "bound, but not listening";
  ASSERT_EQ(::listen(listening, 1), 0);
  EXPECT_TRUE(has_listener(endpoint));
  ::close(listening);
  EXPECT_FALSE(has_listener(endpoint));
}

TEST(DoctorNetwork, ARelayThatDoesNotListenIsAFault) {
  v1::StatusSnapshot status;
  EXPECT_EQ(text_of({check_network(status, "")}), "good network: off: this machine only; \n");
  status.set_has_network(true);
  EXPECT_EQ(text_of({check_network(status, "")}), "good network: on for clients with keys, through dts-relay; \n");
  EXPECT_EQ(text_of({check_network(status, "tcp://*:5555")}),
            "bad network: on, but dts-relay does not listen at tcp://*:5555: no client with a key can connect; see systemctl status "
            "dts-relay, then: systemctl restart dts-relay\n");
}

TEST_F(RunTest, DoctorWithoutDaemon_FailsAndSaysHowToStartIt) {
  RecordProperty("requirement", "UI-9");
  EXPECT_EQ(run_with({"doctor"}), cli::kFailed);

  EXPECT_THAT(out(), ::testing::HasSubstr("wrong  daemon: no daemon at " + control_ + ": the socket does not exist; try: start it"));
}

}  // namespace
}  // namespace dts::ctl
