// SPDX-License-Identifier: Apache-2.0
// One binary with two names: dts-hub, and dts-fleet, which is a link to it.
#include <google/protobuf/stubs/logging.h>

#include <string_view>

#include "cli/program.h"
#include "fleet/hub/programs.h"

int main(int count, char** words) {
  google::protobuf::SetLogHandler(nullptr);  // messages that cannot be parsed are answered, not logged
  const std::string_view path = count > 0 ? words[0] : "";
  const std::string_view name = path.substr(path.rfind('/') + 1);
  if (name == "dts-fleet") return dts::cli::run_program("dts-fleet", count, words, dts::fleet::hub::run_fleet_program);
  return dts::cli::run_program("dts-hub", count, words, dts::fleet::hub::run_hub_program);
}
