// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "files/cop_calibration_file.h"
#include "files/rig_file.h"
#include "physics/cop/cop_calibration.h"

namespace dts::files {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// The repository's floor rig with a calibration beside it.
class RigWithCalibration : public testing::Test {
 protected:
  RigWithCalibration() {
    std::string name = (std::filesystem::temp_directory_path() / "dts-calibration-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    std::filesystem::create_directory(folder_ / "rigs");
    const std::filesystem::path config = std::filesystem::path(DTS_SOURCE_DIR) / "config";
    std::filesystem::copy(config / "sensors", folder_ / "sensors");
    std::ifstream in(config / "rigs" / "floor-sim.toml");
    rig_text_.assign(std::istreambuf_iterator<char>(in), {});
    rig_text_ = without(rig_text_, "estimator = ");
  }
  ~RigWithCalibration() override { std::filesystem::remove_all(folder_); }

  static std::string without(std::string text, const std::string& line) {
    const std::size_t begin = text.find(line);
    if (begin != std::string::npos) text.erase(begin, text.find('\n', begin) + 1 - begin);
    return text;
  }

  /// The rig file with `head` above everything else and `tail` right after its cop stage's id.
  pipeline::RigConfig read(const std::string& head, const std::string& tail = "") {
    std::string text = head + rig_text_;
    const std::string id = "id = \"cop\"\n";
    const std::size_t at = text.find(id);
    if (at != std::string::npos) text.insert(at + id.size(), tail);
    const auto file = folder_ / "rigs" / "floor.toml";
    std::ofstream(file) << text;
    return read_rig_file(file.string(), problems_);
  }
  [[nodiscard]] std::vector<std::string> problems() const {
    std::vector<std::string> lines;
    for (const Problem& problem : problems_) lines.push_back(to_string(problem).substr(folder_.string().size() + 1));
    return lines;
  }
  /// Writes a calibration of this rig to calibration.toml beside the rigs.
  std::string calibrate(physics::CopMethod method) {
    Problems none;
    const auto rig = read_rig_file((std::filesystem::path(DTS_SOURCE_DIR) / "config/rigs/floor-sim.toml").string(), none);
    const auto samples = physics::model_samples(method, rig.model, physics::PlateBehaviour::Linear).value();
    const auto calibration = physics::calibrate_cop(method, samples, {.created_utc = "2026-01-31T12:00:00Z", .rig = "floor"}).value();
    EXPECT_TRUE(write_cop_calibration((folder_ / "calibration.toml").string(), calibration));
    return calibration.id;
  }

  std::filesystem::path folder_;
  std::string rig_text_;
  Problems problems_;
};

constexpr const char* kCalibration = "calibration = \"../calibration.toml\"\n";

/// What the cop stage is told about its estimator.
std::string estimator_of(const pipeline::RigConfig& config) {
  for (const auto& stage : config.stages) {
    if (stage.id == "cop" && stage.options.contains("estimator")) return std::get<std::string>(stage.options.at("estimator"));
  }
  return {};
}

TEST_F(RigWithCalibration, Named_IsReadAndGivesTheEstimator) {
  const std::string id = calibrate(physics::CopMethod::Thesis);

  const auto config = read(kCalibration);

  EXPECT_THAT(problems(), IsEmpty());
  ASSERT_TRUE(config.cop_calibration);
  EXPECT_EQ(config.cop_calibration->id, id);
  EXPECT_EQ(estimator_of(config), "thesis");
}

TEST_F(RigWithCalibration, NotNamed_LeavesThePlateModel) {
  const auto config = read("");

  EXPECT_THAT(problems(), IsEmpty());
  EXPECT_FALSE(config.cop_calibration);
  EXPECT_EQ(estimator_of(config), "");
}

TEST_F(RigWithCalibration, SameEstimator_MayBeSaid) {
  calibrate(physics::CopMethod::Thesis);

  EXPECT_EQ(estimator_of(read(kCalibration, "estimator = \"thesis\"\n")), "thesis");
  EXPECT_THAT(problems(), IsEmpty());
}

TEST_F(RigWithCalibration, OtherEstimator_IsRefusedAtItsPlace) {
  const std::string id = calibrate(physics::CopMethod::Thesis);

  static_cast<void>(read(kCalibration, "estimator = \"poly3\"\n"));

  ASSERT_EQ(problems_.size(), 1U);
  EXPECT_THAT(problems()[0], HasSubstr("the rig's calibration '" + id + "' is for estimator \"thesis\""));
  EXPECT_GT(problems_[0].line, 40U);
  EXPECT_EQ(problems_[0].column, std::string("estimator = \"").size());
}

TEST_F(RigWithCalibration, FileThatIsNotThere_IsAProblemWhereItIsNamed) {
  static_cast<void>(read(kCalibration));

  ASSERT_EQ(problems_.size(), 1U);
  EXPECT_THAT(problems()[0], testing::StartsWith("rigs/floor.toml:1:15: "));
  EXPECT_THAT(problems()[0], testing::HasSubstr("calibration.toml cannot be read: No such file"));
}

TEST_F(RigWithCalibration, BadFile_IsReportedWithItsOwnPlace) {
  calibrate(physics::CopMethod::Poly3);
  std::ofstream(folder_ / "calibration.toml", std::ios::app) << "[surprise]\n";

  static_cast<void>(read(kCalibration));

  ASSERT_EQ(problems_.size(), 1U);
  EXPECT_THAT(problems()[0], testing::MatchesRegex("calibration\\.toml:[0-9]+:2: unknown key 'surprise'"));
}

TEST_F(RigWithCalibration, AnotherNumberOfSensors_IsRefused) {
  calibrate(physics::CopMethod::Poly3);
  const std::size_t begin = rig_text_.find("[[sensor]]\nlabel = \"w4\"");
  rig_text_.erase(begin, rig_text_.find("[[stage]]") - begin);

  static_cast<void>(read(kCalibration));

  ASSERT_EQ(problems_.size(), 1U);
  EXPECT_THAT(problems()[0], testing::StartsWith("rigs/floor.toml:1:15: calibration 'cop-"));
  EXPECT_THAT(problems()[0], HasSubstr("is for 4 sensors, the rig has 3"));
}

TEST_F(RigWithCalibration, NoCopStage_IsRefused) {
  calibrate(physics::CopMethod::Poly3);
  rig_text_ = without(rig_text_, "[[stage]]\nid = \"cop\"\n");
  rig_text_ = without(rig_text_, "id = \"cop\"");

  static_cast<void>(read(kCalibration));

  EXPECT_THAT(problems(), ElementsAre(HasSubstr("the rig has no [[stage]] \"cop\" that could use its calibration")));
}

}  // namespace
}  // namespace dts::files
