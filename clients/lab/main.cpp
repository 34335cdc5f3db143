// SPDX-License-Identifier: Apache-2.0
#include "cli/program.h"
#include "lab/run.h"

int main(int count, char** words) { return dts::cli::run_program("dtslab", count, words, dts::lab::run); }
