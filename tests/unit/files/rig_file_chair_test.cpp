// SPDX-License-Identifier: Apache-2.0
// What only a chair's rig file has: the sensors of its transient, and the model of trunk movement.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <regex>

#include "files/rig_file.h"

namespace dts::files {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::filesystem::path kShippedConfig = std::filesystem::path(DTS_SOURCE_DIR) / "config";

class ChairFile : public testing::Test {
 protected:
  /// The shipped simulated chair with every line that begins with `key` replaced; an empty replacement takes it out.
  pipeline::RigConfig read(const std::string& key = {}, const std::string& replacement = {}) {
    std::ifstream in(kShippedConfig / "rigs/chair-sim.toml");
    std::string text;
    for (std::string line; std::getline(in, line);) text += (!key.empty() && line.starts_with(key) ? replacement : line) + "\n";
    text = std::regex_replace(text, std::regex("\"\\.\\./"), "\"" + kShippedConfig.string() + "/");
    const auto file = std::filesystem::temp_directory_path() / ("dts-chair-" + std::to_string(getpid()) + ".toml");
    std::ofstream(file) << text;
    problems_.clear();
    pipeline::RigConfig config = read_rig_file(file.string(), problems_);
    std::filesystem::remove(file);
    return config;
  }
  [[nodiscard]] std::vector<std::string> problems() const {
    std::vector<std::string> lines;
    for (const Problem& problem : problems_) lines.push_back(to_string(problem));
    return lines;
  }

  Problems problems_;
};

TEST_F(ChairFile, Shipped_NamesItsSensorsAndItsModel) {
  const pipeline::RigConfig config = read();

  ASSERT_THAT(problems(), IsEmpty());
  EXPECT_EQ(config.kind, "chair");
  EXPECT_EQ(config.model.sensors.size(), 16U);
  ASSERT_TRUE(config.model.transient_sensors);
  const auto label = [&config](std::size_t index) { return config.model.sensors.at(index).label; };
  EXPECT_EQ(label(config.model.transient_sensors->rear[0]), "2");
  EXPECT_EQ(label(config.model.transient_sensors->rear[1]), "5");
  EXPECT_EQ(label(config.model.transient_sensors->front[0]), "10");
  EXPECT_EQ(label(config.model.transient_sensors->front[1]), "13");
  EXPECT_TRUE(config.trunk_model);
  EXPECT_FALSE(config.trunk_model_text.empty());
}

TEST_F(ChairFile, TransientSensors_AreCheckedOneByOne) {
  const auto problems_of = [this](const std::string& line) {
    (void)read("transient_sensors", line);
    return problems();
  };

  EXPECT_THAT(problems_of(R"(transient_sensors = ["2", "5", "10"])"), ElementsAre(HasSubstr("name four sensors")));
  EXPECT_THAT(problems_of(R"(transient_sensors = ["2", "5", "10", "17"])"), ElementsAre(HasSubstr("no sensor labelled '17'")));
  EXPECT_THAT(problems_of(R"(transient_sensors = ["2", "5", "10", "5"])"), ElementsAre(HasSubstr("'5' is named twice")));
  EXPECT_THAT(problems_of(R"(transient_sensors = ["5", "2", "10", "13"])"), ElementsAre(HasSubstr("x to the right")));
  EXPECT_THAT(problems_of(R"(transient_sensors = ["10", "13", "2", "5"])"), ElementsAre(HasSubstr("y grows to the front")));
}

TEST_F(ChairFile, ClassifyWithoutModel_IsRefusedWithWhatToDo) {
  (void)read("model", "");

  EXPECT_THAT(problems(), ElementsAre(HasSubstr("\"classify\" needs a model")));
}

TEST_F(ChairFile, ModelWithoutClassify_IsRefused) {
  (void)read("id = \"classify\"", "id = \"guard\"");

  EXPECT_THAT(problems(), testing::Contains(HasSubstr("no [[stage]] \"classify\"")));
}

TEST_F(ChairFile, ModelThatIsNotThere_IsToldAtItsPlace) {
  (void)read("model", "model = \"nowhere.toml\"");

  EXPECT_THAT(problems(), testing::Contains(HasSubstr("nowhere.toml")));
}

TEST_F(ChairFile, Definition_CarriesTheModel) {
  const auto definition = rig_definition((kShippedConfig / "rigs/chair-sim.toml").string());
  ASSERT_TRUE(definition) << core::to_string(definition.error());

  const pipeline::RigConfig config = read_rig_text(*definition, "definition", problems_);

  EXPECT_THAT(problems(), IsEmpty());
  EXPECT_EQ(config.trunk_model_text, read().trunk_model_text);
}

}  // namespace
}  // namespace dts::files
