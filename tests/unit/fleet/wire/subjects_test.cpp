// SPDX-License-Identifier: Apache-2.0
#include "fleet/wire/subjects.h"

#include <gtest/gtest.h>

namespace dts::fleet::wire {
namespace {

TEST(SubjectsTest, EachSubjectIsReadAsItWasWritten) {
  const std::vector<std::pair<Subject, std::string>> cases{
      {{.clinic = "kent", .matter = Matter::Open}, "dts.v1.kent.up.open"},
      {{.clinic = "kent", .matter = Matter::Chunk, .worker = "hub-1-7"}, "dts.v1.kent.up.hub-1-7.chunk"},
      {{.clinic = "kent", .matter = Matter::Commit, .worker = "hub-1-7"}, "dts.v1.kent.up.hub-1-7.commit"},
      {{.clinic = "kent", .matter = Matter::Facts}, "dts.v1.kent.facts"},
      {{.clinic = "kent", .matter = Matter::Erase}, "dts.v1.kent.erase"},
      {{.clinic = "kent", .matter = Matter::Beat}, "dts.v1.kent.beat"},
      {{.clinic = "kent", .matter = Matter::Live, .topic = "floor_2/cop"}, "dts.v1.kent.live.floor_2.cop"},
      {{.clinic = "kent", .matter = Matter::DownLive}, "dts.v1.kent.down.live"},
  };
  for (const auto& [subject, text] : cases) {
    EXPECT_EQ(to_text(subject), text);
    const auto read = parse_subject(text);
    ASSERT_TRUE(read) << text;
    EXPECT_EQ(*read, subject) << text;
  }
}

TEST(SubjectsTest, NothingElseIsASubject) {
  for (const char* const text : {"",
                                 "dts",
                                 "dts.v1.",
                                 "dts.v1.kent",
                                 "dts.v1.kent.",
                                 "dts.v1..beat",
                                 "dts.v2.kent.beat",
                                 "dts.v1.kent.beat.x",
                                 "dts.v1.*.beat",
                                 "dts.v1.>",
                                 "dts.v1.Kent.beat",
                                 "dts.v1.ke nt.beat",
                                 "dts.v1.kent.up",
                                 "dts.v1.kent.up.a.b.chunk",
                                 "dts.v1.kent.up..chunk",
                                 "dts.v1.kent.up.a.chunk.",
                                 "dts.v1.kent.live.floor",
                                 "dts.v1.kent.live.floor.cop.x",
                                 "dts.v1.kent.live.floor.*",
                                 "dts.v1.kent.live..cop",
                                 "_INBOX.kent.beat",
                                 "dts.v1.aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa.beat"}) {
    EXPECT_FALSE(parse_subject(text)) << text;
  }
}

TEST(SubjectsTest, AReplyMustBeWithinTheInboxOfTheClinic) {
  EXPECT_TRUE(is_inbox_of("kent", "_INBOX.kent.abc"));
  EXPECT_TRUE(is_inbox_of("kent", "_INBOX.kent.abc.3"));
  for (const char* const reply :
       {"", "_INBOX.kent", "_INBOX.kent.", "_INBOX.kent2.abc", "_INBOX.essex.abc", "_INBOX.abc", "dts.v1.essex.down.live", "_HUB.abc",
        "_INBOX.kent.>", "_INBOX.kent.*", "_INBOX.kent.a b", "_INBOX.kent.a\r\nPUB x"}) {
    EXPECT_FALSE(is_inbox_of("kent", reply)) << reply;
  }
}

TEST(SubjectsTest, AClinicAnswersToDashboardsOnly) {
  EXPECT_TRUE(is_inbox_of_dashboard(dashboard_inbox_prefix("UA") + ".abc.3"));
  for (const char* const reply :
       {"", "_DASHBOARD", "_DASHBOARD.", "_DASHBOARD.>", "_DASHBOARD.UA.a b", "_INBOX.essex.abc", "_HUB.abc", "dts.v1.essex.facts"}) {
    EXPECT_FALSE(is_inbox_of_dashboard(reply)) << reply;
  }
}

TEST(SubjectsTest, AClinicMayOnlyUseItsOwnSubjects) {
  const Permissions kent = clinic_permissions("kent");
  EXPECT_EQ(kent.publish, (std::vector<std::string>{"dts.v1.kent.up.>", "dts.v1.kent.facts", "dts.v1.kent.erase", "dts.v1.kent.beat",
                                                    "dts.v1.kent.live.>"}));
  EXPECT_EQ(kent.subscribe, (std::vector<std::string>{"dts.v1.kent.down.>", "_INBOX.kent.>"}));
}

TEST(SubjectsTest, TheHubReceivesNoLiveData_AndAsksForNone) {
  const Permissions hub = hub_permissions();
  EXPECT_EQ(hub.publish, (std::vector<std::string>{"_INBOX.*.>"}));
  EXPECT_EQ(hub.subscribe, (std::vector<std::string>{"dts.v1.*.up.>", "dts.v1.*.facts", "dts.v1.*.erase", "dts.v1.*.beat", "_HUB.>"}));
}

TEST(SubjectsTest, ADashboardMayOnlyWatch) {
  const Permissions all = dashboard_permissions("UA", {});
  EXPECT_EQ(all.publish, (std::vector<std::string>{"dts.v1.*.down.live"}));
  EXPECT_EQ(all.subscribe, (std::vector<std::string>{"_DASHBOARD.UA.>", "dts.v1.*.live.>"}));
  EXPECT_FALSE(all.may_answer);
  const Permissions two = dashboard_permissions("UA", {"kent", "leeds"});
  EXPECT_EQ(two.publish, (std::vector<std::string>{"dts.v1.kent.down.live", "dts.v1.leeds.down.live"}));
  EXPECT_EQ(two.subscribe, (std::vector<std::string>{"_DASHBOARD.UA.>", "dts.v1.kent.live.>", "dts.v1.leeds.live.>"}));
}

TEST(SubjectsTest, TheHubSubscribesToTheSameSubjectOfAllClinics) {
  EXPECT_EQ(of_all_clinics(Matter::Open), "dts.v1.*.up.open");
  EXPECT_EQ(of_all_clinics(Matter::Chunk, "hub-1"), "dts.v1.*.up.hub-1.chunk");
  EXPECT_EQ(of_all_clinics(Matter::Live), "dts.v1.*.live.>");
}

}  // namespace
}  // namespace dts::fleet::wire
