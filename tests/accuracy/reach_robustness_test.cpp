// SPDX-License-Identifier: Apache-2.0
// Bad sensors, unusual people and unusual behaviour on the shipped chair, from simulated volts to the class: a reach may go without an
// answer, but no class contradicts the trunk angle that the simulator had. Synthetic.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "classifier/trunk_model.h"
#include "core/clock.h"
#include "device/registry.h"
#include "files/rig_file.h"
#include "session/rig_pipeline.h"

namespace dts {
namespace {

using core::TrunkClass;

constexpr double kRateHz = 250.0;  // the chair's 1500 Hz give the same reaches for six times the work
constexpr std::size_t kBlockScans = 5;
constexpr double kDurationS = 85.0;  // two rounds through the five targets
constexpr double kToleranceDeg = 6.0;
constexpr double kEveryS = 7.0;  // between two cues
constexpr int kSeeds = 3;

/// What a situation must come to, beyond never being contradicted by the truth.
enum class Outcome {
  Answers,    ///< At least half of the reaches get a class.
  Careful,    ///< Nothing more.
  NoAnswer,   ///< Every reach is rejected.
  ArmAlone,   ///< Nothing above class 1.
  NoReaches,  ///< Nothing is found at all.
};

struct Situation {
  const char* name;
  const char* options;  ///< Of `sim:chair`.
  Outcome outcome = Outcome::Careful;
  double target_cm = 0.0;    ///< A cue to this target every few seconds; 0: reaches come by themselves.
  std::uint16_t flags = 0U;  ///< At least one reach has one of these.
  int most_wrong = 0;        ///< Known weaknesses, so that they do not grow.
};

void PrintTo(const Situation& situation, std::ostream* out) { *out << situation.name; }

namespace flag = core::reach_flag;
constexpr const char* kChild = "weight_kg=20&height_cm=115&arm_length_cm=45&max_reach_cm=80";

const std::vector<Situation>& situations() {
  static const std::vector<Situation> all{
      {"Healthy", "", Outcome::Answers},
      {"Stroke", "group=stroke", Outcome::Careful},
      {"Upright", "back_rest=0"},
      {"UnusedSensorDead", "dead=0&sensor_fault_at_s=12", Outcome::Answers},
      {"RearDead", "dead=1&sensor_fault_at_s=12", Outcome::Careful, 0.0, flag::kSubstituted},
      {"FrontDead", "dead=9&sensor_fault_at_s=12", Outcome::Careful, 0.0, flag::kSubstituted},
      {"DeadFromTheStart", "dead=1", Outcome::NoAnswer},
      {"RearRowDead", "dead=1,4&sensor_fault_at_s=12"},
      {"FrontRowDead", "dead=9,12&sensor_fault_at_s=12"},
      {"LeftColumnDead", "dead=1,9&sensor_fault_at_s=12", Outcome::Careful, 0.0, flag::kSubstituted},
      {"DiagonalDead", "dead=1,12&sensor_fault_at_s=12", Outcome::Careful, 0.0, flag::kSubstituted},
      {"ThreeDead", "dead=1,4,9&sensor_fault_at_s=12"},
      {"DiesInAReach", "dead=4&sensor_fault_at_s=37"},
      {"RearSaturated", "saturated=1&sensor_fault_at_s=12"},
      {"FrontSaturated", "saturated=12&sensor_fault_at_s=12"},
      {"SaturatedFromTheStart", "saturated=9", Outcome::NoAnswer},
      {"SwappedFrontAndRear", "swapped=1:9", Outcome::Careful, 0.0, flag::kImplausible},
      {"SwappedDiagonally", "swapped=4:9", Outcome::Careful, 0.0, flag::kImplausible},
      {"SwappedSides", "swapped=1:4", Outcome::Answers},
      {"Child", kChild, Outcome::NoAnswer},
      {"Heavy", "weight_kg=130&height_cm=185&arm_length_cm=71&max_reach_cm=130"},
      {"HandOnly", "reaches=cued", Outcome::ArmAlone, 54.0},
      // A second way out that begins before the first has come back, and ends hardly higher, is not told from a notch: it has no flag,
      // and being quick it looks like a farther one.
      {"Doubled", "double_reach=1", Outcome::Careful, 0.0, flag::kResumed, 1},
      {"StandsUpInAReach", "reaches=cued&stand_up_s=28.9", Outcome::Careful, 125.0, flag::kStoodUp},
      {"StandsUpAtTheTarget", "reaches=cued&stand_up_s=29.5", Outcome::Careful, 125.0},
      {"NeverReaches", "reaches=none", Outcome::ArmAlone},
      {"Nobody", "sit_down_s=86400", Outcome::NoReaches},
      {"UnevenSensors", "gain_spread=0.05&drift=20"},
  };
  return all;
}

/// One examination: what was found, and the true angle of every scan. A later Final of the same number replaces an earlier one, and with
/// it the class: only the last one stands.
struct Examination {
  std::map<std::uint32_t, core::ReachEvent> reaches;
  std::map<std::uint32_t, core::ClassEvent> classes;
  std::vector<double> trunk_deg;
};

class ReachRobustness : public testing::TestWithParam<Situation> {
 protected:
  void SetUp() override {
    files::Problems problems;
    config_ = files::read_rig_file(DTS_SOURCE_DIR "/config/rigs/chair-sim.toml", problems);
    ASSERT_TRUE(problems.empty()) << files::to_string(problems.front());
    config_.name = "chair";
    config_.rate = *core::Rate::from_hz(kRateHz);
    config_.block_scans = kBlockScans;
  }

  [[nodiscard]] Examination examine(int seed) const {
    core::VirtualClock clock(1'000'000'000);
    const std::string options = *GetParam().options == '\0' ? "" : std::string("&") + GetParam().options;
    auto device = device::create_device("sim:chair?seed=" + std::to_string(seed) + options, {.clock = clock, .rig = config_.model});
    Examination result;
    EXPECT_TRUE(device) << core::to_string(device.error());
    if (!device || !(*device)->open() || !(*device)->start({.rate = config_.rate, .max_block_scans = kBlockScans})) {
      ADD_FAILURE() << "the device does not start";
      return result;
    }
    run(**device, clock, result);
    return result;
  }

 private:
  void run(device::Device& device, core::Clock& clock, Examination& result) const {
    const device::DeviceDescription description = device.describe();
    const auto made = session::make_rig_pipeline(config_, description);
    ASSERT_TRUE(made) << core::to_string(made.error());
    const auto truth = std::ranges::find(description.channels, "true_trunk_deg", &device::ChannelDescription::name);
    ASSERT_NE(truth, description.channels.end());
    const auto channel = static_cast<std::size_t>(truth - description.channels.begin());
    core::Frame frame = made->pipeline->make_frame();
    core::Acquired acquired{.block = core::Block(description.channels.size(), kBlockScans)};
    double next_cue_s = kEveryS;
    while (static_cast<double>(result.trunk_deg.size()) < kDurationS * kRateHz) {
      ASSERT_EQ(device.read(acquired.block, std::int64_t{1} << 62U).outcome, device::ReadOutcome::Scans);
      const auto angles = acquired.block.column(channel);
      result.trunk_deg.insert(result.trunk_deg.end(), angles.begin(), angles.end());
      if (GetParam().target_cm > 0.0 && static_cast<double>(result.trunk_deg.size()) >= next_cue_s * kRateHz) {
        device.hear({.is_go = true, .at_ns = clock.now_ns(), .target_cm = GetParam().target_cm});
        next_cue_s += kEveryS;
      }
      made->pipeline->process(acquired, frame);
      for (const core::ReachEvent& reach : made->pipeline->events().reaches.all_of()) {
        if (reach.step == core::ReachStep::Final) result.reaches[reach.number] = reach;
      }
      for (const core::ClassEvent& answer : made->pipeline->events().classes.all_of()) result.classes[answer.number] = answer;
    }
  }

  pipeline::RigConfig config_;
};

/// The farthest that the trunk bent from the start of a reach to a little after its P3 (the target is hit 0.15 s later), deg; NaN: nobody
/// was there.
double true_deg(const Examination& examination, const core::ReachEvent& reach) {
  const auto margin = static_cast<std::uint64_t>(0.2 * kRateHz);
  const std::uint64_t from = reach.p1.scan.value;
  const std::uint64_t to = std::min<std::uint64_t>(reach.p3.scan.value + margin, examination.trunk_deg.size());
  double most_deg = std::nan("");
  for (std::uint64_t scan = from; scan < to; ++scan) most_deg = std::fmax(most_deg, examination.trunk_deg[scan]);
  return most_deg;
}

/// No class may be farther from the truth than by its border and the tolerance.
bool is_contradicted(TrunkClass said, double deg) {
  if (said == TrunkClass::Rejected) return false;
  constexpr std::array<double, 4> kFromDeg = {-90.0, -90.0, classifier::kModerateFromDeg, classifier::kMaximumFromDeg};
  constexpr std::array<double, 4> kToDeg = {0.0, classifier::kModerateFromDeg, classifier::kMaximumFromDeg, 90.0};
  const auto index = static_cast<std::size_t>(said);
  return !(deg >= kFromDeg[index] - kToleranceDeg && deg <= kToDeg[index] + kToleranceDeg);
}

/// What all examinations of a situation came to.
class Tally {
 public:
  explicit Tally(const Situation& situation) : situation_(situation) {}

  void add(const Examination& examination, int seed) {
    for (const auto& [number, reach] : examination.reaches) flags_ |= reach.flags;
    for (const auto& [number, answer] : examination.classes) {
      const auto reach = examination.reaches.find(number);
      ASSERT_NE(reach, examination.reaches.end());
      const TrunkClass said = answer.movement.trunk_class;
      const double deg = true_deg(examination, reach->second);
      ++told_;
      answered_ += said == TrunkClass::Rejected ? 0 : 1;
      highest_ = std::max(highest_, said);
      if (!is_contradicted(said, deg)) continue;
      EXPECT_LE(++wrong_, situation_.most_wrong)
          << "seed " << seed << ", reach " << number << " at " << static_cast<double>(reach->second.p1.scan.value) / kRateHz << " s: class "
          << static_cast<int>(said) << " (" << answer.movement.trunk_deg << " deg), true " << deg << " deg, flags 0x" << std::hex
          << reach->second.flags;
    }
  }

  void expect_outcome() const {
    EXPECT_TRUE(situation_.flags == 0 || (flags_ & situation_.flags) != 0) << "no reach was flagged";
    switch (situation_.outcome) {
      case Outcome::Answers: EXPECT_GE(2 * answered_, told_); break;
      case Outcome::NoAnswer: EXPECT_EQ(answered_, 0U); break;
      case Outcome::ArmAlone: EXPECT_LE(highest_, TrunkClass::Minor); break;
      case Outcome::NoReaches: EXPECT_EQ(told_, 0U); return;
      case Outcome::Careful: break;
    }
    EXPECT_GT(told_, 0U) << "nothing happened: this situation shows nothing";
  }

  [[nodiscard]] std::string text() const { return std::to_string(answered_) + " of " + std::to_string(told_); }

 private:
  const Situation& situation_;
  std::size_t told_ = 0;
  std::size_t answered_ = 0;
  TrunkClass highest_ = TrunkClass::Rejected;
  int wrong_ = 0;
  std::uint16_t flags_ = 0;
};

TEST_P(ReachRobustness, NoAnswer_ContradictsTheTrueAngle) {
  RecordProperty("requirement", "CLS-2");
  Tally tally(GetParam());
  for (int seed = 1; seed <= kSeeds; ++seed) tally.add(examine(seed), seed);
  tally.expect_outcome();
  RecordProperty("answers", tally.text());
}

INSTANTIATE_TEST_SUITE_P(Chair, ReachRobustness, testing::ValuesIn(situations()),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace dts
