// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <filesystem>
#include <fstream>
#include <random>

#include "files/cop_calibration_file.h"
#include "files/rig_file.h"
#include "physics/cop/cop_calibration.h"
#include "pipeline/pipeline.h"

namespace dts::files {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::filesystem::path kConfig = std::filesystem::path(DTS_SOURCE_DIR) / "config";

std::vector<std::string> texts_of(const Problems& problems) {
  std::vector<std::string> texts;
  for (const Problem& problem : problems) texts.push_back(to_string(problem));
  return texts;
}

/// A rig's pipeline with all it needs, fed with made-up volts.
class Fed {
 public:
  explicit Fed(pipeline::RigConfig config) : config_(std::move(config)) {
    config_.block_scans = 50;
    std::size_t channels = 0;
    for (const std::size_t channel : config_.sensor_channels) channels = std::max(channels, channel + 1);
    if (config_.trigger) channels = std::max(channels, config_.trigger->channel + 1);
    pipeline::PipelineInput input{.rate = config_.rate, .sensor_channels = config_.sensor_channels, .max_block_scans = 50};
    for (std::size_t channel = 0; channel < channels; ++channel) {
      if (std::ranges::find(config_.sensor_channels, channel) != config_.sensor_channels.end()) continue;
      input.aux_channels.push_back(channel);
      input.aux_formats.push_back({.name = "ch" + std::to_string(channel), .unit = "V"});
    }
    input.trigger = config_.trigger;
    auto made = pipeline::Pipeline::create(
        config_.stages, input,
        {.rig = config_.model,
         .input_ranges = std::vector<pipeline::StageContext::InputRange>(config_.sensor_channels.size(), {-10.0, 10.0, 0.0003}),
         .tare = tare_,
         .windows = windows_,
         .cop_calibration = config_.cop_calibration ? &*config_.cop_calibration : nullptr,
         .trunk_model = config_.trunk_model ? &*config_.trunk_model : nullptr});
    EXPECT_TRUE(made) << (made ? "" : core::to_string(made.error()));
    if (!made) return;
    pipeline_ = std::move(*made);
    acquired_.block = core::Block(channels, 50);
  }

  /// Bits of every value of every stream.
  std::vector<std::uint64_t> run() {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> volts(0.6, 2.5);
    core::Frame frame = pipeline_->make_frame();
    std::vector<std::uint64_t> bits;
    for (std::uint64_t first = 0; first < 500; first += 50) {
      acquired_.block.first_scan = {first};
      acquired_.block.set_count(50);
      for (std::size_t c = 0; c < acquired_.block.channel_count(); ++c) {
        for (double& value : acquired_.block.column(c)) value = volts(random);
      }
      pipeline_->process(acquired_, frame);
      for (const core::Block& block : frame.streams) {
        for (std::size_t c = 0; c < block.channel_count(); ++c) {
          for (const double value : block.column(c)) bits.push_back(std::isnan(value) ? 0 : std::bit_cast<std::uint64_t>(value));
        }
      }
    }
    return bits;
  }
  [[nodiscard]] const std::vector<std::string>& stages() const { return pipeline_->stage_texts(); }

 private:
  pipeline::RigConfig config_;
  pipeline::Tare tare_;
  pipeline::SteadinessWindows windows_;
  std::unique_ptr<pipeline::Pipeline> pipeline_;
  core::Acquired acquired_;
};

void expect_equal(const pipeline::RigConfig& one, const pipeline::RigConfig& other) {
  EXPECT_EQ(one.kind, other.kind);
  EXPECT_EQ(one.sensor_channels, other.sensor_channels);
  EXPECT_EQ(one.rate, other.rate);
  EXPECT_EQ(one.block_scans, other.block_scans);
  EXPECT_EQ(one.published, other.published);
  EXPECT_EQ(one.recorded, other.recorded);
  EXPECT_EQ(one.sync_pulse_ms, other.sync_pulse_ms);
  EXPECT_EQ(one.trigger.has_value(), other.trigger.has_value());
  EXPECT_EQ(one.model.plate.e_pa, other.model.plate.e_pa);
  EXPECT_EQ(one.model.plate.h, other.model.plate.h);
  EXPECT_EQ(one.model.support.inset, other.model.support.inset);
  ASSERT_EQ(one.model.sensors.size(), other.model.sensors.size());
  for (std::size_t s = 0; s < one.model.sensors.size(); ++s) {
    const physics::SensorModel& a = one.model.sensors[s];
    const physics::SensorModel& b = other.model.sensors[s];
    EXPECT_EQ(a.label, b.label);
    EXPECT_EQ(a.position.x, b.position.x);
    EXPECT_EQ(a.unloaded_gap, b.unloaded_gap);
    EXPECT_EQ(a.curve.name(), b.curve.name());
    for (double gap_mm = 4.0; gap_mm < 13.0; gap_mm += 0.037) EXPECT_EQ(a.curve.volts({gap_mm}), b.curve.volts({gap_mm}));
  }
  EXPECT_EQ(one.trunk_model_text, other.trunk_model_text);
  ASSERT_EQ(one.model.transient_sensors.has_value(), other.model.transient_sensors.has_value());
  if (one.model.transient_sensors) {
    EXPECT_EQ(one.model.transient_sensors->rear, other.model.transient_sensors->rear);
    EXPECT_EQ(one.model.transient_sensors->front, other.model.transient_sensors->front);
  }
  ASSERT_EQ(one.cop_calibration.has_value(), other.cop_calibration.has_value());
  if (!one.cop_calibration) return;
  EXPECT_EQ(one.cop_calibration->id, other.cop_calibration->id);
  EXPECT_EQ(one.cop_calibration->points.size(), other.cop_calibration->points.size());
}

void expect_self_contained(const std::filesystem::path& file) {
  SCOPED_TRACE(file);
  Problems problems;
  const pipeline::RigConfig from_files = read_rig_file(file.string(), problems);
  const auto definition = rig_definition(file.string());
  ASSERT_TRUE(definition) << core::to_string(definition.error());

  const pipeline::RigConfig from_text = read_rig_text(*definition, "definition", problems);

  ASSERT_THAT(texts_of(problems), IsEmpty());
  expect_equal(from_files, from_text);
  Fed one(from_files);
  Fed other(from_text);
  EXPECT_EQ(one.stages(), other.stages());
  EXPECT_EQ(one.run(), other.run());
}

class Definition : public testing::Test {
 protected:
  Definition() {
    std::string name = (std::filesystem::temp_directory_path() / "dts-definition-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    std::filesystem::copy(kConfig / "sensors", folder_ / "sensors");
    std::filesystem::create_directory(folder_ / "rigs");
  }
  ~Definition() override { std::filesystem::remove_all(folder_); }

  /// The repository's floor rig with `head` above it.
  std::filesystem::path rig_with(const std::string& head, const std::string& tail = "") const {
    std::ifstream in(kConfig / "rigs/floor-sim.toml");
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    std::ofstream(folder_ / "rigs/floor.toml") << head << text << tail;
    return folder_ / "rigs/floor.toml";
  }
  void calibrate(std::size_t extra_points = 0) const {
    Problems none;
    const auto rig = read_rig_file((kConfig / "rigs/floor-sim.toml").string(), none);
    const auto samples = physics::model_samples(physics::CopMethod::Poly3, rig.model, physics::PlateBehaviour::Linear).value();
    auto calibration =
        physics::calibrate_cop(physics::CopMethod::Poly3, samples, {.created_utc = "2026-01-31T12:00:00Z", .rig = "floor"}).value();
    while (calibration.points.size() < extra_points) calibration.points.push_back(calibration.points.front());
    ASSERT_TRUE(write_cop_calibration((folder_ / "calibration.toml").string(), calibration));
  }

  std::filesystem::path folder_;
};

TEST_F(Definition, EveryRigOfTheRepository_ReadsBackToTheSameRigAndTheSameValues) {
  std::size_t rigs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kConfig / "rigs")) {
    if (entry.path().extension() != ".toml") continue;
    expect_self_contained(entry.path());
    ++rigs;
  }
  EXPECT_GE(rigs, 3U);
}

TEST_F(Definition, RigWithCalibrationAndRecordTable_ReadsBackWithoutItsFiles) {
  calibrate();
  const auto file = rig_with("calibration = \"../calibration.toml\"\n", "\n[record]\nstreams = [\"raw\", \"cop\"]\n");

  expect_self_contained(file);

  const std::string definition = rig_definition(file.string()).value();
  EXPECT_THAT(definition, testing::Not(HasSubstr(".toml")));
  std::filesystem::remove_all(folder_ / "sensors");
  Problems problems;
  const auto read = read_rig_text(definition, "definition", problems);
  EXPECT_THAT(texts_of(problems), IsEmpty());
  EXPECT_TRUE(read.cop_calibration.has_value());
  EXPECT_THAT(read.recorded, ElementsAre("raw", "cop"));
}

TEST_F(Definition, LargeCalibration_LeavesOutItsPointsOnly) {
  calibrate(9'000);
  const auto file = rig_with("calibration = \"../calibration.toml\"\n");

  const auto definition = rig_definition(file.string());

  ASSERT_TRUE(definition) << core::to_string(definition.error());
  EXPECT_LE(definition->size(), std::size_t{1} << 20U);
  Problems problems;
  const auto from_text = read_rig_text(*definition, "definition", problems);
  ASSERT_THAT(texts_of(problems), IsEmpty());
  EXPECT_THAT(from_text.cop_calibration->points, IsEmpty());
  EXPECT_EQ(Fed(from_text).run(), Fed(read_rig_file(file.string(), problems)).run());
}

TEST_F(Definition, TextThatNamesFiles_IsRefusedWithoutReadingThem) {
  Problems problems;
  std::ifstream in(kConfig / "rigs/floor-sim.toml");
  const std::string text{std::istreambuf_iterator<char>(in), {}};

  (void)read_rig_text("calibration = \"/etc/passwd\"\n" + text, "definition", problems);

  EXPECT_THAT(texts_of(problems), Contains(HasSubstr("calibration names a file")));
  EXPECT_THAT(texts_of(problems), Contains(HasSubstr("curve names a file")));
  for (const std::string& problem : texts_of(problems)) EXPECT_THAT(problem, testing::StartsWith("definition:"));
}

TEST_F(Definition, RigFileInDisorder_FailsWithItsFirstProblem) {
  const auto file = rig_with("no_such_key = 1\n");

  const auto definition = rig_definition(file.string());

  ASSERT_FALSE(definition);
  EXPECT_EQ(definition.error().code, core::ErrorCode::InvalidArgument);
  EXPECT_THAT(definition.error().what, HasSubstr("unknown key 'no_such_key'"));
  EXPECT_FALSE(rig_definition((folder_ / "none.toml").string()));
}

TEST_F(Definition, EmptyListOfRecordedStreams_IsAProblem) {
  Problems problems;

  (void)read_rig_file(rig_with("", "\n[record]\nstreams = []\n").string(), problems);

  EXPECT_THAT(texts_of(problems), ElementsAre(HasSubstr("[record] streams is empty")));
}

}  // namespace
}  // namespace dts::files
