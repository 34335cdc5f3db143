// SPDX-License-Identifier: Apache-2.0
#include "core/doorbell.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/resource.h>

#include <system_error>
#include <thread>

namespace dts::core {
namespace {

constexpr int kForEver_ms = -1;

bool is_readable(int fd) {
  pollfd waiter{.fd = fd, .events = POLLIN, .revents = 0};
  return ::poll(&waiter, 1, 0) == 1;
}

TEST(Doorbell, Rung_IsKeptUntilTheWait_AndCountsOnce) {
  Doorbell bell;
  EXPECT_FALSE(bell.wait(0));
  EXPECT_FALSE(is_readable(bell.fd()));

  for (int ring = 0; ring < 3; ++ring) bell.ring();

  EXPECT_TRUE(is_readable(bell.fd()));
  EXPECT_TRUE(bell.wait(kForEver_ms));
  EXPECT_FALSE(bell.wait(0));
}

TEST(Doorbell, Clear_TellsWhetherItWasRung) {
  Doorbell bell;
  bell.ring();

  EXPECT_TRUE(bell.clear());
  EXPECT_FALSE(bell.clear());
  EXPECT_FALSE(is_readable(bell.fd()));
}

TEST(Doorbell, RungFromAnotherThread_WakesTheWaiter) {
  Doorbell there;
  Doorbell back;
  constexpr int kRounds = 100;

  std::thread echo([&] {
    for (int i = 0; i < kRounds; ++i) {
      ASSERT_TRUE(there.wait(kForEver_ms));
      back.ring();
    }
  });
  for (int i = 0; i < kRounds; ++i) {
    there.ring();
    EXPECT_TRUE(back.wait(kForEver_ms));
  }
  echo.join();
}

TEST(Doorbell, NoDescriptorLeft_Throws) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer needs a descriptor itself to look at the exception";
#endif
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit none{.rlim_cur = 0, .rlim_max = before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &none), 0);

  EXPECT_THROW(Doorbell{}, std::system_error);

  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
}

}  // namespace
}  // namespace dts::core
