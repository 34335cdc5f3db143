// SPDX-License-Identifier: Apache-2.0
#include <google/protobuf/stubs/logging.h>

#include "cli/program.h"
#include "ctl/run.h"

int main(int count, char** words) {
  google::protobuf::SetLogHandler(nullptr);  // messages that cannot be parsed are counted or reported, not logged
  return dts::cli::run_program("dtsctl", count, words, dts::ctl::run);
}
