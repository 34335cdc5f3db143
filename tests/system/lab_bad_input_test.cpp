// SPDX-License-Identifier: Apache-2.0
// What only dtslab as a program shows; tests/unit/lab has the input that is wrong.
#include <gtest/gtest.h>

#include "system/daemon_process.h"

namespace dts::test {
namespace {

TEST(LabProgram, OutputThatCannotBeWritten_IsNeverSilence) {
  EXPECT_EQ(run_program({"/bin/sh", "-c", std::string(DTSLAB_PROGRAM) + " man > /dev/full"}).status, 1);
}

}  // namespace
}  // namespace dts::test
