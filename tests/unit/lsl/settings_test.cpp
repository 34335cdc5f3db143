// SPDX-License-Identifier: Apache-2.0
#include "lsl/settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "support/temporary_folder.h"

namespace dts::lsl {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class LslSettings : public ::testing::Test {
 protected:
  Settings load(const std::string& text) {
    const std::string file = folder_.path() + "/lsl.toml";
    std::ofstream(file) << text;
    problems_.clear();
    return load_settings(file, problems_);
  }
  std::vector<std::string> problems(const std::string& text) {
    static_cast<void>(load(text));
    std::vector<std::string> texts;
    for (const files::Problem& problem : problems_) texts.push_back(files::to_string(problem));
    return texts;
  }

  test::TemporaryFolder folder_;
  files::Problems problems_;
};

TEST_F(LslSettings, EmptyFile_OffersEverythingAndReceivesNothing) {
  const Settings settings = load("");
  EXPECT_THAT(problems_, IsEmpty());
  EXPECT_THAT(settings.rigs, IsEmpty());
  EXPECT_THAT(settings.streams, IsEmpty());
  EXPECT_THAT(settings.markers_from, IsEmpty());
  EXPECT_EQ(settings.buffer_s, 360);
  EXPECT_FALSE(settings.lab_recorder);
}

TEST_F(LslSettings, WholeFile_IsRead) {
  const Settings settings = load(
      "[log]\nlevel = \"warning\"\n[daemon]\ncontrol = \"ipc:///run/dtsd/control.sock\"\n"
      "[lsl]\nlibrary = \"/opt/liblsl.so\"\nrigs = [\"floor\"]\nstreams = [\"raw\", \"cop\"]\nbuffer_s = 10\nmarkers_from = "
      "\"name='Task'\"\n"
      "markers_rig = \"floor\"\n[labrecorder]\naddress = \"lab2:22345\"\nfolder = \"C:\\\\Data\"\n");
  ASSERT_THAT(problems_, IsEmpty());
  EXPECT_EQ(settings.log_level, core::LogLevel::Warning);
  EXPECT_EQ(settings.daemon.control, "ipc:///run/dtsd/control.sock");
  EXPECT_EQ(settings.library, "/opt/liblsl.so");
  EXPECT_THAT(settings.rigs, ElementsAre("floor"));
  EXPECT_THAT(settings.streams, ElementsAre("raw", "cop"));
  EXPECT_EQ(settings.buffer_s, 10);
  EXPECT_THAT(settings.markers_from, ElementsAre("name='Task'"));
  EXPECT_EQ(settings.markers_rig, "floor");
  ASSERT_TRUE(settings.lab_recorder);
  EXPECT_EQ(settings.lab_recorder->host, "lab2");
  EXPECT_EQ(settings.lab_recorder->port, 22345);
  EXPECT_EQ(settings.lab_recorder->folder, "C:\\Data");
  EXPECT_THAT(load("[lsl]\nmarkers_from = [\"name='A'\", \"name='B'\"]\n").markers_from, ElementsAre("name='A'", "name='B'"));
}

TEST_F(LslSettings, WrongValues_AreNamedWithTheirPlace) {
  EXPECT_THAT(problems("[lsl]\nmarkers_from = [\"\"]\n"), ElementsAre(HasSubstr("lsl.toml:2:")));
  EXPECT_THAT(problems("[daemon]\ndata = \"tcp://127.0.0.1:5556\"\n"), ElementsAre(HasSubstr("runs on the daemon's machine")));
  EXPECT_THAT(problems("[labrecorder]\nfolder = \"/data\"\n"), Contains(HasSubstr("address")));
  for (const char* address : {"lab2", ":22345", "lab2:", "lab2:0", "lab2:70000", "lab2:22345x"}) {
    EXPECT_THAT(problems(std::string("[labrecorder]\naddress = \"") + address + "\"\n"), Contains(HasSubstr("HOST:PORT"))) << address;
  }
  EXPECT_THAT(problems("[labrecorder]\naddress = \"lab2:22345\"\nfolder = \"/data}\\nstop\"\n"), Contains(HasSubstr("no { or }")));
  EXPECT_THAT(problems("[lsl]\nlibary = \"x\"\n"), ElementsAre(HasSubstr("library")));
}

}  // namespace
}  // namespace dts::lsl
