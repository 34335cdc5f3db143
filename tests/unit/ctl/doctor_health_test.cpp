// SPDX-License-Identifier: Apache-2.0
// What doctor says of queues, latency and the network.
#include <limits>

#include "ctl/doctor.h"
#include "unit/ctl/run_fixture.h"

namespace dts::ctl {
namespace {

using ::testing::HasSubstr;

const Check* find(const std::vector<Check>& checks, const std::string& name) {
  const auto found = std::ranges::find(checks, name, &Check::name);
  return found == checks.end() ? nullptr : &*found;
}

v1::RigStatus rig_with_latency(double upper_ms) {
  v1::RigStatus rig = testing::floor_status().rigs(0);
  for (const double bound : {upper_ms, std::numeric_limits<double>::infinity()}) {
    rig.mutable_latency()->add_buckets()->set_upper_ms(bound);
    rig.mutable_latency()->mutable_buckets()->rbegin()->set_blocks_total(100);
  }
  return rig;
}

TEST(DoctorQueues, HalfFull_IsAFindingWithAFix) {
  for (const auto fill : {&v1::RingFill::set_scans_percent, &v1::RingFill::set_frames_percent, &v1::RingFill::set_record_percent}) {
    v1::RigStatus rig = testing::floor_status().rigs(0);
    (rig.mutable_ring_fill()->*fill)(49.9);
    ASSERT_NE(find(check_rig(rig), "floor queues"), nullptr);
    EXPECT_TRUE(find(check_rig(rig), "floor queues")->is_good);
    (rig.mutable_ring_fill()->*fill)(50.0);
    EXPECT_FALSE(find(check_rig(rig), "floor queues")->is_good);
    EXPECT_NE(find(check_rig(rig), "floor queues")->fix, "");
  }
}

TEST(DoctorLatency, BlocksThatAreLate_AreAFinding) {
  EXPECT_TRUE(find(check_rig(rig_with_latency(50.0)), "floor latency")->is_good);
  const auto checks = check_rig(rig_with_latency(100.0));
  EXPECT_FALSE(find(checks, "floor latency")->is_good);
  EXPECT_THAT(find(checks, "floor latency")->finding, HasSubstr("within 95.0 ms"));
}

TEST(DoctorLatency, WithoutBlocksOrOfAReplay_NothingIsSaid) {
  EXPECT_EQ(find(check_rig(testing::floor_status().rigs(0)), "floor latency"), nullptr);
  v1::RigStatus replay = rig_with_latency(100.0);
  replay.mutable_rig()->set_device_uri("replay:old.xdf");
  EXPECT_EQ(find(check_rig(replay), "floor latency"), nullptr);
}

TEST(DoctorNetwork, OnOrOff_IsToldWithWhoCame) {
  v1::StatusSnapshot status = testing::floor_status();
  EXPECT_THAT(check_network(status).finding, HasSubstr("off"));
  status.set_has_network(true);
  status.set_accepted_handshakes_total(12);
  status.set_refused_handshakes_total(3);
  EXPECT_THAT(check_network(status).finding, HasSubstr("12 connections let in, 3 refused"));
  EXPECT_TRUE(check_network(status).is_good);
}

}  // namespace
}  // namespace dts::ctl
