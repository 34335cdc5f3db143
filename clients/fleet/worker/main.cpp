// SPDX-License-Identifier: Apache-2.0
#include "cli/program.h"
#include "fleet/worker/program.h"

int main(int count, char** words) { return dts::cli::run_program("dts-worker", count, words, dts::fleet::worker::run); }
