// SPDX-License-Identifier: Apache-2.0
#include <google/protobuf/stubs/logging.h>

#include "cli/program.h"
#include "fleet/forward/program.h"

int main(int count, char** words) {
  google::protobuf::SetLogHandler(nullptr);  // messages that cannot be parsed are rejected, not logged
  return dts::cli::run_program("dts-forward", count, words, dts::fleet::forward::run);
}
