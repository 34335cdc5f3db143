// SPDX-License-Identifier: Apache-2.0
// What only a chair's rig file has: the sensors of its transient, and the model of trunk movement.
#include <gtest/gtest.h>

#include "files/rig_file.h"
#include "unit/files/files_fixture.h"

namespace dts::files {
namespace {

class ChairFile : public FilesTest {
 protected:
  ChairFile() {
    for (const char* beside : {"sensors", "models"}) {
      if (std::filesystem::exists(kConfig / beside)) std::filesystem::copy(kConfig / beside, folder_ / beside);
    }
  }
  pipeline::RigConfig read(const std::string& text, Problems& problems) const {
    return read_rig_file(write("rigs/chair.toml", text), problems);
  }
  const std::string shipped_ = content_of(kConfig / "rigs/chair-sim.toml");
};

TEST_F(ChairFile, Shipped_NamesItsSensorsAndItsModelAndItsDefinitionCarriesIt) {
  Problems problems;
  const pipeline::RigConfig config = read(shipped_, problems);

  ASSERT_EQ(text_of(problems), "");
  EXPECT_EQ(config.kind, "chair");
  EXPECT_EQ(config.model.sensors.size(), 16U);
  ASSERT_TRUE(config.model.transient_sensors);
  const auto& [rear, front] = *config.model.transient_sensors;
  std::string labels;
  for (const std::size_t index : {rear[0], rear[1], front[0], front[1]}) labels += config.model.sensors.at(index).label + " ";
  EXPECT_EQ(labels, "2 5 10 13 ");
  EXPECT_TRUE(config.trunk_model);
  EXPECT_FALSE(config.trunk_model_text.empty());
  const auto definition = rig_definition(path("rigs/chair.toml"));
  ASSERT_TRUE(definition) << core::to_string(definition.error());
  EXPECT_EQ(read_rig_text(*definition, "definition", problems).trunk_model_text, config.trunk_model_text);
  EXPECT_EQ(text_of(problems), "");
}

TEST_F(ChairFile, WithoutASupport_IsReported) {
  expect_problems(shipped_,
                  {{"[support]", "[supports]",
                    "rigs/chair.toml: [support] is missing\n"
                    "rigs/chair.toml:15:2: unknown key 'supports'; did you mean 'support'?"}},
                  [this](const std::string& text, Problems& problems) { (void)read(text, problems); });
}

TEST_F(ChairFile, ModelAndClassify_NeedEachOther) {
  expect_problems(
      shipped_,
      {{"model", "", "rigs/chair.toml:1:1: [[stage]] \"classify\" needs a model: add model = \"FILE.toml\", see dtslab reach train"},
       {"model", "model = \"\"", "rigs/chair.toml:6:9: model is empty: name a file, or remove the line"},
       {"id = \"classify\"", "id = \"guard\"", "rigs/chair.toml:6:9: the rig has no [[stage]] \"classify\" that could use its model"},
       {"model", "model = \"nowhere.toml\"", "rigs/chair.toml:6:9: rigs/nowhere.toml cannot be read: No such file or directory"}},
      [this](const std::string& text, Problems& problems) { (void)read(text, problems); });
}

}  // namespace
}  // namespace dts::files
