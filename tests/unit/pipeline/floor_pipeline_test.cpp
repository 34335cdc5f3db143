// SPDX-License-Identifier: Apache-2.0
// The assembled floor pipeline on a simulated plate: point load -> influence table -> sensor curve -> volts -> COP.
// All data here are synthetic.
#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <random>

#include "pipeline/pipeline.h"
#include "support/allocation_counter.h"
#include "unit/pipeline/floor_rig.h"

namespace dts::pipeline {
namespace {

constexpr double kRateHz = 100.0;
constexpr std::size_t kBlockScans = 8;
constexpr std::size_t kTareScans = 104;  // 1 s and what the window needs, whole blocks

class FloorPipelineTest : public testing::Test {
 protected:
  void create(const std::string& estimator) {
    // A simulated plate without noise stands perfectly still: its channels would count as stuck.
    const std::vector<StageConfig> stages{
        {"guard", {{"stuck_ms", 0.0}}}, {"window_filter", {}}, {"linearise", {}}, {"cop", {{"estimator", estimator}}}};
    const PipelineInput input{.rate = core::Rate::from_hz(kRateHz).value(),
                              .sensor_channels = {0, 1, 2, 3},
                              .aux_channels = {},
                              .aux_formats = {},
                              .max_block_scans = kBlockScans};
    pipeline_ = Pipeline::create(stages, input, surroundings_.context()).value();
    frame_ = pipeline_->make_frame();
  }

  /// `scans` scans (whole blocks) of a load at rest; `noise_v` is asked for each value.
  void stand(
      physics::Point position, double load_n, std::size_t scans, const std::function<double()>& noise_v = [] { return 0.0; }) {
    show(plate_.deflection_mm(position, load_n), scans, noise_v);
  }
  /// The same for a plate bent already: takes no memory.
  void show(const std::vector<double>& deflection_mm, std::size_t scans, const std::function<double()>& noise_v) {
    for (std::size_t done = 0; done < scans; done += kBlockScans) {
      acquired_.block.set_count(kBlockScans);
      acquired_.block.first_scan = core::ScanIndex{scan_};
      for (std::size_t c = 0; c < 4; ++c) {
        const physics::SensorModel& sensor = surroundings_.rig.sensors[c];
        const double volts = sensor.curve.volts(sensor.unloaded_gap - core::Millimetres{mounting_error_mm_[c] + deflection_mm[c]}).value;
        for (double& value : acquired_.block.column(c)) value = volts + noise_v();
      }
      pipeline_->process(acquired_, frame_);
      scan_ += kBlockScans;
    }
  }
  [[nodiscard]] const core::Block& cop() const { return frame_.streams[3]; }

  struct Errors {
    double x_mm = 0.0;  ///< Root mean squares.
    double y_mm = 0.0;
    double load = 0.0;  ///< Relative.
  };
  /// Over the fifteen positions of thesis Table 4.1. Each result must also be the estimator's own for these deflections: what
  /// the pipeline adds is the way to volts and back, 1e-4 mm at most per sensor.
  Errors errors_at_thesis_points(physics::CopMethod method) {
    constexpr double kLoadN = 490.0;  // thesis 4.5
    constexpr double kPitchMm = 32.25;
    const auto estimator = physics::CopEstimator::from_model(method, surroundings_.rig).value();
    Errors squares;
    for (int row = 0; row <= 4; ++row) {
      for (int column = 0; column <= row; ++column) {
        const physics::Point position{{86.0 + kPitchMm * column}, {86.0 + kPitchMm * row}};
        stand(position, kLoadN, kBlockScans);
        const physics::CopEstimate expected = estimator.estimate(plate_.deflection_mm(position, kLoadN));
        EXPECT_NEAR(last(0), expected.x_mm - 215.0, 0.02);
        EXPECT_NEAR(last(1), expected.y_mm - 215.0, 0.02);
        EXPECT_NEAR(last(2), expected.load_n, 0.1);
        EXPECT_EQ(last_bits(), 0);
        squares.x_mm += std::pow(last(0) - (position.x.value - 215.0), 2) / 15.0;
        squares.y_mm += std::pow(last(1) - (position.y.value - 215.0), 2) / 15.0;
        squares.load += std::pow(last(2) / kLoadN - 1.0, 2) / 15.0;
      }
    }
    return {std::sqrt(squares.x_mm), std::sqrt(squares.y_mm), std::sqrt(squares.load)};
  }
  /// Newest value of a channel of "cop", and the bits of all three.
  [[nodiscard]] double last(std::size_t channel) const { return cop().column(channel).back(); }
  [[nodiscard]] int last_bits() const { return cop().quality(0).back() | cop().quality(1).back() | cop().quality(2).back(); }

  StageSurroundings surroundings_;
  FloorPlate plate_{surroundings_.rig};
  std::unique_ptr<Pipeline> pipeline_;
  core::Frame frame_;
  core::Acquired acquired_{.block = core::Block(4, kBlockScans), .gap_before = {}, .lost_scans_total = 0};
  std::uint64_t scan_ = 0;
  std::array<double, 4> mounting_error_mm_{};  ///< By how much a sensor's real unloaded gap is too small.
};

TEST_F(FloorPipelineTest, Poly3AtThePointsOfTable41_ErrsByAFifthOfAMillimetre) {
  RecordProperty("requirement", "COP-4");
  create("poly3");
  stand({}, 0.0, kTareScans);

  const Errors errors = errors_at_thesis_points(physics::CopMethod::Poly3);

  EXPECT_EQ(surroundings_.tare.latest().outcome, TareOutcome::Done);
  EXPECT_LT(std::hypot(errors.x_mm, errors.y_mm), 0.2);  // plate-model 5.2: 0.18 mm rms over the square
  EXPECT_LT(errors.load, 0.005);
}

TEST_F(FloorPipelineTest, ThesisAtThePointsOfTable41_ErrsLikeTheRealSystemOfTheThesis) {
  create("thesis");
  stand({}, 0.0, kTareScans);

  const Errors errors = errors_at_thesis_points(physics::CopMethod::Thesis);

  // Thesis Table 4.1, real system: 1.66, 2.51 and 3.0 mm; the plate stiffens here as it did there. The figures of the thesis's linear
  // simulation are held against the linear plate in the estimator's own tests.
  EXPECT_LE(errors.x_mm, 1.66);
  EXPECT_NEAR(std::hypot(errors.x_mm, errors.y_mm), 3.0, 0.3);
}

TEST_F(FloorPipelineTest, SensorsAwayFromTheirNominalGap_AreCuredByTheTare) {
  create("poly3");
  mounting_error_mm_ = {0.2, -0.1, 0.0, 0.3};
  stand({}, 0.0, kTareScans);

  stand({{235.0}, {205.0}}, 490.0, kBlockScans);

  EXPECT_EQ(surroundings_.tare.latest().outcome, TareOutcome::Done);
  EXPECT_NEAR(last(0), 20.0, 0.3);
  EXPECT_NEAR(last(1), -10.0, 0.3);
  EXPECT_EQ(last_bits(), 0);
}

TEST_F(FloorPipelineTest, EmptyPlateWithSensorNoise_NeverMakesContact) {
  RecordProperty("requirement", "COP-2");
  create("poly3");
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise_v(0.0, 0.003);  // plate-model section 5
  stand({}, 0.0, kTareScans, [&] { return noise_v(random); });

  double largest_load_n = 0.0;
  for (int block = 0; block < 1000; ++block) {
    stand({}, 0.0, kBlockScans, [&] { return noise_v(random); });
    for (std::size_t i = 0; i < cop().count(); ++i) {
      ASSERT_NE(cop().quality(0)[i] & core::quality::kNoContact, 0);
      largest_load_n = std::max(largest_load_n, cop().column(2)[i]);
    }
  }

  EXPECT_LT(largest_load_n, 25.0);  // half the default threshold
}

TEST_F(FloorPipelineTest, Streaming_DoesNotTouchTheHeap) {
  create("poly3");
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise_v(0.0, 0.003);
  const std::function<double()> noise = [&] { return noise_v(random); };

  const auto empty_mm = plate_.deflection_mm({}, 0.0);
  const auto person_mm = plate_.deflection_mm({{200.0}, {240.0}}, 650.0);

  const std::uint64_t before = test::heap_calls_of_this_thread();
  for (int round = 0; round < 10; ++round) {
    acquired_.gap_before.reason = round == 5 ? core::GapReason::Overrun : core::GapReason::None;
    surroundings_.tare.request();
    show(empty_mm, kTareScans, noise);
    show(person_mm, kTareScans, noise);
  }
  const std::uint64_t after = test::heap_calls_of_this_thread();
  surroundings_.rig.sensors.push_back(surroundings_.rig.sensors[0]);  // proves that the counter counts

  EXPECT_EQ(after - before, 0U);
  EXPECT_GT(test::heap_calls_of_this_thread(), after);
}

}  // namespace
}  // namespace dts::pipeline
