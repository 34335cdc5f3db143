// SPDX-License-Identifier: Apache-2.0
#include "ipc/encode_session.h"

#include <gtest/gtest.h>

#include "ipc/command_handler.h"

namespace dts::ipc {
namespace {

constexpr const char* kCut = "Stromausf\xC3";  // in the middle of a character, as a limit of bytes cuts it

/// What a client understands of an answer.
dts::v1::Response received(const dts::v1::Response& sent) {
  dts::v1::Response response;
  EXPECT_TRUE(response.ParseFromString(sent.SerializeAsString()));
  return response;
}

TEST(EncodeSession, TextsThatAreNoUtf8_LeaveTheAnswerReadable) {
  record::SessionRow row{
      .id = "s1", .rig = "floor", .protocol = "free", .subject = kCut, .label = kCut, .state = "aborted", .message = kCut};
  row.parts.emplace_back();
  row.parts.back().file = std::string("/state/\xFF") + "/s1.xdf";
  row.parts.back().reason = kCut;
  row.trials.emplace_back();
  row.trials.back().condition = kCut;
  dts::v1::Response response;
  *response.mutable_session_record() = session_record(row);

  const dts::v1::Response seen = received(response);

  EXPECT_EQ(seen.session_record().message(), "Stromausf\xEF\xBF\xBD");
  EXPECT_EQ(seen.session_record().parts_size(), 1);
}

TEST(EncodeSession, StateAndTrials_AreThoseThatEveryClientShows) {
  record::SessionRow row{.id = "s1", .state = "complete"};
  row.parts = {{.state = record::PartState::Recovered, .valid_trials = 1},
               {.part = 2, .state = record::PartState::Complete, .valid_trials = 2}};

  const dts::v1::SessionRecord out = session_record(row, 4);

  EXPECT_EQ(out.state(), "recovered");
  EXPECT_EQ(out.planned_trials(), 4U);
  EXPECT_EQ(out.parts(0).valid_trials(), 1U);
  EXPECT_EQ(out.parts(1).valid_trials(), 2U);
}

TEST(EncodeSession, LossesThatNobodyKnows_AreNotNone) {
  record::SessionRow row{.id = "s1", .state = "complete"};
  row.parts = {{.state = record::PartState::Complete},
               {.part = 2, .state = record::PartState::Complete, .losses = core::Losses()},
               {.part = 3, .state = record::PartState::Recording}};

  const dts::v1::SessionRecord out = session_record(row, 0);

  EXPECT_TRUE(out.parts(0).is_loss_unknown());
  EXPECT_FALSE(out.parts(1).is_loss_unknown());
  EXPECT_FALSE(out.parts(2).is_loss_unknown()) << "it is not over yet";
}

TEST(EncodeSession, TrialThatAGapDivides_HasBothItsSegments) {
  record::SessionRow row{.id = "s1", .state = "complete"};
  row.trials = {{.trial = 1, .segment = 2, .first_scan = 812, .last_scan = 212, .last_segment = 3}};

  const dts::v1::SessionRecord out = session_record(row, 0);

  EXPECT_EQ(out.trials(0).segment(), 2U);
  EXPECT_EQ(out.trials(0).last_segment(), 3U);
}

TEST(EncodeSession, ErrorThatQuotesACutText_StaysReadable) {
  const dts::v1::Response seen = received(error_response({core::ErrorCode::InvalidArgument, kCut, kCut}));

  EXPECT_EQ(seen.error().code(), static_cast<int>(core::ErrorCode::InvalidArgument));
}

}  // namespace
}  // namespace dts::ipc
