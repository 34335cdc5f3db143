// SPDX-License-Identifier: Apache-2.0
#include "cli/progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <sstream>

namespace dts::cli {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

class ProgressTest : public ::testing::Test {
 protected:
  std::function<Progress::Time()> clock() {
    return [this] { return now_; };
  }

  Progress::Time now_{};
  std::ostringstream out_;
  std::ostringstream talk_;
  Console console_{.out = out_, .talk = talk_, .is_talk_terminal = true};
};

TEST_F(ProgressTest, QuickWork_ShowsNothing) {
  {
    Progress progress(console_, "solving", clock());
    now_ += milliseconds(1999);
    progress.report(0.9);
  }

  EXPECT_EQ(talk_.str(), "");
}

TEST_F(ProgressTest, SlowWork_ShowsABarThatIsRemovedAtTheEnd) {
  {
    Progress progress(console_, "solving", clock());
    now_ += milliseconds(2000);
    progress.report(0.6);
    EXPECT_EQ(talk_.str(), "\rsolving  [############........]   60 %  2 s");
  }

  EXPECT_THAT(talk_.str(), ::testing::EndsWith("\r" + std::string(43, ' ') + "\r"));
  EXPECT_EQ(out_.str(), "");
}

TEST_F(ProgressTest, WorkThatReportsNothing_IsShownWithItsSeconds) {
  Progress progress(console_, "solving", clock());
  now_ += milliseconds(1999);
  progress.tick();
  EXPECT_EQ(talk_.str(), "");

  now_ += milliseconds(11'001);
  progress.tick();
  EXPECT_EQ(talk_.str(), "\rsolving  [....................]    0 %  13 s");
}

TEST_F(ProgressTest, ManyReports_AtMostTenPerSecond) {
  Progress progress(console_, "solving", clock());
  now_ += milliseconds(2000);
  progress.report(0.1);
  const std::size_t once = talk_.str().size();

  now_ += milliseconds(99);
  progress.report(0.2);
  EXPECT_EQ(talk_.str().size(), once);

  now_ += milliseconds(1);
  progress.report(0.2);
  EXPECT_GT(talk_.str().size(), once);
}

TEST_F(ProgressTest, FractionsOutOfRange_StayInsideTheBar) {
  Progress progress(console_, "solving", clock());
  now_ += milliseconds(2000);
  progress.report(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(talk_.str(), "");

  progress.report(7.0);
  EXPECT_THAT(talk_.str(), HasSubstr("[####################]  100 %"));

  now_ += milliseconds(100);
  progress.report(-1.0);
  EXPECT_THAT(talk_.str(), HasSubstr("[....................]    0 %"));
}

TEST_F(ProgressTest, NoTerminal_ShowsNothing) {
  console_.is_talk_terminal = false;
  {
    Progress progress(console_, "solving", clock());
    now_ += milliseconds(5000);
    progress.report(0.5);
  }

  EXPECT_EQ(talk_.str(), "");
}

}  // namespace
}  // namespace dts::cli
