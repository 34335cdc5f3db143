// SPDX-License-Identifier: Apache-2.0
// What dtsd, dts-relay and dts-gateway read from the same configuration.
#include "settings/shared_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

namespace dts::settings {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class SharedSettings : public ::testing::Test {
 protected:
  SharedSettings() { ::setenv("DTSD_RUNTIME_DIR", "/run/test", 1); }

  /// Parses `text`, gives `read` a reader of it, and keeps the problems as texts.
  template <class Read>
  auto read_from(const std::string& text, Read read) {
    files::Problems problems;
    const auto table = files::parse_toml_text(text, "dtsd.toml", problems);
    files::TomlReader top(&*table, "", "dtsd.toml", problems);
    auto found = read(top);
    problems_.clear();
    for (const files::Problem& problem : problems) problems_.push_back(files::to_string(problem));
    return found;
  }
  core::LogLevel level_of(const std::string& text) {
    return read_from(text, [](files::TomlReader& top) { return read_log_level(top.table("log")); });
  }
  LocalEndpoints endpoints_of(const std::string& text) {
    return read_from(text, [](files::TomlReader& top) { return read_endpoints(top.table("endpoints")); });
  }
  std::optional<RemoteEndpoints> network_of(const std::string& text) {
    return read_from(text, [](files::TomlReader& top) { return read_network(top); });
  }

  std::vector<std::string> problems_;
};

TEST_F(SharedSettings, LogLevels_AreFour) {
  EXPECT_EQ(level_of("[log]\n"), core::LogLevel::Info);
  for (const auto& [word, level] : {std::pair("debug", core::LogLevel::Debug), std::pair("info", core::LogLevel::Info),
                                    std::pair("warning", core::LogLevel::Warning), std::pair("error", core::LogLevel::Error)}) {
    EXPECT_EQ(level_of("[log]\nlevel = \"" + std::string(word) + "\"\n"), level);
    EXPECT_THAT(problems_, IsEmpty());
  }
  EXPECT_EQ(level_of("[log]\nlevel = \"loud\"\nvolume = 3\n"), core::LogLevel::Info);
  EXPECT_THAT(problems_, ElementsAre(HasSubstr("dtsd.toml:2:"), HasSubstr("volume")));
}

TEST_F(SharedSettings, LocalEndpoints_AreInTheRuntimeDirectoryOrAsGiven) {
  EXPECT_EQ(endpoints_of("[endpoints]\n").control, "ipc:///run/test/control.sock");
  EXPECT_EQ(endpoints_of("[endpoints]\n").data, "ipc:///run/test/data.sock");
  EXPECT_EQ(endpoints_of("[endpoints]\ndata = \"ipc:///a\"\n").data, "ipc:///a");
  EXPECT_THAT(problems_, IsEmpty());

  (void)endpoints_of("[endpoints]\ncontrol = \"ipc:///a\"\ndata = \"ipc:///a\"\n");
  EXPECT_THAT(problems_, ElementsAre(HasSubstr("control and data need different endpoints")));
  (void)endpoints_of("[endpoints]\ncontrol = \"tcp://*:1\"\nother = 1\n");
  EXPECT_THAT(problems_, ElementsAre(HasSubstr("is a network address"), HasSubstr("other")));
}

TEST_F(SharedSettings, Network_IsAbsentOrHasBothEndpoints) {
  EXPECT_FALSE(network_of(""));
  const auto network = network_of("[network]\ncontrol = \"tcp://*:1\"\ndata = \"tcp://*:2\"\n");
  EXPECT_EQ(network.value().control, "tcp://*:1");
  EXPECT_EQ(network.value().data, "tcp://*:2");
  EXPECT_THAT(problems_, IsEmpty());

  (void)network_of("[network]\ncontrol = \"tcp://*:1\"\n");
  EXPECT_THAT(problems_, ElementsAre(HasSubstr("data"))) << "one problem for what is missing";
  (void)network_of("[network]\ncontrol = \"tcp://*:1\"\ndata = \"tcp://*:1\"\nport = 2\n");
  EXPECT_THAT(problems_, ElementsAre(HasSubstr("control and data need different ports"), HasSubstr("port")));
  (void)network_of("[network]\ncontrol = \"tcp://*:1\"\ndata = \"ipc:///a\"\n");
  EXPECT_THAT(problems_, ElementsAre(HasSubstr("is not tcp://")));
}

TEST_F(SharedSettings, RecordingsDirectory_IsAbsoluteAndTheEnvironmentDecides) {
  const auto directory_of = [this](const std::string& file, const std::string& text) {
    files::Problems problems;
    const auto table = files::parse_toml_text(text, file, problems);
    files::TomlReader top(&*table, "", file, problems);
    return read_recordings_directory(top);
  };
  ::unsetenv("DTSD_STATE_DIR");
  EXPECT_EQ(directory_of("/etc/dtsd/dtsd.toml", "directory = \"../data\""), "/etc/data") << "relative to the file";
  EXPECT_EQ(directory_of("/etc/dtsd/dtsd.toml", "directory = \"/srv/data\""), "/srv/data");
  ::setenv("DTSD_STATE_DIR", "", 1);
  EXPECT_EQ(directory_of("/etc/dtsd/dtsd.toml", "directory = \"/srv/data\""), "/srv/data") << "an empty variable decides nothing";
  ::setenv("DTSD_STATE_DIR", "/var/./state", 1);
  EXPECT_EQ(directory_of("/etc/dtsd/dtsd.toml", "directory = \"/srv/data\""), "/var/state");
  ::unsetenv("DTSD_STATE_DIR");
  ::setenv("STATE_DIRECTORY", "/var/lib/dtsd", 1);
  EXPECT_EQ(directory_of("/etc/dtsd/dtsd.toml", ""), "/var/lib/dtsd");
  ::unsetenv("STATE_DIRECTORY");
  EXPECT_EQ(key_directory("/srv/data"), "/srv/data/keys");
}

}  // namespace
}  // namespace dts::settings
