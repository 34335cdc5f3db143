// SPDX-License-Identifier: Apache-2.0
#include "lab/replay/replay.h"

#include "device/registry.h"
#include "files/cop_calibration_file.h"
#include "files/rig_file.h"
#include "lab/simulate/simulated_rig.h"
#include "record/recorder.h"
#include "session/rig_pipeline.h"
#include "session/session_events.h"
#include "session/trial_stance.h"
#include "unit/lab/run_fixture.h"
#include "unit/physics/cop/constant_two_feet.h"

namespace dts::lab::replay {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

/// A recording that begins in the middle of a stream, as sessions do.
struct Middle {
  std::string definition = simulate::floor_definition(100.0);
  std::string device = "sim:floor?seed=3&step_on_s=4";
  std::uint64_t before_scans = 333;  ///< Not recorded.
  std::uint64_t scans = 1500;
  bool has_state = true;
  std::uint64_t lost_at = 0;  ///< About this scan a block finds no room on the way to the recorder.
  bool is_closed = true;
  double stance_width_mm = 0.0;   ///< Stated when the recording begins.
  std::uint64_t one_foot_at = 0;  ///< "Go" of a trial on one foot; 0: none.
  float spoilt_by = 0.0F;         ///< Added to one value of the centre of pressure.
};

void record_middle(const Middle& middle, const std::string& file) {
  files::Problems problems;
  pipeline::RigConfig config = files::read_rig_text(middle.definition, "definition", problems);
  ASSERT_TRUE(problems.empty()) << files::to_string(problems.front());
  config.name = "floor";
  config.block_scans = 13;
  core::VirtualClock clock(1'000'000'000);
  auto device = device::create_device(middle.device, {.clock = clock, .rig = config.model}).value();
  ASSERT_TRUE(device->open());
  ASSERT_TRUE(device->start({.rate = config.rate, .max_block_scans = 13}));
  auto rig = session::make_rig_pipeline(config, device->describe()).value();
  record::SessionFacts facts{.session_id = "20260101T000000Z-floor-1", .rig = "floor", .kind = "floor", .protocol = "free"};
  facts.boot_id = "test";
  facts.stages = rig.pipeline->stage_texts();
  facts.rig_definition = middle.definition;
  core::Acquired acquired{.block = core::Block(device->describe().channels.size(), 13)};
  core::Frame frame = rig.pipeline->make_frame();
  std::unique_ptr<record::Recorder> recorder;
  bool is_one_foot_announced = middle.one_foot_at == 0;
  std::uint32_t segment = 0;
  for (std::uint64_t done = 0; done < middle.before_scans + middle.scans;) {
    const auto read = device->read(acquired.block, std::int64_t{1} << 62U);
    if (read.outcome == device::ReadOutcome::Gap) {
      acquired.gap_before = read.gap;
      ++segment;
      continue;
    }
    ASSERT_EQ(read.outcome, device::ReadOutcome::Scans);
    acquired.block.segment = segment;
    if (!recorder && done >= middle.before_scans) {
      recorder =
          record::Recorder::create(file, facts, session::recorded_streams(config, device->describe(), rig.pipeline->formats())).value();
      rig.stances->begin(middle.stance_width_mm);
      std::vector<double> state(rig.pipeline->state_size());
      rig.pipeline->save(state);
      if (middle.has_state) recorder->set_stage_state(state);
    }
    if (recorder && !is_one_foot_announced && done >= middle.one_foot_at) {
      const session::TrialEvent go{.kind = session::TrialEventKind::Go, .trial = 1, .labels = {{"feet", "one"}}};
      v1::Event event = session::to_event(go, facts.session_id);
      event.set_segment(segment);
      event.set_scan(middle.one_foot_at);
      ASSERT_TRUE(recorder->take(event));
      session::announce_feet(*rig.stances, go, segment, {middle.one_foot_at}, config.rate);
      is_one_foot_announced = true;
    }
    rig.pipeline->process(acquired, frame);
    acquired.gap_before = {};
    if (middle.spoilt_by != 0.0F && done > 1000) frame.streams[3].column(0)[0] += static_cast<double>(middle.spoilt_by);
    const bool is_lost = middle.lost_at > 0 && done <= middle.lost_at && middle.lost_at < done + acquired.block.count();
    done += acquired.block.count();
    if (recorder && !is_lost) {
      ASSERT_TRUE(recorder->take(frame, {}));
    }
  }
  ASSERT_TRUE(recorder->flush());
  if (middle.is_closed) {
    ASSERT_TRUE(recorder->close(""));
  }
}

const nlohmann::json& stream(const nlohmann::json& report, const std::string& name) {
  for (const auto& one : report["streams"]) {
    if (one["stream"] == name) return one;
  }
  throw std::runtime_error("no stream " + name);
}

TEST_F(RunTest, ReplayOfASimulation_IsIdenticalAndTellsTheCentreOfPressure) {
  RecordProperty("requirement", "REC-6");
  ASSERT_EQ(run_with({"simulate", "floor", "--duration", "20", "--rate", "250", "--seed", "5", "--out", path("a.xdf")}), cli::kOk)
      << talk();

  ASSERT_EQ(run_with({"replay", path("a.xdf"), "--speed", "max", "--json"}), cli::kOk) << talk();

  EXPECT_TRUE(json()["is_identical"]);
  EXPECT_TRUE(json()["is_state_restored"]);
  EXPECT_EQ(json()["scans"], 5000);
  EXPECT_EQ(json()["segments"], 1);
  EXPECT_EQ(json()["streams"].size(), 3U);
  EXPECT_EQ(stream(json(), "floor/cop")["scans"], 4998);
  EXPECT_GT(json()["scans_per_s"], 0.0);
  EXPECT_NEAR(json()["cop"]["last"]["load_n"], 686.0, 100.0);
  EXPECT_EQ(talk(), "");
}

TEST_F(RunTest, ReplayFromTheMiddleOfAStream_IsIdenticalFromItsFirstScan) {
  // Saved while empty and not yet tared, in the middle of the tare, while somebody steps on, and while standing.
  for (const std::uint64_t before : {0U, 1U, 52U, 333U, 430U, 900U}) {
    const std::string file = path("middle" + std::to_string(before) + ".xdf");
    record_middle({.before_scans = before}, file);

    ASSERT_EQ(run_with({"replay", file, "--json"}), cli::kOk) << talk() << out();

    const std::uint64_t missing = before == 0 ? 2 : 0;  // a window that fills for the first time
    EXPECT_EQ(stream(json(), "floor/filtered")["scans"], json()["scans"].get<std::uint64_t>() - missing);
    EXPECT_EQ(stream(json(), "floor/cop")["scans"], json()["scans"].get<std::uint64_t>() - missing);
  }
}

TEST_F(RunTest, ReplayWithGapsAndOtherStages_IsIdentical) {
  std::string definition = simulate::floor_definition(100.0);
  definition.replace(definition.find("window_scans = 3"), 16, "window_scans = 40\nshift_scans = 7");
  definition += "[trigger]\nchannel = 4\nlevel = 0.0\nhysteresis = 0.01\n";
  record_middle({.definition = definition, .device = "sim:floor?seed=3&extra=1&fault=overrun&fault_at_s=6&fault_for_s=2"}, path("gap.xdf"));

  ASSERT_EQ(run_with({"replay", path("gap.xdf"), "--json"}), cli::kOk) << talk() << out();

  EXPECT_EQ(json()["segments"], 2);
  EXPECT_GT(stream(json(), "floor/cop")["scans"], 180);
}

/// The floor platform with a correction for two feet: 10 % more load, 20 % if the stance width is unknown.
std::string definition_with_two_feet() {
  const std::string definition = simulate::floor_definition(100.0);
  files::Problems problems;
  const physics::RigModel rig = files::read_rig_text(definition, "definition", problems).model;
  const auto samples = physics::model_samples(physics::CopMethod::Poly3, rig, physics::PlateBehaviour::Stiffening).value();
  auto calibration = physics::calibrate_cop(physics::CopMethod::Poly3, samples, {.created_utc = "2026-01-31T12:00:00Z"}).value();
  calibration.points.clear();
  calibration.two_feet = physics::TwoFeetCorrection::from_form(physics::test::constant_form()).value();
  std::string text = "[calibration]\n" + files::cop_calibration_text(calibration);
  for (std::size_t at = text.find("\n["); at != std::string::npos; at = text.find("\n[", at + 2)) text.insert(at + 2, "calibration.");
  return definition + text;
}

TEST_F(RunTest, ReplayOfAPersonOnTwoFeetAndOnOne_IsIdentical) {
  for (const std::uint64_t before : {0U, 333U, 900U}) {
    const std::string file = path("feet" + std::to_string(before) + ".xdf");
    record_middle({.definition = definition_with_two_feet(), .before_scans = before, .stance_width_mm = 180.0, .one_foot_at = 1100}, file);

    ASSERT_EQ(run_with({"replay", file, "--json"}), cli::kOk) << talk() << out();

    EXPECT_TRUE(json()["is_identical"]);
    const double load_n = json()["cop"]["last"]["load_n"];
    EXPECT_NEAR(load_n, 0.91 * 686.0, 15.0) << "on one foot the point calibration applies";
  }
  record_middle({.definition = definition_with_two_feet(), .stance_width_mm = 180.0}, path("two.xdf"));
  ASSERT_EQ(run_with({"replay", path("two.xdf"), "--json"}), cli::kOk) << talk() << out();
  EXPECT_NEAR(json()["cop"]["last"]["load_n"].get<double>(), 1.1 * 0.91 * 686.0, 15.0) << "by the stated width";
}

TEST_F(RunTest, ReplayWithoutStateOrByAnotherRig_TellsTheFirstDifference) {
  record_middle({.has_state = false}, path("stateless.xdf"));
  EXPECT_EQ(run_with({"replay", path("stateless.xdf"), "--json"}), cli::kFailed);
  EXPECT_FALSE(json()["is_state_restored"]);
  EXPECT_THAT(talk(), HasSubstr("does not contain the state"));

  std::string other = simulate::floor_definition(100.0);
  other.replace(other.find("window_scans = 3"), 16, "window_scans = 5");
  record_middle({}, path("good.xdf"));
  EXPECT_EQ(run_with({"replay", path("good.xdf"), "--rig", write("rig.toml", other), "--json"}), cli::kFailed);
  EXPECT_THAT(talk(), HasSubstr("differ from the recorded stages"));
  EXPECT_EQ(stream(json(), "floor/filtered")["first_difference"]["scan"], 338) << "five scans make its first window, and one was enough";
}

TEST_F(RunTest, ReplayOfASpoiltValue_NamesSegmentScanChannelAndBothValues) {
  record_middle({.spoilt_by = 0.25F}, path("spoilt.xdf"));

  EXPECT_EQ(run_with({"replay", path("spoilt.xdf"), "--json"}), cli::kFailed);

  EXPECT_TRUE(stream(json(), "floor/deflection")["is_identical"]);
  const auto difference = stream(json(), "floor/cop")["first_difference"];
  EXPECT_EQ(difference["segment"], 0);
  EXPECT_EQ(difference["channel"], "ml_mm");
  EXPECT_GE(difference["scan"], 1000);
  EXPECT_NEAR(std::stod(difference["recorded"].get<std::string>()) - std::stod(difference["computed"].get<std::string>()), 0.25, 1e-4);
  EXPECT_EQ(run_with({"replay", path("spoilt.xdf")}), cli::kFailed);
  EXPECT_THAT(out(), HasSubstr("differs at segment 0, scan "));
}

TEST_F(RunTest, ReplayWithNothingToCompare_DoesNotCallItIdentical) {
  record_middle({.definition = simulate::floor_definition(100.0) + "[record]\nstreams = [\"raw\"]\n"}, path("raw.xdf"));

  EXPECT_EQ(run_with({"replay", path("raw.xdf"), "--json"}), cli::kOk) << talk();

  EXPECT_FALSE(json().contains("is_identical"));
  EXPECT_EQ(json()["streams"].size(), 0U);
  EXPECT_GT(json()["scans"], 1000);
  EXPECT_THAT(talk(), HasSubstr("nothing to compare"));
}

TEST_F(RunTest, ReplayAfterScansWereLost_ComparesUpToThere) {
  record_middle({.lost_at = 1200}, path("lost.xdf"));

  EXPECT_EQ(run_with({"replay", path("lost.xdf"), "--json"}), cli::kOk) << out();

  EXPECT_THAT(talk(), HasSubstr("the recorder lost scans at scan"));
  EXPECT_LT(stream(json(), "floor/cop")["scans"], 900);
  EXPECT_GT(stream(json(), "floor/cop")["scans"], 700);
}

TEST_F(RunTest, ReplayOfWhatIsTornOrNoneOfOurs_ExitsAsTheManualSays) {
  record_middle({.is_closed = false}, path("torn.xdf"));
  const std::string torn = path("torn.xdf.part");
  std::filesystem::resize_file(torn, std::filesystem::file_size(torn) - 5);
  EXPECT_EQ(run_with({"replay", torn, "--json"}), cli::exit_status(core::ErrorCode::DataDamaged));
  EXPECT_TRUE(json()["is_identical"]) << "as far as it goes";
  EXPECT_NE(json()["damage"], "");

  auto foreign = record::XdfWriter::create(path("foreign.xdf"), {}).value();
  const auto number =
      foreign->add_stream({.name = "EEG", .content = "EEG", .rate = core::Rate::create(100, 1).value(), .channels = {{.label = "Fz"}}});
  ASSERT_TRUE(foreign->write_samples(number, 1.0, std::vector<double>(100, 1.0), {}));
  ASSERT_TRUE(foreign->close());
  EXPECT_THAT(refusal_of({"replay", path("foreign.xdf")}), HasSubstr("not a recording of dtsd"));

  EXPECT_EQ(run_with({"replay", path("none.xdf")}), cli::kUsage);
  EXPECT_EQ(run_with({"replay", write("text.xdf", "no XDF at all")}), cli::exit_status(core::ErrorCode::DataDamaged));
}

}  // namespace
}  // namespace dts::lab::replay
