// SPDX-License-Identifier: Apache-2.0
#include "ctl/doctor.h"

#include <pthread.h>
#include <sched.h>

#include <limits>
#include <thread>

#include "unit/ctl/run_fixture.h"

namespace dts::ctl {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const SystemFacts kGoodMachine{.may_use_fifo = true, .lockable_bytes = std::numeric_limits<std::uint64_t>::max(), .clock_source = "tsc"};

bool is_well(const std::vector<Check>& checks) { return std::ranges::all_of(checks, &Check::is_good); }

TEST(Doctor, GoodMachineAndRig_AllIsWell) {
  EXPECT_TRUE(is_well(check_system(kGoodMachine, std::nullopt)));
  EXPECT_TRUE(is_well(check_rig(testing::floor_status().rigs(0))));
  EXPECT_TRUE(check_version(std::string(client::version())).is_good);
  EXPECT_TRUE(check_version(std::string(client::version()) + "+g1234").is_good);
}

TEST(Doctor, EveryBadFindingAndEveryNote_HasAFix) {
  v1::RigStatus rig = testing::floor_status().rigs(0);
  rig.set_measured_rate_hz(98.9);
  rig.set_lost_scans_total(3);
  std::vector<Check> checks = check_rig(rig);
  checks.push_back(check_version("9.9.9"));
  std::ranges::move(check_system({.may_use_fifo = false, .lockable_bytes = 1024, .clock_source = "hpet"}, std::nullopt),
                    std::back_inserter(checks));

  const auto bad = std::ranges::count_if(checks, [](const Check& check) { return !check.is_good; });

  EXPECT_EQ(bad, 3) << "rate, losses, version";
  const auto advice = std::ranges::count_if(checks, [](const Check& check) { return !check.fix.empty(); });
  EXPECT_EQ(advice, 6) << "and notes of scheduling, memory, clock";
  EXPECT_TRUE(std::ranges::all_of(checks, [](const Check& check) { return check.is_good || !check.fix.empty(); }));
}

TEST(Doctor, RateAtTheLimitOfOnePercent_IsWellJustInside) {
  v1::RigStatus rig = testing::floor_status().rigs(0);
  rig.set_measured_rate_hz(99.01);
  EXPECT_TRUE(is_well(check_rig(rig)));
  rig.set_measured_rate_hz(101.01);
  EXPECT_FALSE(is_well(check_rig(rig)));
  rig.set_measured_rate_hz(0.0);
  EXPECT_FALSE(is_well(check_rig(rig)));
  rig.set_measured_rate_hz(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(is_well(check_rig(rig)));
}

TEST(Doctor, DeviceGone_OneFindingWithTheReason) {
  v1::RigStatus rig = testing::floor_status().rigs(0);
  rig.set_device(v1::DEVICE_STATE_GONE);
  rig.set_device_message("cable pulled");

  const std::vector<Check> checks = check_rig(rig);

  ASSERT_EQ(checks.size(), 1U);
  EXPECT_FALSE(checks[0].is_good);
  EXPECT_THAT(checks[0].finding, HasSubstr("cable pulled"));
}

TEST(Doctor, DeadSensorOfAStreamingDevice_IsAFinding) {
  v1::RigStatus rig = testing::floor_status().rigs(0);
  rig.set_device_message("sensor ch3 is outside of its calibration curve, at 0.004 V: check its plug and supply");

  const std::vector<Check> checks = check_rig(rig);

  EXPECT_FALSE(checks[0].is_good);
  EXPECT_THAT(checks[0].finding, HasSubstr("sensor ch3"));
  EXPECT_THAT(checks[0].fix, HasSubstr("dtsctl device test"));
}

TEST(Doctor, LossesOfASlowMachine_SendNobodyToTheCable) {
  v1::RigStatus rig = testing::floor_status().rigs(0);
  rig.set_lost_scans_total(500);
  rig.set_gaps_total(1);
  v1::LossCount& loss = *rig.add_losses();
  loss.set_gaps_total(1);
  loss.set_reason(v1::GAP_REASON_OVERRUN);
  EXPECT_THAT(check_rig(rig)[1].fix, AllOf(HasSubstr("machine was too slow"), Not(HasSubstr("cable"))));
  loss.set_reason(v1::GAP_REASON_SILENCE);
  EXPECT_THAT(check_rig(rig)[1].fix, AllOf(HasSubstr("check cable"), Not(HasSubstr("machine"))));
}

TEST(Doctor, WhatTheDaemonWasRefused_IsANoteAndNothingWrong) {
  const SystemFacts poor{.may_use_fifo = false, .lockable_bytes = 1024, .clock_source = "tsc"};
  v1::StatusSnapshot status = testing::floor_status();
  EXPECT_TRUE(is_well(check_system(poor, status)));

  status.add_notices("thread acquire: SCHED_FIFO refused: Operation not permitted");
  status.add_notices("memory is not locked, pages may be swapped out: Cannot allocate memory");
  const auto checks = check_system(poor, status);
  EXPECT_TRUE(is_well(checks));
  EXPECT_EQ(std::ranges::count_if(checks, [](const Check& check) { return !check.fix.empty(); }), 2);
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

TEST_F(RunTest, DoctorWithoutDaemon_FailsAndSaysHowToStartIt) {
  EXPECT_EQ(run_with({"doctor"}), cli::kFailed);

  EXPECT_THAT(out(), HasSubstr("wrong  daemon: no daemon at " + control_ + ": the socket does not exist; try: start it"));
}

TEST_F(RunTest, DoctorWithDaemon_FindsDataAndSpeaksJson) {
  const testing::FakeController control(control_, [](const v1::Request& request, int) {
    return std::vector{testing::reply(request, [](v1::Response& response) { *response.mutable_status() = testing::floor_status(); })};
  });
  testing::FakePublisher data(data_);
  std::jthread publisher([&] {
    if (!data.wait_for_subscription("")) return;
    data.send("dtsd/status", testing::floor_status());
    data.send("floor/cop", testing::block(1, 0, 1, 1));
  });

  const int status = run_with({"doctor", "--json"});

  publisher.join();
  const auto report = json();
  EXPECT_EQ(status, report.at("ok").get<bool>() ? cli::kOk : cli::kFailed);
  const auto found = [&](const std::string& name) {
    for (const auto& check : report.at("checks")) {
      if (check.at("name") == name) return check.at("ok").get<bool>();
    }
    return false;
  };
  for (const char* name : {"address", "daemon", "version", "floor device", "floor rate", "floor losses", "data"}) {
    EXPECT_TRUE(found(name)) << name << report.dump(2);
  }
}

TEST_F(RunTest, DoctorWithDaemonThatSendsItsStatusOnly_FindsNoData) {
  const testing::FakeController control(control_, [](const v1::Request& request, int) {
    return std::vector{testing::reply(request, [](v1::Response& response) { *response.mutable_status() = testing::floor_status(); })};
  });
  testing::FakePublisher data(data_);
  std::jthread publisher([&] {
    if (data.wait_for_subscription("")) data.send("dtsd/status", testing::floor_status());
  });

  EXPECT_EQ(run_with({"doctor", "--timeout", "0.5"}), cli::kFailed);

  publisher.join();
  EXPECT_THAT(out(), HasSubstr("wrong  data: no scans came from " + data_ + " within 0.5 s"));
}

}  // namespace
}  // namespace dts::ctl
