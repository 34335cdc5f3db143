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

  EXPECT_EQ(log_, (std::vector<std::string>{"login: anna (operator) from 10.0.0.7", "login refused: anna from 10.0.0.8",
                                            "login refused: a name that no user has from 10.0.0.9"}));
}

TEST_F(AccessControlTest, ManyRefusedLogins_AreALineASecond) {
  for (int i = 0; i < 20; ++i) (void)log_in(login("anna", "incorrect horse"));
  now_ += seconds{1};
  (void)log_in(login("anna", "incorrect horse"));

  EXPECT_EQ(log_, (std::vector<std::string>{"login refused: anna from 192.0.2.7",
                                            "login refused: anna from 192.0.2.7, and 19 more since the line before"}));
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
