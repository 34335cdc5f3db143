// SPDX-License-Identifier: Apache-2.0
#include "settings/folders.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace dts::settings {
namespace {

TEST(Folders, RuntimeDirectory_FollowsTheDocumentedOrder) {
  ::setenv("XDG_RUNTIME_DIR", "/xdg", 1);
  ::unsetenv("RUNTIME_DIRECTORY");
  ::unsetenv("DTSD_RUNTIME_DIR");
  EXPECT_EQ(runtime_directory(), "/xdg/dtsd");
  ::setenv("RUNTIME_DIRECTORY", "/systemd", 1);
  EXPECT_EQ(runtime_directory(), "/systemd");
  ::setenv("DTSD_RUNTIME_DIR", "/ours", 1);
  EXPECT_EQ(runtime_directory(), "/ours");
  ::setenv("DTSD_RUNTIME_DIR", "", 1);
  EXPECT_EQ(runtime_directory(), "/systemd") << "an empty variable decides nothing";
}

}  // namespace
}  // namespace dts::settings
