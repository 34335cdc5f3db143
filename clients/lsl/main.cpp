// SPDX-License-Identifier: Apache-2.0
#include <google/protobuf/stubs/logging.h>

#include "cli/program.h"
#include "lsl/program.h"

int main(int count, char** words) {
  google::protobuf::SetLogHandler(nullptr);  // messages that cannot be parsed are rejected, not logged
  return dts::cli::run_program("dts-lsl", count, words, dts::lsl::run);
}
