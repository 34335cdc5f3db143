// SPDX-License-Identifier: Apache-2.0
#include "dts/key.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "unit/libdts/fake_daemon.h"

namespace dts::client {
namespace {

TEST(KeyFile, Pipe_IsRefusedInsteadOfWaitedFor) {
  const testing::TemporaryDirectory directory;
  const std::string pipe = (directory.path() / "pipe.key").string();
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);

  const auto key = read_key(pipe);

  ASSERT_FALSE(key);
  EXPECT_EQ(key.error().code, ErrorCode::InvalidArgument);
  EXPECT_THAT(key.error().what, ::testing::HasSubstr(pipe + " is no regular file"));
}

}  // namespace
}  // namespace dts::client
