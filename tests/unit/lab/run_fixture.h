// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "cli/exit_status.h"
#include "lab/run.h"

namespace dts::lab {

/// Runs dtslab with string streams; has a directory of its own for files.
class RunTest : public ::testing::Test {
 protected:
  RunTest() { std::filesystem::create_directories(directory_); }
  ~RunTest() override { std::filesystem::remove_all(directory_); }

  int run_with(const std::vector<std::string>& arguments) {
    out_.str({});
    talk_.str({});
    return run(arguments, console_);
  }
  /// What a call says that is wrong usage; files by their names without the directory.
  std::string refusal_of(const std::vector<std::string>& arguments) {
    EXPECT_EQ(run_with(arguments), cli::kUsage) << ::testing::PrintToString(arguments);
    return std::regex_replace(talk(), std::regex(path("")), "");
  }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(directory_ / name) << text;
    return path(name);
  }
  [[nodiscard]] std::string content(const std::string& name) const {
    std::ifstream file(directory_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] std::string path(const std::string& name) const { return (directory_ / name).string(); }
  [[nodiscard]] std::string out() const { return out_.str(); }
  [[nodiscard]] std::string talk() const { return talk_.str(); }
  [[nodiscard]] nlohmann::json json() const { return nlohmann::json::parse(out()); }

  std::filesystem::path directory_ = std::filesystem::path(::testing::TempDir()) / ("dtslab_" + std::to_string(::getpid()));
  std::ostringstream out_;
  std::ostringstream talk_;
  cli::Console console_{.out = out_, .talk = talk_};
};

}  // namespace dts::lab
