// SPDX-License-Identifier: Apache-2.0
// What is told of logins: lines of the log, and notes for the audit trail.
#include "unit/gateway/access/access_fixture.h"

namespace dts::gateway {
namespace {

using std::chrono::seconds;

TEST_F(AccessControlTest, Logins_AreLoggedWithTheirAddress) {
  (void)log_in(login("anna", kPassword, "10.0.0.7"));
  (void)log_in(login("anna", "incorrect horse", "10.0.0.8"));
  now_ += seconds{1};
  (void)log_in(login("my secret password", "anna", "10.0.0.9"));

  EXPECT_EQ(log_, (std::vector<std::string>{"login: anna (operator) from 10.0.0.7", "login rejected: anna from 10.0.0.8",
                                            "login rejected: a name that no user has from 10.0.0.9"}));
}

TEST_F(AccessControlTest, Addresses_AreToldAsTheyAreAndCountedAsBefore) {
  for (const char* from : {"2001:db8:1:2:3::4", "::1"}) {
    (void)log_in(login("anna", kPassword, from));
    EXPECT_EQ(log_.back(), std::string("login: anna (operator) from ") + from);
    EXPECT_EQ(notes_.back().address, from);
  }
  for (int count = 0; count < 5; ++count) begin(login("anna", "incorrect horse", "2001:db8:1:2::" + std::to_string(count)));
  wait_for(5);

  EXPECT_EQ(log_in(login("anna", kPassword, "2001:db8:1:2::ffff")).status, 429U) << "one host owns the whole /64";
  EXPECT_EQ(log_in(login("anna", kPassword, "2001:db8:1:3::1")).status, 200U);
}

TEST_F(AccessControlTest, BurstThatStops_IsToldOnTheNextTurn) {
  for (int i = 0; i < 25; ++i) (void)log_in(login("anna", "incorrect horse", "10.0.0." + std::to_string(i)));
  access_->report_rest(false);
  ASSERT_EQ(log_.size(), 1U);
  ASSERT_EQ(notes_.size(), 20U);

  now_ += seconds{10};
  for (int turn = 0; turn < 3; ++turn) access_->report_rest(false);

  EXPECT_EQ(log_, (std::vector<std::string>{"login rejected: anna from 10.0.0.0",
                                            "login rejected: anna from 10.0.0.24, and 23 more since the line before"}));
  ASSERT_EQ(notes_.size(), 21U);
  EXPECT_EQ(notes_.back().address, "10.0.0.24");
  EXPECT_EQ(notes_.back().more, 4U);
}

TEST_F(AccessControlTest, LoginAfterABurst_BringsTheRestAlong) {
  for (int i = 0; i < 3; ++i) (void)log_in(login("anna", "incorrect horse"));
  now_ += seconds{1};
  (void)log_in(login("anna", kPassword, "10.0.0.7"));

  ASSERT_EQ(log_.size(), 3U);
  EXPECT_EQ(log_[2], "login rejected: anna from 192.0.2.7, and 1 more since the line before");
}

TEST_F(AccessControlTest, EndAfterABurst_LosesNothing) {
  for (int i = 0; i < 3; ++i) (void)log_in(login("anna", "incorrect horse"));
  access_->report_rest(true);
  access_->report_rest(true);

  EXPECT_EQ(log_, (std::vector<std::string>{"login rejected: anna from 192.0.2.7",
                                            "login rejected: anna from 192.0.2.7, and 1 more since the line before"}));
}

TEST_F(AccessControlTest, Logins_AreNotedForTheAuditTrailAFewTimesOnly) {
  (void)log_in(login("anna", kPassword, "10.0.0.7"));
  for (int i = 0; i < 25; ++i) (void)log_in(login("my secret password", "anna", "10.0.0.9"));
  now_ += seconds{11};
  (void)log_in(login("anna", "incorrect horse", "10.0.0.8"));

  ASSERT_EQ(notes_.size(), 22U);
  EXPECT_EQ(notes_[0].user, "anna");
  EXPECT_EQ(notes_[0].address, "10.0.0.7");
  EXPECT_FALSE(notes_[0].is_refused);
  EXPECT_EQ(notes_[1].user, "") << "it may be a password in the wrong field";
  EXPECT_TRUE(notes_[1].is_refused);
  EXPECT_EQ(notes_.back().user, "anna");
  EXPECT_EQ(notes_.back().more, 5U);
}

}  // namespace
}  // namespace dts::gateway
