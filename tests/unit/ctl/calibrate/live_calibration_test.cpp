// SPDX-License-Identifier: Apache-2.0
// Whole calibrations: the daemon that the test plays answers each line of the command with the scans that a person would cause.
#include <cstdlib>
#include <optional>
#include <regex>

#include "physics/plate/influence_table.h"
#include "support/committed_text.h"
#include "unit/ctl/run_fixture.h"
#include "unit/physics/floor_platform.h"

namespace dts::ctl {
namespace {

/// Hands each text that a command flushes to `take`, in the command's thread, and keeps all.
class Lines final : public std::stringbuf {
 public:
  explicit Lines(std::function<void(const std::string&)> take) : take_(std::move(take)) {}

 private:
  int sync() override {
    const std::string text = str().substr(taken_);
    taken_ += text.size();
    take_(text);
    return 0;
  }
  std::function<void(const std::string&)> take_;
  std::size_t taken_ = 0;
};

class LiveCalibrationTest : public RunTest {
 protected:
  LiveCalibrationTest() {
    static_cast<std::ostream&>(talk_).rdbuf(&lines_);
    ::setenv("XDG_STATE_HOME", directory_.path().c_str(), 1);
    v1::RigInfo& rig = *status_.mutable_rigs(0)->mutable_rig();
    for (std::size_t k = 0; k < places_.size(); ++k) {
      const std::string number = std::to_string(k + 1);
      v1::SensorInfo& sensor = *rig.add_sensors();
      sensor.set_label("w" + number);
      sensor.set_channel("ai" + number);
      sensor.set_x_mm(places_[k].x.value);
      sensor.set_y_mm(places_[k].y.value);
      sensor.set_range_low_v(-10.0);
      sensor.set_range_high_v(5.0);
      sensor.set_unloaded_gap_mm(k == 1 ? 11.91 : 11.89);
    }
    rig.add_streams()->set_name("deflection");
    for (int index : {1, 2}) {
      v1::StreamFormat& stream = *rig.mutable_streams(index);
      *stream.mutable_rate() = rig.streams(0).rate();
      stream.clear_channels();
      for (const v1::SensorInfo& sensor : rig.sensors()) stream.add_channels()->set_name(sensor.label() + (index == 1 ? "_v" : "_mm"));
    }
    rig.add_published("deflection");
  }
  /// All that people read in the case.
  void TearDown() override {
    dts::test::expect_committed("unit/ctl/calibrate/said/" + dts::test::case_file(),
                                dts::test::replaced(said(), directory_.path().string(), "@"));
  }
  std::vector<std::string> answer(const v1::Request& request) const {
    return {testing::reply(request, [&](v1::Response& response) {
      if (request.has_status()) *response.mutable_status() = status_;
      if (request.has_tare()) response.mutable_tare()->add_baseline(0.0);
      if (!request.has_get_devices()) return;
      for (const char* rig : {"chair", "floor", "attic"}) {
        v1::DeviceInfo& device = *response.mutable_devices()->add_devices();
        device.set_rig(rig);
        device.set_model(std::string("DAQ of ") + rig);
        device.set_serial("S-" + device.rig());
      }
    })};
  }
  void act(const std::string& line) {
    static const std::regex point(R"(Point (\d+) of \d+: place (\d+) N at x ([\d.]+), y ([\d.]+)[^]*)");
    static const std::regex gap(R"(Gap (\d+) of \d+: ([\d.]+) mm\n)");
    std::smatch found;
    if (line.starts_with("Clear the plate") || line.starts_with("Clear the space")) {
      const std::string topic = line.starts_with("Clear the plate") ? "floor/deflection" : "floor/raw";
      EXPECT_TRUE(daemon_->wait_for_subscription(topic));
      daemon_->send("dtsd/status", status_);
      if (topic == "floor/raw") send("raw", {0.6, 0.6, 0.6, 0.6});
    } else if (std::regex_match(line, found, point)) {
      put(std::stoi(found[1]), std::stod(found[2]), physics::test::at(std::stod(found[3]), std::stod(found[4])));
    } else if (std::regex_match(line, found, gap)) {
      const double z_mm = 12.0 - std::stod(found[2]);  // plate-model section 5
      const double volts = 0.9 + 0.35 * z_mm + 0.058 * z_mm * z_mm;
      doubt("raw", std::stoi(found[1]), {volts, volts + 0.1, volts + 0.2, volts + 0.3});
      send("raw", {volts, volts + 0.1, volts + 0.2, volts + 0.3});
    }
  }
  /// The weight is put down after the plate was empty.
  void put(int number, double load_n, physics::Point place) {
    send("deflection", {0.0, 0.0, 0.0, 0.0}, 5);
    if (number == interrupted_at_) return daemon_->send("dtsd/status", testing::floor_status(8));
    std::array<double, 4> bent{};
    for (std::size_t k = 0; k < bent.size(); ++k) bent[k] = load_n * plate_.at_point_mm_per_n(k, place);
    doubt("deflection", number, bent);
    send("deflection", bent);
  }
  /// Three holds that end with the doubt of this number.
  void doubt(const std::string& stream, int number, const std::array<double, 4>& values) {
    if (static_cast<std::size_t>(number) > doubts_.size()) return;
    for (int hold = 0; hold < 3; ++hold) {
      send(stream, values, 5);
      send(stream, values, 1, doubts_[static_cast<std::size_t>(number) - 1]);
    }
  }
  void send(const std::string& stream, const std::array<double, 4>& values, std::uint32_t scans = 20, int quality_of_second = 0) {
    v1::StreamBlock block = testing::block(1, first_scan_, scans, ++sequence_, 4);
    first_scan_ += scans;
    for (int i = 0; i < block.values_size(); ++i) block.set_values(i, static_cast<float>(values[static_cast<std::size_t>(i) / scans]));
    (*block.mutable_quality())[1] = static_cast<char>(quality_of_second);
    daemon_->send("floor/" + stream, block);
  }
  int calibrate(std::vector<std::string> words) {
    const std::vector<std::string> common{"--rig", "floor", "--auto", "--hold", "0.08", "--json"};
    daemon_.emplace(data_);
    words.insert(words.begin(), "calibrate");
    words.insert(words.end(), common.begin(), common.end());
    return run_with(words);
  }
  [[nodiscard]] std::string path(const std::string& name) const { return directory_.path() / name; }
  [[nodiscard]] std::string said() const { return lines_.str(); }

  std::vector<physics::Point> places_ = physics::test::floor_sensors();
  physics::InfluenceTable plate_ =
      physics::InfluenceTable::create(physics::test::steel_plate(), physics::test::corners(10.75), places_, 20).value();
  v1::StatusSnapshot status_ = testing::floor_status();
  std::vector<int> doubts_;  ///< Of w2, one at each of the first points.
  int interrupted_at_ = 0;   ///< The daemon restarts at this point.
  std::uint64_t first_scan_ = 0;
  std::uint64_t sequence_ = 0;
  std::optional<testing::FakePublisher> daemon_;  ///< A new one for each command: it knows no subscription of the command before.
  Lines lines_{[this](const std::string& line) { act(line); }};
  testing::FakeController control_daemon_{control_, [this](const v1::Request& request, int) { return answer(request); }};
};

TEST_F(LiveCalibrationTest, Cop_DoubtsAreExplainedAndTheFileKnowsItsHardware) {
  doubts_ = {v1::QUALITY_OUT_OF_RANGE, v1::QUALITY_RAIL, v1::QUALITY_STUCK, v1::QUALITY_ROTATION, v1::QUALITY_UNTARED};

  EXPECT_EQ(calibrate({"cop", "--estimator", "thesis", "--verify", "3", "--out", path("cop.toml")}), cli::kOk) << said();

  EXPECT_EQ(json().at("daq_model"), "DAQ of floor");
  EXPECT_EQ(json().at("daq_serial"), "S-floor");
  EXPECT_EQ(json().at("points").size(), 10U);
  EXPECT_EQ(json().at("verification").at("points").size(), 3U);
  EXPECT_LT(json().at("verification").at("points").at(2).at("x_error_mm").get<double>(), 0.5);
  EXPECT_TRUE(std::filesystem::exists(path("cop.toml")));
  EXPECT_FALSE(std::filesystem::exists(path("dts/calibrate-cop-floor.jsonl")));
}

TEST_F(LiveCalibrationTest, CopResumed_GoesOnAsItWasAsked) {
  interrupted_at_ = 4;
  EXPECT_EQ(calibrate({"cop", "--grid", "4", "--loads", "300,599", "--verify", "2", "--out", path("cop.toml")}), 6);
  EXPECT_EQ(calibrate({"cop", "--out", path("cop.toml")}), 6);

  interrupted_at_ = 0;
  EXPECT_EQ(calibrate({"cop", "--resume", "--out", path("cop.toml")}), cli::kOk) << said();

  EXPECT_EQ(json().at("points").size(), 32U);
  EXPECT_EQ(json().at("verification").at("points").size(), 2U);
}

TEST_F(LiveCalibrationTest, Sensors_EachHasItsOwnCurveAndFile) {
  doubts_ = {v1::QUALITY_RAIL, v1::QUALITY_STUCK, v1::QUALITY_ROTATION};

  EXPECT_EQ(calibrate({"sensor", "--sensor", "all", "--gaps", "12,11,10,9,8,7", "--out", directory_.path()}), cli::kOk) << said();

  const auto report = json();
  ASSERT_EQ(report.at("sensors").size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) {
    const auto& sensor = report.at("sensors").at(k);
    const std::string number = std::to_string(k + 1);
    EXPECT_EQ(sensor.at("sensor"), "w" + number);
    EXPECT_EQ(sensor.at("channel"), "ai" + number);
    EXPECT_EQ(sensor.at("daq_model"), "DAQ of floor");
    EXPECT_EQ(sensor.at("range_v"), 10.0);
    EXPECT_EQ(sensor.at("samples_per_point"), 8);
    EXPECT_EQ(sensor.at("points").at(0).at("gap_mm"), 7.0);
    EXPECT_NEAR(sensor.at("points").at(5).at("volts").get<double>(), 0.9 + 0.1 * static_cast<double>(k), 1e-6);
    EXPECT_THAT(sensor.at("file").get<std::string>(),
                ::testing::ContainsRegex("/floor-w" + number + "-[0-9]{4}-[0-9]{2}-[0-9]{2}[.]toml$"));
    EXPECT_TRUE(std::filesystem::exists(sensor.at("file").get<std::string>()));
  }
}

TEST_F(LiveCalibrationTest, WhatCannotBeCalibrated_IsRefusedBeforeAnythingIsMeasured) {
  EXPECT_EQ(calibrate({"sensor", "--sensor", "w9", "--gaps", "12,11,10,9,8,7"}), 5);
  EXPECT_THAT(said(), HasSubstr("rig 'floor' has no sensor 'w9'\n  try: the sensors are: w1, w2, w3, w4; or give all\n"));
  EXPECT_EQ(calibrate({"cop", "--loads", "300,300"}), cli::kUsage);
  EXPECT_EQ(calibrate({"cop", "--estimator", "thesis", "--loads", "300,400"}), cli::kUsage);
  status_.mutable_rigs(0)->mutable_session()->set_session_id("s1");
  status_.mutable_rigs(0)->mutable_session()->set_state(v1::SESSION_STATE_RUNNING);
  EXPECT_EQ(calibrate({"cop"}), 6);
  EXPECT_EQ(calibrate({"sensor", "--sensor", "all", "--gaps", "12,11,10,9,8,7"}), 6);
}

}  // namespace
}  // namespace dts::ctl
