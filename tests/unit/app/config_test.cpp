// SPDX-License-Identifier: Apache-2.0
#include "app/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "files/rig_file.h"

namespace dts::app {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kSensorFile = "name = \"test\"\n[[point]]\ngap_mm = 7.0\nvolts = 4.0\n[[point]]\ngap_mm = 12.0\nvolts = 0.9\n";
constexpr const char* kPlate = "[plate]\na_mm = 430.0\nb_mm = 430.0\nh_mm = 3.0\ne_pa = 198.7e9\nnu = 0.27\n[support]\nkind = \"corner\"\n";
constexpr const char* kSensor = "[[sensor]]\nlabel = \"w1\"\nx_mm = 86.0\ny_mm = 86.0\ncurve = \"sensor.toml\"\n";
constexpr const char* kStage = "[[stage]]\nid = \"guard\"\n";

/// A folder of configuration files that a test writes.
class ConfigFiles : public ::testing::Test {
 protected:
  ConfigFiles() {
    std::string name = (std::filesystem::temp_directory_path() / "dts-config-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    write("sensor.toml", kSensorFile);
    write("rig.toml", std::string("kind = \"floor\"\n") + kPlate + kSensor + kStage);
  }
  ~ConfigFiles() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  /// Every problem of a daemon file with this text, without the folder.
  std::vector<std::string> problems_of(const std::string& text) {
    std::vector<std::string> lines;
    for (const files::Problem& problem : load_config(write("dtsd.toml", text)).problems) {
      lines.push_back(to_string(problem).substr(folder_.string().size() + 1));
    }
    return lines;
  }
  std::vector<std::string> problems_of_rig(const std::string& text) {
    files::Problems problems;
    static_cast<void>(read_rig_file(write("rig.toml", text), problems));
    std::vector<std::string> lines;
    for (const files::Problem& problem : problems) lines.push_back(to_string(problem).substr(folder_.string().size() + 1));
    return lines;
  }
  static constexpr const char* kRig = "[[rig]]\nname = \"floor\"\nfile = \"rig.toml\"\ndevice = \"sim:floor\"\n";
  std::filesystem::path folder_;
};

TEST_F(ConfigFiles, StorageNamedRelativeToAFileNamedRelatively_IsAbsolute) {
  write("dtsd.toml", std::string(kRig) + "[storage]\ndirectory = \"state\"\n");
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder_);
  const LoadedConfig loaded = load_config("dtsd.toml");
  std::filesystem::current_path(before);

  EXPECT_EQ(loaded.config.storage.directory, (std::filesystem::canonical(folder_) / "state").string());
}

TEST_F(ConfigFiles, Complete_HasNoProblemAndTheDefaults) {
  const LoadedConfig loaded = load_config(write("dtsd.toml", kRig));

  ASSERT_THAT(loaded.problems, IsEmpty());
  ASSERT_EQ(loaded.config.rigs.size(), 1U);
  const pipeline::RigConfig& rig = loaded.config.rigs[0].rig;
  EXPECT_EQ(rig.device_uri, "sim:floor");
  EXPECT_EQ(rig.rate, core::Rate::create(100, 1).value());
  EXPECT_EQ(rig.block_scans, 1U);
  EXPECT_EQ(rig.sensor_channels, std::vector<std::size_t>{0});
  EXPECT_EQ(rig.model.sensors[0].curve.name(), "test");
  EXPECT_EQ(loaded.config.realtime.policy(1).fifo_priority, 49);
}

TEST_F(ConfigFiles, ProgramsAsDevices_AreOffUntilAllowed) {
  RecordProperty("requirement", "ACQ-15");
  EXPECT_FALSE(load_config(write("dtsd.toml", kRig)).config.allows_programs);
  EXPECT_FALSE(load_config(write("dtsd.toml", std::string("[devices]\n") + kRig)).config.allows_programs);
  EXPECT_TRUE(load_config(write("dtsd.toml", std::string("[devices]\nallow_exec = true\n") + kRig)).config.allows_programs);
  EXPECT_THAT(problems_of(std::string("[devices]\nallow_exec = 1\n") + kRig), Contains(HasSubstr("dtsd.toml:2:")));
  EXPECT_THAT(problems_of(std::string("[devices]\nallow_exe = true\n") + kRig), Contains(HasSubstr("did you mean 'allow_exec'?")));
}

TEST_F(ConfigFiles, LabelRule_HasADefaultAndIsChecked) {
  const auto rule_of = [this](const std::string& privacy) {
    auto loaded = load_config(write("dtsd.toml", privacy + kRig));
    EXPECT_THAT(loaded.problems, IsEmpty());
    return loaded.config.label_rule;
  };
  const session::LabelRule plain = rule_of("");
  ASSERT_TRUE(plain.pattern);
  EXPECT_TRUE(plain.pattern->matches("eyes closed"));
  EXPECT_FALSE(plain.pattern->matches("Anna Schmidt, born 1950"));
  EXPECT_THAT(plain.hint, HasSubstr("do not enter names or birth dates"));
  const session::LabelRule own = rule_of("[privacy]\nlabel_pattern = \"(pre|post)-[0-9]{1,2}\"\nlabel_hint = \"pre-1 or post-1\"\n");
  EXPECT_TRUE(own.pattern->matches("post-12"));
  EXPECT_FALSE(own.pattern->matches("eyes closed"));
  EXPECT_EQ(own.hint, "pre-1 or post-1");
  EXPECT_NE(rule_of("[privacy]\nlabel_pattern = \"[a-z]+\"\n").hint, plain.hint);
  EXPECT_THAT(problems_of(std::string("[privacy]\nlabel_pattern = \"[a\"\n") + kRig),
              Contains(HasSubstr("dtsd.toml:2:17: the pattern has a mistake at character 3: ']' is missing")));
}

TEST_F(ConfigFiles, SubjectRule_IsOffByDefaultAndIsChecked) {
  RecordProperty("requirement", "SES-12");
  const auto rule_of = [this](const std::string& privacy) {
    auto loaded = load_config(write("dtsd.toml", privacy + kRig));
    EXPECT_THAT(loaded.problems, IsEmpty());
    return loaded.config.label_rule;
  };
  EXPECT_FALSE(rule_of("").subject_pattern) << "each ID of letters, digits, '_', '.' and '-' is allowed";
  const session::LabelRule own = rule_of("[privacy]\nsubject_pattern = \"P[0-9]{3}\"\nsubject_hint = \"such as P017\"\n");
  EXPECT_TRUE(own.subject_pattern->matches("P017"));
  EXPECT_FALSE(own.subject_pattern->matches("Schmidt"));
  EXPECT_EQ(own.subject_hint, "such as P017");
  EXPECT_THAT(rule_of("[privacy]\nsubject_pattern = \"P[0-9]{3}\"\n").subject_hint, HasSubstr("subject_pattern in dtsd.toml"));
  EXPECT_THAT(problems_of(std::string("[privacy]\nsubject_pattern = \"P[0\"\n") + kRig),
              Contains(HasSubstr("dtsd.toml:2:19: the pattern has a mistake")));
  EXPECT_THAT(problems_of(std::string("[privacy]\nsubject_hint = \"such as P017\"\n") + kRig),
              Contains(HasSubstr("subject_hint explains subject_pattern, which is missing")));
}

TEST_F(ConfigFiles, ShippedConfigurations_ShowTheDefaultLabelRule) {
  for (const char* name : {"/config/dtsd.toml", "/config/dtsd-clinic.toml"}) {
    std::ifstream stream(std::string(DTS_SOURCE_DIR) + name);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    EXPECT_THAT(text, HasSubstr("# label_pattern = '" + std::string(session::kDefaultLabelPattern) + "'"));
    std::string hint(session::kDefaultLabelHint);
    for (std::size_t at = 0; (at = hint.find('"', at)) != std::string::npos; at += 2) hint.insert(at, 1, '\\');
    EXPECT_THAT(text, HasSubstr("# label_hint = \"" + hint + "\""));
  }
}

TEST_F(ConfigFiles, MissingFile_IsOneProblem) { EXPECT_EQ(load_config((folder_ / "nowhere.toml").string()).problems.size(), 1U); }

TEST_F(ConfigFiles, SyntaxError_NamesLineAndColumn) { EXPECT_THAT(problems_of("[log]\nlevel = \n"), Contains(HasSubstr("dtsd.toml:2:"))); }

TEST_F(ConfigFiles, MisspeltKey_NamesPositionAndSuggestion) {
  RecordProperty("requirement", "CFG-2");
  EXPECT_THAT(problems_of(std::string("[log]\nlevl = \"info\"\n") + kRig),
              Contains(std::string("dtsd.toml:2:1: unknown key 'levl' in [log]; did you mean 'level'?")));
}

TEST_F(ConfigFiles, SeveralProblems_AreReportedTogether) {
  RecordProperty("requirement", "CFG-1");
  const auto problems = problems_of(
      "[log]\nlevel = \"loud\"\n[realtime]\nfifo_priority = 120\nlock_memory = 3\n[endpoints]\ndata = \"tcp://0.0.0.0:5555\"\n"
      "[[rig]]\nname = \"Floor One\"\nfile = \"rig.toml\"\ndevice = \"sim:floor\"\nextra = 1\n");

  EXPECT_THAT(problems, Contains(HasSubstr("dtsd.toml:2:9: [log] level = \"loud\" is not known")));
  EXPECT_THAT(problems, Contains(HasSubstr("dtsd.toml:4:17: [realtime] fifo_priority = 120 is out of range; allowed: 0 .. 95")));
  EXPECT_THAT(problems, Contains(HasSubstr("dtsd.toml:5:15: [realtime] lock_memory must be true or false")));
  EXPECT_THAT(problems, Contains(HasSubstr("dtsd.toml:7:8: 'tcp://0.0.0.0:5555' is a network address")));
  EXPECT_THAT(problems, Contains(HasSubstr("dtsd.toml:9:8: a rig's name")));
  EXPECT_THAT(problems, Contains(HasSubstr("dtsd.toml:12:1: unknown key 'extra' in [[rig]]")));
  EXPECT_EQ(problems.size(), 6U);
}

TEST_F(ConfigFiles, TwoRigsWithOneName_IsAProblemAtTheSecond) {
  EXPECT_THAT(problems_of(std::string(kRig) + kRig), Contains(std::string("dtsd.toml:6:8: another rig is named 'floor' too")));
}

TEST_F(ConfigFiles, NoRig_IsFine) { EXPECT_TRUE(problems_of("[log]\n").empty()); }

TEST_F(ConfigFiles, Network_NeedsBothAddressesAndNoNames) {
  EXPECT_TRUE(problems_of("[network]\ncontrol = \"tcp://*:5555\"\ndata = \"tcp://192.168.1.7:5556\"\n").empty());
  EXPECT_THAT(problems_of("[network]\ncontrol = \"tcp://*:5555\"\n"), Contains(HasSubstr("data")));
  EXPECT_THAT(problems_of("[network]\ncontrol = \"tcp://*:5555\"\ndata = \"tcp://*:5555\"\n"), Contains(HasSubstr("different ports")));
  EXPECT_THAT(problems_of("[network]\ncontrol = \"tcp://clinic:5555\"\ndata = \"ipc:///x\"\n"),
              AllOf(Contains(HasSubstr("names no address")), Contains(HasSubstr("is not tcp://"))));
}

TEST_F(ConfigFiles, RigWithoutDevice_IsAProblem) {
  EXPECT_THAT(problems_of("[[rig]]\nname = \"floor\"\nfile = \"rig.toml\"\n"), Contains(HasSubstr("[[rig]] device is missing")));
}

TEST_F(ConfigFiles, MissingSensorFile_IsNamedWhereTheRigNamesIt) {
  std::filesystem::remove(folder_ / "sensor.toml");

  EXPECT_THAT(problems_of(kRig), Contains(AllOf(HasSubstr("rig.toml:"), HasSubstr("sensor.toml cannot be read: No such file"))));
}

TEST_F(ConfigFiles, MisspeltTable_IsOneProblemAndNotOneForEachOfItsKeys) {
  EXPECT_THAT(
      problems_of_rig(std::string("kind = \"floor\"\n[plat]\na_mm = 430.0\n[support]\nkind = \"corner\"\n") + kSensor + kStage),
      ElementsAre(std::string("rig.toml: [plate] is missing"), std::string("rig.toml:2:2: unknown key 'plat'; did you mean 'plate'?")));
}

TEST_F(ConfigFiles, MissingRigFile_IsNamedWhereTheConfigurationNamesIt) {
  std::filesystem::remove(folder_ / "rig.toml");

  EXPECT_THAT(problems_of(kRig), ElementsAre(AllOf(HasSubstr("dtsd.toml:3:"), HasSubstr("rig.toml cannot be read: No such file"))));
}

TEST_F(ConfigFiles, FallingGaps_AreRefusedByTheCurve) {
  write("sensor.toml", "name = \"bad\"\n[[point]]\ngap_mm = 9.0\nvolts = 4.0\n[[point]]\ngap_mm = 8.0\nvolts = 0.9\n");

  EXPECT_THAT(problems_of(kRig), Contains(HasSubstr("sensor.toml")));
}

TEST_F(ConfigFiles, SenselessPlate_NamesEveryValueAndItsRange) {
  const auto problems = problems_of_rig(
      std::string("kind = \"flor\"\n[plate]\na_mm = -430.0\nb_mm = 430.0\nh_mm = 3.0\ne_pa = inf\nnu = 0.7\n") + kSensor + kStage);

  EXPECT_THAT(problems, Contains(HasSubstr("rig.toml:1:8: kind = \"flor\" is not known; did you mean \"floor\"?")));
  EXPECT_THAT(problems, Contains(HasSubstr("rig.toml:3:8: [plate] a_mm = -430 is out of range; allowed: 10 .. 10000")));
  EXPECT_THAT(problems, Contains(HasSubstr("rig.toml:6:8: [plate] e_pa")));
  EXPECT_THAT(problems, Contains(HasSubstr("rig.toml:7:6: [plate] nu = 0.7 is out of range")));
}

TEST_F(ConfigFiles, TwoSensorsOnOneChannel_IsAProblem) {
  EXPECT_THAT(problems_of_rig(std::string("kind = \"floor\"\n") + kPlate + kSensor + kSensor + "channel = 0\n" + kStage),
              Contains(HasSubstr("channel 0 already belongs to another sensor")));
}

TEST_F(ConfigFiles, UnknownStageAndOption_ComeWithASuggestion) {
  const auto problems =
      problems_of_rig(std::string("kind = \"floor\"\n") + kPlate + kSensor +
                      "[[stage]]\nid = \"gaurd\"\n[[stage]]\nid = \"window_filter\"\nwindow_scan = 3\nshift_scans = \"one\"\n");

  EXPECT_THAT(problems, Contains(HasSubstr("guard")));
  EXPECT_THAT(problems, Contains(HasSubstr("window_scans")));
  EXPECT_THAT(problems, Contains(HasSubstr("shift_scans")));
}

TEST_F(ConfigFiles, ShippedConfiguration_IsFine) {
  const LoadedConfig loaded = load_config(std::string(DTS_SOURCE_DIR) + "/config/dtsd.toml");

  for (const files::Problem& problem : loaded.problems) ADD_FAILURE() << to_string(problem);
  EXPECT_FALSE(loaded.config.rigs.empty());
}

TEST_F(ConfigFiles, RandomBytes_AreProblemsNotCrashes) {
  std::string text;
  for (int step = 1; step < 400; ++step) {
    text.push_back(static_cast<char>((step * 7919 + step * step) & 0xff));
    EXPECT_FALSE(problems_of(text).empty());
  }
}

}  // namespace
}  // namespace dts::app
