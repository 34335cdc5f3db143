// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "cli/exit_status.h"
#include "ctl/run.h"
#include "unit/libdts/fake_daemon.h"

namespace dts::ctl {

/// Runs dtsctl with string streams against sockets in a directory of its own.
class RunTest : public ::testing::Test {
 protected:
  int run_with(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--endpoint", control_});
    return run_bare(arguments);
  }
  int run_bare(const std::vector<std::string>& arguments) {
    out_.str({});
    talk_.str({});
    return run(arguments, console_);
  }
  [[nodiscard]] std::string out() const { return out_.str(); }
  [[nodiscard]] std::string talk() const { return talk_.str(); }
  [[nodiscard]] nlohmann::json json() const { return nlohmann::json::parse(out()); }

  testing::TemporaryDirectory directory_;
  std::string control_ = directory_.endpoint("control.sock");
  std::string data_ = directory_.endpoint("data.sock");
  std::ostringstream out_;
  std::ostringstream talk_;
  cli::Console console_{.out = out_, .talk = talk_};
};

}  // namespace dts::ctl
