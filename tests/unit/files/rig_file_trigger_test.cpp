// SPDX-License-Identifier: Apache-2.0
// [trigger] and [session] of a rig file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "files/rig_file.h"

namespace dts::files {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class RigWithTrigger : public testing::Test {
 protected:
  /// The repository's simulated floor with `tail` behind it.
  pipeline::RigConfig read(const std::string& tail) {
    const std::filesystem::path config_folder = std::filesystem::path(DTS_SOURCE_DIR) / "config";
    std::ifstream in(config_folder / "rigs/floor-sim.toml");
    std::string text(std::istreambuf_iterator<char>(in), {});
    const std::string relative = "\"../sensors";
    const std::string absolute = "\"" + (config_folder / "sensors").string();
    for (std::size_t at = text.find(relative); at != std::string::npos; at = text.find(relative)) {
      text.replace(at, relative.size(), absolute);
    }
    const auto file = std::filesystem::temp_directory_path() / ("dts-trigger-" + std::to_string(getpid()) + ".toml");
    std::ofstream(file) << text << "\n" << tail;
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

TEST_F(RigWithTrigger, WithoutTables_HasNeitherTriggerNorPulse) {
  const pipeline::RigConfig config = read("");
  EXPECT_THAT(problems(), IsEmpty());
  EXPECT_FALSE(config.trigger);
  EXPECT_EQ(config.sync_pulse_ms, 0.0);
}

TEST_F(RigWithTrigger, TablesAreTakenOver) {
  const pipeline::RigConfig config =
      read("[trigger]\nchannel = 6\nlevel = 1.5\nhysteresis = 0.25\nedges = \"both\"\n[session]\nsync_pulse_ms = 80\n");
  ASSERT_THAT(problems(), IsEmpty());
  ASSERT_TRUE(config.trigger);
  EXPECT_EQ(config.trigger->channel, 6U);
  EXPECT_EQ(config.trigger->level, 1.5);
  EXPECT_EQ(config.trigger->hysteresis, 0.25);
  EXPECT_EQ(config.trigger->edges, pipeline::TriggerEdges::Both);
  EXPECT_EQ(config.sync_pulse_ms, 80.0);
}

TEST_F(RigWithTrigger, EveryMistakeIsToldAtItsPlace) {
  read("[trigger]\nchannel = 2\nedges = \"up\"\nlevl = 2\n[session]\nsync_pulse_ms = -1\nsync_puls_ms = 1\n");
  EXPECT_THAT(problems(), ElementsAre(HasSubstr("edges"), HasSubstr("channel 2 belongs to a sensor"), HasSubstr("levl"),
                                      HasSubstr("sync_pulse_ms"), HasSubstr("unknown key 'sync_puls_ms'")));
  problems_.clear();
  read("[trigger]\nlevel = 2\n");
  EXPECT_THAT(problems(), ElementsAre(HasSubstr("channel")));
}

}  // namespace
}  // namespace dts::files
