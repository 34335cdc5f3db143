// SPDX-License-Identifier: Apache-2.0
// One upload as a sequence of steps, answers and times.
#include "fleet/forward/transfer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fleet/wire/messages.h"

namespace dts::fleet::forward {
namespace {

using Kind = Transfer::Step::Kind;

constexpr std::uint64_t kChunk = wire::kLargestChunk;

class TransferTest : public testing::Test {
 protected:
  static v1::UploadAnswer upload(std::uint64_t have, const std::string& worker = "hub-1") {
    v1::UploadAnswer answer;
    answer.mutable_upload()->set_worker(worker);
    answer.mutable_upload()->set_have(have);
    return answer;
  }
  v1::UploadAnswer stored() const {
    v1::UploadAnswer answer;
    answer.mutable_stored()->set_clinic("kent");
    answer.mutable_stored()->set_sha256(sha256_);
    answer.mutable_stored()->set_bytes(bytes_);
    return answer;
  }
  /// Chunks that the transfer sends now, as offsets.
  std::vector<std::uint64_t> chunks() {
    std::vector<std::uint64_t> offsets;
    for (auto step = transfer_.next(now_); step.kind == Kind::Chunk; step = transfer_.next(now_)) offsets.push_back(step.offset);
    return offsets;
  }
  void open(std::uint64_t have = 0) {
    ASSERT_EQ(transfer_.next(now_).kind, Kind::Open);
    transfer_.handle(upload(have), now_);
  }

  std::string sha256_ = std::string(32, 's');
  std::uint64_t bytes_ = 100 * kChunk + 5;
  Transfer transfer_{"kent", sha256_, bytes_, 1};
  Transfer::Time now_ = Transfer::Time(std::chrono::seconds(1000));
};

TEST_F(TransferTest, HubThatAnswers_GetsEveryByteOnceThenTheCommit) {
  open();
  std::uint64_t expected = 0;
  for (auto step = transfer_.next(now_); step.kind != Kind::Commit; step = transfer_.next(now_)) {
    if (step.kind == Kind::Chunk) {
      EXPECT_EQ(step.offset, expected);
      EXPECT_EQ(step.worker, "hub-1");
      EXPECT_LE(step.count, kChunk);
      expected += step.count;
      continue;
    }
    ASSERT_EQ(step.kind, Kind::Wait);
    transfer_.handle(upload(expected), now_);
  }
  EXPECT_EQ(expected, bytes_);
  EXPECT_FALSE(transfer_.end());
  transfer_.handle(stored(), now_);
  ASSERT_TRUE(transfer_.end());
  EXPECT_TRUE(transfer_.end()->receipt);
  EXPECT_EQ(transfer_.next(now_).kind, Kind::Ended);
  EXPECT_EQ(transfer_.tries(), 1U);
}

TEST_F(TransferTest, HubThatHasTheFile_AnswersAtOnce) {
  ASSERT_EQ(transfer_.next(now_).kind, Kind::Open);
  transfer_.handle(stored(), now_);
  EXPECT_TRUE(transfer_.end()->receipt);
  EXPECT_EQ(transfer_.have(), bytes_);
}

TEST_F(TransferTest, HubThatHasAPart_GetsTheRest) {
  open(7 * kChunk);
  EXPECT_THAT(chunks(), testing::ElementsAre(7 * kChunk));
}

TEST_F(TransferTest, Window_GrowsWithAnswersTo16Chunks) {
  open();
  EXPECT_EQ(chunks().size(), 1U);
  std::uint64_t have = 0;
  for (int answers = 0; answers < 40; ++answers) {
    transfer_.handle(upload(have += kChunk), now_);
    (void)chunks();
  }
  EXPECT_THAT(chunks(), testing::IsEmpty());
  transfer_.handle(upload(have += kChunk), now_);
  EXPECT_THAT(chunks(), testing::ElementsAre(have + 15 * kChunk));
}

TEST_F(TransferTest, LostChunk_GoesBackOnce) {
  open();
  (void)chunks();
  for (std::uint64_t have = 1; have <= 4; ++have) {
    transfer_.handle(upload(have * kChunk), now_);
    (void)chunks();
  }
  transfer_.handle(upload(4 * kChunk), now_);  // of the chunk after the lost one
  EXPECT_EQ(chunks().front(), 4 * kChunk);
  transfer_.handle(upload(4 * kChunk), now_);  // of further ones that were under way
  EXPECT_THAT(chunks(), testing::IsEmpty());
  transfer_.handle(upload(5 * kChunk), now_);
  EXPECT_FALSE(chunks().empty());
}

TEST_F(TransferTest, ChunksThatArriveTwice_AreNotSentAThirdTime) {
  open();
  (void)chunks();
  std::uint64_t have = 0;
  for (int answers = 0; answers < 20; ++answers) {
    transfer_.handle(upload(have += kChunk), now_);
    (void)chunks();
  }
  transfer_.restart();
  ASSERT_EQ(transfer_.next(now_).kind, Kind::Open);
  transfer_.handle(upload(have), now_);  // answered before the chunks that are under way
  std::size_t sent = chunks().size();
  EXPECT_EQ(sent, 16U);
  have += 16 * kChunk;  // they arrive: all that are sent now arrive for the second time
  for (int answers = 0; answers < 16; ++answers) {
    transfer_.handle(upload(have), now_);
    sent += chunks().size();
  }
  EXPECT_EQ(sent, 32U) << "the next 16, once";
}

TEST_F(TransferTest, RetryWhileBytesMove_ChangesNothing) {
  open();
  EXPECT_THAT(chunks(), testing::ElementsAre(0));
  transfer_.retry();
  transfer_.handle(upload(kChunk), now_);
  EXPECT_THAT(chunks(), testing::ElementsAre(kChunk, 2 * kChunk));
  EXPECT_EQ(transfer_.tries(), 1U);
}

TEST_F(TransferTest, HubThatLostWhatItHad_GetsItAgain) {
  open(50 * kChunk);
  (void)chunks();
  transfer_.handle(upload(10 * kChunk), now_);
  EXPECT_EQ(transfer_.have(), 10 * kChunk);
  EXPECT_EQ(chunks().front(), 10 * kChunk);
}

TEST_F(TransferTest, Silence_OpensAgainAfterAPauseWithSmallerChunks) {
  open();
  (void)chunks();
  now_ += std::chrono::milliseconds(4999);
  EXPECT_EQ(transfer_.next(now_).kind, Kind::Wait);
  now_ += std::chrono::milliseconds(1);
  const auto step = transfer_.next(now_);
  EXPECT_EQ(step.kind, Kind::Wait);
  EXPECT_GE(step.until, now_ + std::chrono::milliseconds(500));
  EXPECT_LE(step.until, now_ + std::chrono::milliseconds(1000));
  EXPECT_EQ(transfer_.problem(), "the centre does not answer");
  now_ = step.until;
  EXPECT_EQ(transfer_.next(now_).kind, Kind::Open);
  transfer_.handle(upload(0), now_);
  EXPECT_EQ(transfer_.next(now_).count, kChunk / 2);
}

TEST_F(TransferTest, NothingUnderWayBecauseOfTheLimit_IsNoSilence) {
  open();
  EXPECT_EQ(transfer_.next(now_, false).kind, Kind::Wait);
  now_ += std::chrono::seconds(30);
  EXPECT_EQ(transfer_.next(now_, false).kind, Kind::Wait);
  EXPECT_EQ(transfer_.next(now_, true).kind, Kind::Chunk);
  EXPECT_EQ(transfer_.problem(), "");
}

TEST_F(TransferTest, NewConnection_OpensAtOnce) {
  open();
  (void)chunks();
  transfer_.restart();
  EXPECT_EQ(transfer_.next(now_).kind, Kind::Open);
  EXPECT_EQ(transfer_.tries(), 2U);
}

TEST_F(TransferTest, Later_WaitsAsLongAsTheHubWants) {
  ASSERT_EQ(transfer_.next(now_).kind, Kind::Open);
  v1::UploadAnswer later;
  later.mutable_later()->set_reason("the disk of the centre is full");
  later.mutable_later()->set_wait_s(60);
  transfer_.handle(later, now_);
  EXPECT_THAT(transfer_.problem(), testing::HasSubstr("the disk of the centre is full"));
  EXPECT_EQ(transfer_.next(now_ + std::chrono::seconds(59)).kind, Kind::Wait);
  EXPECT_EQ(transfer_.next(now_ + std::chrono::seconds(60)).kind, Kind::Open);
}

TEST_F(TransferTest, Refusal_EndsWithItsReason) {
  ASSERT_EQ(transfer_.next(now_).kind, Kind::Open);
  v1::UploadAnswer refusal;
  refusal.mutable_refusal()->set_reason("unknown session");
  transfer_.handle(refusal, now_);
  EXPECT_EQ(transfer_.end()->refusal, "unknown session");
  EXPECT_FALSE(transfer_.end()->receipt);
}

TEST_F(TransferTest, ReceiptForSomethingElse_IsNoReceipt) {
  for (const char* wrong : {"clinic", "sha256", "bytes"}) {
    Transfer transfer("kent", sha256_, bytes_, 1);
    (void)transfer.next(now_);
    auto answer = stored();
    if (wrong == std::string("clinic")) answer.mutable_stored()->set_clinic("lund");
    if (wrong == std::string("sha256")) answer.mutable_stored()->set_sha256(std::string(32, 'x'));
    if (wrong == std::string("bytes")) answer.mutable_stored()->set_bytes(bytes_ - 1);
    transfer.handle(answer, now_);
    EXPECT_FALSE(transfer.end()) << wrong;
  }
}

TEST_F(TransferTest, CommitOfDamagedBytes_StartsAgainAfterAPause) {
  open(bytes_);
  ASSERT_EQ(transfer_.next(now_).kind, Kind::Commit);
  transfer_.handle(upload(0), now_);
  const auto step = transfer_.next(now_);
  ASSERT_EQ(step.kind, Kind::Wait);
  EXPECT_GT(step.until, now_);
  now_ = step.until;
  open();
  EXPECT_THAT(chunks(), testing::ElementsAre(0));
}

TEST_F(TransferTest, BytesThatAreDamagedTwice_EndTheUpload) {
  open(bytes_);
  ASSERT_EQ(transfer_.next(now_).kind, Kind::Commit);
  transfer_.handle(upload(0), now_);
  now_ = transfer_.next(now_).until;
  open(bytes_);
  ASSERT_EQ(transfer_.next(now_).kind, Kind::Commit);
  transfer_.handle(upload(0), now_);
  ASSERT_TRUE(transfer_.end());
  EXPECT_TRUE(transfer_.end()->is_damaged);
  EXPECT_FALSE(transfer_.end()->receipt);
}

TEST_F(TransferTest, CommitOfALargeFile_GetsTimeForReadingIt) {
  bytes_ = 1'000'000'000;
  Transfer large("kent", sha256_, bytes_, 1);
  ASSERT_EQ(large.next(now_).kind, Kind::Open);
  large.handle(upload(bytes_), now_);
  ASSERT_EQ(large.next(now_).kind, Kind::Commit);
  EXPECT_EQ(large.next(now_ + std::chrono::seconds(54)).until, now_ + std::chrono::seconds(55));
  EXPECT_EQ(large.problem(), "");
  (void)large.next(now_ + std::chrono::seconds(55));
  EXPECT_EQ(large.problem(), "the centre does not answer");
}

TEST_F(TransferTest, MoreBytesThanTheFileHas_AreNotBelieved) {
  ASSERT_EQ(transfer_.next(now_).kind, Kind::Open);
  transfer_.handle(upload(bytes_ + 1), now_);
  EXPECT_EQ(transfer_.next(now_).kind, Kind::Wait);
  EXPECT_EQ(transfer_.have(), 0U);
}

TEST(Backoff, Failures_DoubleThePauseUpTo5Minutes) {
  Backoff backoff(7);
  std::chrono::milliseconds largest(1000);
  for (int failure = 0; failure < 20; ++failure) {
    const std::chrono::milliseconds pause = backoff.next();
    EXPECT_LE(pause, largest);
    EXPECT_GE(pause, largest / 2);
    largest = std::min(largest * 2, std::chrono::milliseconds(300'000));
  }
  backoff.reset();
  EXPECT_LE(backoff.next(), std::chrono::milliseconds(1000));
}

}  // namespace
}  // namespace dts::fleet::forward
