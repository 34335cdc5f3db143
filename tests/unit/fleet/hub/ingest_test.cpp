// SPDX-License-Identifier: Apache-2.0
// With a real PostgreSQL.
#include "fleet/hub/ingest.h"

#include <sys/wait.h>

#include <filesystem>
#include <vector>

#include "fleet/wire/messages.h"
#include "unit/fleet/hub/hub_fixture.h"

namespace dts::fleet::hub {
namespace {

using database::Database;

namespace fs = std::filesystem;

constexpr std::int64_t kHourNs = 3600LL * core::kNanosecondsPerSecond;

/// A clock whose wall clock the test moves.
class MovedClock final : public core::Clock {
 public:
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return system_.now_ns() + moved_ns; }
  void sleep_until_ns(std::int64_t deadline_ns) noexcept override { system_.sleep_until_ns(deadline_ns - moved_ns); }
  [[nodiscard]] std::int64_t utc_minus_monotonic_ns() const noexcept override { return system_.utc_minus_monotonic_ns(); }

  std::int64_t moved_ns = 0;

 private:
  core::SystemClock system_;
};

class IngestTest : public DatabaseTest {
 protected:
  void SetUp() override {
    DatabaseTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    store_ = open_folder_store(folder_.path()).value();
    restart({.hub = "hub-1"});
  }
  void restart(IngestOptions options) {
    ingest_.reset();
    auto staging = Staging::open(folder_.path() + "/staging/hub-1");
    ASSERT_TRUE(staging) << core::to_string(staging.error());
    ingest_ = Ingest::create(std::move(options), *std::move(staging), *store_, clock_, log_).value();
  }
  static v1::UploadOffer offer_of(const std::string& bytes, const std::string& session = "s1") {
    v1::UploadOffer offer;
    offer.set_sha256(sum_of(bytes));
    offer.set_bytes(bytes.size());
    offer.set_session_id(session);
    offer.set_part(1);
    return offer;
  }
  v1::UploadAnswer open(const v1::UploadOffer& offer, const std::string& clinic = "kent") {
    return ingest_->open(clinic, offer, *catalogue_);
  }
  v1::UploadAnswer take(const std::string& whole, std::uint64_t offset, std::size_t count, const std::string& clinic = "kent") {
    v1::UploadChunk chunk;
    chunk.set_sha256(sum_of(whole));
    chunk.set_offset(offset);
    chunk.set_data(whole.substr(offset, count));
    return ingest_->take(clinic, chunk);
  }
  v1::UploadAnswer commit(const std::string& whole, const std::string& clinic = "kent") {
    v1::UploadCommit request;
    request.set_sha256(sum_of(whole));
    return ingest_->commit(clinic, request, *catalogue_, {});
  }
  void erase(const std::string& session) { ASSERT_TRUE(catalogue_->erase_session({"kent", session}, "clinic:kent", 1)); }
  /// Commits, but the database fails after the move into the store.
  void commit_without_row(const std::string& whole) {
    IngestOptions options{.hub = "hub-1"};
    options.reached = [this](std::string_view step) {
      if (step == "stored") static_cast<void>(database_->run_script("ALTER TABLE receipt RENAME TO away"));
    };
    restart(options);
    EXPECT_TRUE(commit(whole).has_later());
    EXPECT_TRUE(fs::exists(object(whole)));
    ASSERT_TRUE(database_->run_script("ALTER TABLE away RENAME TO receipt"));
  }
  [[nodiscard]] std::string object(const std::string& bytes, const std::string& clinic = "kent") const {
    return folder_.path() + "/" + key_of({clinic, sum_of(bytes)});
  }
  [[nodiscard]] std::size_t staged_files() const {
    std::size_t count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path() + "/staging")) {
      count += entry.is_regular_file() && entry.path().filename() != "lock" ? 1U : 0U;
    }
    return count;
  }

  test::TemporaryFolder folder_;
  MovedClock clock_;
  core::Log log_;
  std::unique_ptr<Store> store_;
  std::unique_ptr<Ingest> ingest_;
  const std::string bytes_ = std::string("XDF:") + std::string(1000, 'a') + std::string(1000, '\0') + "end";
};

TEST_F(IngestTest, AnUpload_EndsWithAReceipt) {
  const auto opened = open(offer_of(bytes_));
  EXPECT_EQ(opened.upload().worker(), "hub-1");
  EXPECT_EQ(opened.upload().have(), 0U);
  EXPECT_EQ(take(bytes_, 0, 1000).upload().have(), 1000U);
  EXPECT_EQ(commit(bytes_).upload().have(), 1000U);  // not whole
  EXPECT_EQ(take(bytes_, 1000, 2000).upload().have(), bytes_.size());
  const auto stored = commit(bytes_);
  ASSERT_TRUE(stored.has_stored()) << stored.ShortDebugString();
  EXPECT_EQ(stored.stored().clinic(), "kent");
  EXPECT_EQ(stored.stored().bytes(), bytes_.size());
  EXPECT_EQ(content_of(object(bytes_)), bytes_);
  EXPECT_EQ(staged_files(), 0U);
  EXPECT_EQ(value("SELECT count(*) FROM receipt"), "1");
  EXPECT_TRUE(wire::decode_upload_answer(stored.SerializeAsString()));
  // Every request again: the same receipt.
  EXPECT_EQ(commit(bytes_).stored().SerializeAsString(), stored.stored().SerializeAsString());
  EXPECT_EQ(open(offer_of(bytes_)).stored().SerializeAsString(), stored.stored().SerializeAsString());
}

TEST_F(IngestTest, Chunks_LateDoubledOrTooEarly_ChangeNothing) {
  open(offer_of(bytes_));
  EXPECT_EQ(take(bytes_, 500, 10).upload().have(), 0U);
  EXPECT_EQ(take(bytes_, 0, 600).upload().have(), 600U);
  EXPECT_EQ(take(bytes_, 0, 600).upload().have(), 600U);
  EXPECT_EQ(take(bytes_, 500, 600).upload().have(), 600U);
  EXPECT_EQ(take(bytes_, 600, 5000).upload().have(), bytes_.size());
  EXPECT_TRUE(commit(bytes_).has_stored());
}

TEST_F(IngestTest, Upload_ContinuesAfterARestart_WithoutANewOffer) {
  open(offer_of(bytes_));
  take(bytes_, 0, 1234);
  restart({.hub = "hub-1"});
  EXPECT_EQ(take(bytes_, 0, 10).upload().have(), 1234U);
  EXPECT_EQ(open(offer_of(bytes_)).upload().have(), 1234U);
  take(bytes_, 1234, 5000);
  EXPECT_TRUE(commit(bytes_).has_stored());
}

TEST_F(IngestTest, FileThatIsNotWhatWasOffered_StartsAgain) {
  open(offer_of(bytes_));
  auto torn = bytes_;
  torn[700] = 'b';
  v1::UploadChunk chunk;
  chunk.set_sha256(sum_of(bytes_));
  chunk.set_data(torn);
  EXPECT_EQ(ingest_->take("kent", chunk).upload().have(), bytes_.size());
  const auto answer = commit(bytes_);
  ASSERT_TRUE(answer.has_upload());
  EXPECT_EQ(answer.upload().have(), 0U);
  EXPECT_EQ(value("SELECT count(*) FROM receipt"), "0");
  EXPECT_FALSE(fs::exists(object(bytes_)));
  take(bytes_, 0, 5000);
  EXPECT_TRUE(commit(bytes_).has_stored());
}

TEST_F(IngestTest, UnknownFile_IsLater_SoThatTheClinicOffersItAgain) {
  EXPECT_TRUE(take(bytes_, 0, 10).has_later());
  EXPECT_TRUE(commit(bytes_).has_later());
}

TEST_F(IngestTest, MoreThanOffered_IsRejected) {
  auto offer = offer_of(bytes_);
  offer.set_bytes(100);
  open(offer);
  EXPECT_TRUE(take(bytes_, 0, 101).has_refusal());
  EXPECT_EQ(take(bytes_, 0, 100).upload().have(), 100U);
}

TEST_F(IngestTest, ClinicsWithTheSameFile_StayApart) {
  open(offer_of(bytes_), "kent");
  EXPECT_TRUE(take(bytes_, 0, 10, "leeds").has_later());
  take(bytes_, 0, 5000, "kent");
  EXPECT_TRUE(commit(bytes_, "leeds").has_later());
  EXPECT_TRUE(commit(bytes_, "kent").has_stored());
  EXPECT_TRUE(open(offer_of(bytes_), "leeds").has_upload());
}

TEST_F(IngestTest, FullDisk_AndSpentQuotas_AreLater) {
  restart({.hub = "hub-1", .full_at_percent = 0.0});
  EXPECT_EQ(open(offer_of(bytes_)).later().reason(), "the disk of the centre is full");
  restart({.hub = "hub-1", .bytes_a_day = 1500, .staged_bytes = 3000});
  EXPECT_TRUE(open(offer_of(bytes_)).has_upload());
  EXPECT_TRUE(open(offer_of(std::string(2500, 'x'))).has_later());    // both together are more than may be staged
  EXPECT_TRUE(open(offer_of(std::string(3001, 'x'))).has_refusal());  // never possible
  EXPECT_TRUE(open(offer_of(std::string(2500, 'x')), "leeds").has_upload());
  EXPECT_EQ(take(bytes_, 0, 1500).upload().have(), 1500U);
  EXPECT_TRUE(take(bytes_, 1500, 10).has_later());
  clock_.moved_ns = 24 * kHourNs;
  EXPECT_EQ(take(bytes_, 1500, 500).upload().have(), 2000U);
  EXPECT_EQ(ingest_->counts().later_total, 2U);
}

TEST_F(IngestTest, WithoutTheDatabase_CommitsAreLater_AndSucceedAfterwards) {
  open(offer_of(bytes_));
  take(bytes_, 0, 5000);
  Database nowhere({.connection = "host=/nonexistent", .name = "test"});
  Catalogue away(nowhere);
  v1::UploadCommit request;
  request.set_sha256(sum_of(bytes_));
  EXPECT_TRUE(ingest_->commit("kent", request, away, {}).has_later());
  EXPECT_TRUE(ingest_->open("kent", offer_of(bytes_), away).has_later());
  EXPECT_TRUE(commit(bytes_).has_stored());
}

TEST_F(IngestTest, RecordingInTheStoreWithoutARow_IsEnteredByTheNextCommit) {
  open(offer_of(bytes_));
  take(bytes_, 0, 5000);
  commit_without_row(bytes_);
  restart({.hub = "hub-1"});
  EXPECT_EQ(open(offer_of(bytes_)).upload().have(), bytes_.size());
  EXPECT_TRUE(commit(bytes_).has_stored());
  EXPECT_EQ(staged_files(), 0U);
}

TEST_F(IngestTest, DamagedRecordingInTheStore_IsReplaced) {
  fs::create_directories(folder_.path() + "/objects/kent");
  std::ofstream(object(bytes_)) << "damaged";
  EXPECT_EQ(open(offer_of(bytes_)).upload().have(), bytes_.size());
  EXPECT_EQ(commit(bytes_).upload().have(), 0U);
  take(bytes_, 0, 5000);
  EXPECT_TRUE(commit(bytes_).has_stored());
  EXPECT_EQ(content_of(object(bytes_)), bytes_);
}

TEST_F(IngestTest, ErasedSession_IsRejected_AlsoInTheMiddle) {
  open(offer_of(bytes_));
  take(bytes_, 0, 5000);
  erase("s1");
  EXPECT_TRUE(commit(bytes_).has_refusal());
  EXPECT_FALSE(fs::exists(object(bytes_)));
  EXPECT_TRUE(open(offer_of(bytes_)).has_refusal());
  open(offer_of("other", "s2"));
  take("other", 0, 2);
  ASSERT_TRUE(ingest_->drop_session({"kent", "s2"}, *catalogue_));
  EXPECT_EQ(staged_files(), 0U);
}

TEST_F(IngestTest, SessionErasedByWayOfAnotherHub_IsDropped) {
  open(offer_of(bytes_, "s1"));
  open(offer_of("other", "s2"));
  erase("s1");
  ASSERT_TRUE(ingest_->clean(*catalogue_));
  EXPECT_TRUE(take(bytes_, 0, 10).has_later());
  EXPECT_TRUE(take("other", 0, 2).has_upload());
  EXPECT_EQ(staged_files(), 2U);
}

TEST_F(IngestTest, AbandonedUploads_AreRemovedAfterAWeek) {
  open(offer_of(bytes_));
  take(bytes_, 0, 100);
  clock_.moved_ns = 167 * kHourNs;
  ASSERT_TRUE(ingest_->clean(*catalogue_));
  EXPECT_EQ(staged_files(), 2U);
  clock_.moved_ns = 169 * kHourNs;
  ASSERT_TRUE(ingest_->clean(*catalogue_));
  EXPECT_EQ(staged_files(), 0U);
  EXPECT_TRUE(take(bytes_, 100, 100).has_later());
}

TEST_F(IngestTest, RecordingInTheStoreWithoutARow_GoesWithItsErasedSession) {
  for (const bool is_restarted : {false, true}) {
    const std::string bytes = bytes_ + (is_restarted ? "1" : "0");
    const std::string session = is_restarted ? "s1" : "s0";
    open(offer_of(bytes, session));
    take(bytes, 0, 5000);
    commit_without_row(bytes);
    if (is_restarted) restart({.hub = "hub-1"});
    erase(session);
    ASSERT_TRUE(ingest_->clean(*catalogue_));
    EXPECT_FALSE(fs::exists(object(bytes)));
    EXPECT_EQ(staged_files(), 0U);
  }
}

TEST_F(IngestTest, RecordingInTheStoreWithoutARow_GoesWithItsAbandonedUpload_ButNotWithAReceipt) {
  const std::string other = bytes_ + "other";
  for (const std::string& bytes : {bytes_, other}) {
    open(offer_of(bytes, bytes == other ? "s2" : "s1"));
    take(bytes, 0, 5000);
    commit_without_row(bytes);
  }
  // Another hub has entered one of them.
  ASSERT_TRUE(catalogue_->put_recording({"kent", sum_of(other)}, offer_of(other, "s2"), *store_, "hub-2", 1));
  clock_.moved_ns = 169 * kHourNs;
  ASSERT_TRUE(ingest_->clean(*catalogue_));
  EXPECT_FALSE(fs::exists(object(bytes_)));
  EXPECT_TRUE(fs::exists(object(other)));
  EXPECT_EQ(staged_files(), 0U);
}

TEST_F(IngestTest, UploadThatAnotherHubHasFinished_DoesNotCountAgainstTheQuota) {
  restart({.hub = "hub-1", .staged_bytes = 3000});
  const auto second =
      Ingest::create({.hub = "hub-2"}, Staging::open(folder_.path() + "/staging/hub-2").value(), *store_, clock_, log_).value();
  open(offer_of(bytes_));
  take(bytes_, 0, 100);
  ASSERT_TRUE(second->open("kent", offer_of(bytes_), *catalogue_).has_upload());
  v1::UploadChunk chunk;
  chunk.set_sha256(sum_of(bytes_));
  chunk.set_data(bytes_);
  ASSERT_TRUE(second->take("kent", chunk).has_upload());
  v1::UploadCommit request;
  request.set_sha256(sum_of(bytes_));
  ASSERT_TRUE(second->commit("kent", request, *catalogue_, {}).has_stored());
  EXPECT_TRUE(open(offer_of(std::string(2500, 'x'), "s2")).has_later());
  ASSERT_TRUE(ingest_->clean(*catalogue_));
  EXPECT_TRUE(open(offer_of(std::string(2500, 'x'), "s2")).has_upload());
  EXPECT_TRUE(fs::exists(object(bytes_)));
}

TEST_F(IngestTest, ClinicWhoseFilesAreNotWhatWasOffered_WaitsForItsCommits) {
  const auto fail = [&](int number, const std::string& clinic) {
    const std::string offered = std::to_string(number);
    open(offer_of(offered), clinic);
    v1::UploadChunk chunk;
    chunk.set_sha256(sum_of(offered));
    chunk.set_data(std::string(offered.size(), 'x'));
    EXPECT_TRUE(ingest_->take(clinic, chunk).has_upload());
    return commit(offered, clinic);
  };
  for (int number = 0; number < 10; ++number) EXPECT_TRUE(fail(number, "kent").has_upload());
  EXPECT_TRUE(fail(10, "kent").has_later());
  EXPECT_TRUE(fail(10, "leeds").has_upload());
  clock_.moved_ns = 61 * core::kNanosecondsPerSecond;
  EXPECT_TRUE(commit("10").has_upload());
  EXPECT_EQ(ingest_->counts().torn_total, 12U);
}

TEST_F(IngestTest, ClinicWhoseCommitsNeedMuchTime_LetsOthersGoFirst) {
  IngestOptions options{.hub = "hub-1"};
  options.reached = [this](std::string_view step) {
    if (step == "verified") clock_.moved_ns += 40 * core::kNanosecondsPerSecond;
  };
  restart(options);
  const auto put = [&](const std::string& bytes, const std::string& clinic) {
    open(offer_of(bytes, "session-" + bytes), clinic);
    take(bytes, 0, 5000, clinic);
    return commit(bytes, clinic);
  };
  EXPECT_TRUE(put("first", "kent").has_stored());
  EXPECT_EQ(put("second", "kent").later().wait_s(), 2U);
  clock_.moved_ns += 25 * core::kNanosecondsPerSecond;  // 10 s were too much, and one more must be left
  EXPECT_TRUE(put("second", "kent").has_stored());
  EXPECT_TRUE(put("third", "kent").has_later());
  EXPECT_TRUE(put("third", "leeds").has_stored());
}

TEST_F(IngestTest, MoreRecordingsThanTheQuota_AreRejectedBeforeTheyAreSent) {
  QuotaFigures quota;
  quota.recordings = 1;
  Catalogue limited(*database_, quota);
  open(offer_of(bytes_));
  take(bytes_, 0, 5000);
  ASSERT_TRUE(commit(bytes_).has_stored());
  EXPECT_NE(ingest_->open("kent", offer_of("other", "s2"), limited).refusal().reason().find("1 recordings"), std::string::npos);
  EXPECT_TRUE(ingest_->open("kent", offer_of(bytes_), limited).has_stored());
  EXPECT_TRUE(ingest_->open("leeds", offer_of("other", "s2"), limited).has_upload());
}

TEST_F(IngestTest, ACommit_DoesNotStopOtherUploads) {
  IngestOptions options{.hub = "hub-1"};
  std::vector<std::uint64_t> have;
  options.reached = [&](std::string_view /*step*/) {
    have.push_back(take("other", have.size(), 1, "leeds").upload().have());
    EXPECT_EQ(take(bytes_, 0, 10).upload().have(), bytes_.size());  // the file that is being committed does not change
    EXPECT_EQ(open(offer_of(bytes_)).upload().have() % bytes_.size(), 0U);
  };
  restart(options);
  open(offer_of("other", "s2"), "leeds");
  open(offer_of(bytes_));
  take(bytes_, 0, 5000);
  EXPECT_TRUE(commit(bytes_).has_stored());
  EXPECT_EQ(have, (std::vector<std::uint64_t>{1, 2, 3, 4}));
}

TEST_F(IngestTest, StopDuringACommit_IsLater_AndNothingIsLost) {
  open(offer_of(bytes_));
  take(bytes_, 0, 5000);
  std::stop_source stop;
  stop.request_stop();
  v1::UploadCommit request;
  request.set_sha256(sum_of(bytes_));
  EXPECT_TRUE(ingest_->commit("kent", request, *catalogue_, stop.get_token()).has_later());
  EXPECT_TRUE(commit(bytes_).has_stored());
}

TEST_F(IngestTest, SecondHubWithTheSameName_IsRejected) {
  const auto second = Staging::open(folder_.path() + "/staging/hub-1");
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, core::ErrorCode::WrongState);
}

TEST_F(IngestTest, TwoHubsWithTheSameFile_MakeOneReceipt) {
  const auto second =
      Ingest::create({.hub = "hub-2"}, Staging::open(folder_.path() + "/staging/hub-2").value(), *store_, clock_, log_).value();
  open(offer_of(bytes_));
  take(bytes_, 0, 5000);
  EXPECT_EQ(second->open("kent", offer_of(bytes_), *catalogue_).upload().worker(), "hub-2");
  v1::UploadChunk chunk;
  chunk.set_sha256(sum_of(bytes_));
  chunk.set_data(bytes_);
  EXPECT_EQ(second->take("kent", chunk).upload().have(), bytes_.size());
  EXPECT_EQ(commit(bytes_).stored().hub(), "hub-1");
  v1::UploadCommit request;
  request.set_sha256(sum_of(bytes_));
  EXPECT_EQ(second->commit("kent", request, *catalogue_, {}).stored().hub(), "hub-1");
  EXPECT_EQ(staged_files(), 0U);
  EXPECT_EQ(value("SELECT count(*) FROM receipt"), "1");
}

/// Kills a process after one step of a commit: at every step, there is no receipt without its recording, and the next commit succeeds.
TEST_F(IngestTest, KilledAtAnyStep_NoReceiptWithoutItsRecording) {
  RecordProperty("requirement", "FLEET-1");
  for (const std::string last : {"synchronised", "verified", "stored", "entered", "none"}) {
    const std::string bytes = bytes_ + last;
    const std::string session = "session-" + last;
    open(offer_of(bytes, session));
    take(bytes, 0, 5000);
    ingest_.reset();
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      IngestOptions options{.hub = "hub-1"};
      options.reached = [&](std::string_view step) {
        if (step == last) ::_exit(9);
      };
      auto staging = Staging::open(folder_.path() + "/staging/hub-1");
      const auto ingest = Ingest::create(options, *std::move(staging), *store_, clock_, log_);
      const auto database = open_database();
      Catalogue catalogue(*database);
      v1::UploadCommit request;
      request.set_sha256(sum_of(bytes));
      static_cast<void>((*ingest)->commit("kent", request, catalogue, {}));
      ::_exit(0);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_EQ(WEXITSTATUS(status), last == "none" ? 0 : 9) << last;
    const auto receipt = catalogue_->find_receipt({"kent", sum_of(bytes)});
    ASSERT_TRUE(receipt);
    EXPECT_EQ(receipt->has_value(), last == "entered" || last == "none") << last;
    EXPECT_TRUE(!*receipt || content_of(object(bytes)) == bytes) << last;
    restart({.hub = "hub-1"});
    EXPECT_TRUE(commit(bytes).has_stored()) << last;
    EXPECT_EQ(content_of(object(bytes)), bytes) << last;
  }
  EXPECT_EQ(staged_files(), 0U);
  EXPECT_EQ(value("SELECT count(*) FROM receipt"), "5");
}

TEST_F(IngestTest, DamagedStaging_IsRemovedAtTheStart) {
  open(offer_of(bytes_));
  take(bytes_, 0, 100);
  ingest_.reset();
  const std::string folder = folder_.path() + "/staging/hub-1/kent/";
  const std::string name = wire::hex_of(sum_of(bytes_));
  fs::resize_file(folder + name + ".offer", 3);
  std::ofstream(folder + "nobody.part") << "x";
  restart({.hub = "hub-1"});
  EXPECT_EQ(staged_files(), 0U);
  EXPECT_TRUE(take(bytes_, 100, 10).has_later());
}

}  // namespace
}  // namespace dts::fleet::hub
