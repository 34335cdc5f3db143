// SPDX-License-Identifier: Apache-2.0
// With a real PostgreSQL, and a small S3 that checks signatures.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <thread>

#include "fleet/hub/rebuild.h"
#include "fleet/wire/messages.h"
#include "support/s3_server.h"
#include "unit/fleet/hub/hub_fixture.h"

namespace dts::fleet::hub {
namespace {

namespace fs = std::filesystem;

class S3StoreTest : public DatabaseTest {
 protected:
  void SetUp() override {
    DatabaseTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    store_ = new_store();
    restart();
  }
  [[nodiscard]] std::unique_ptr<Store> new_store() const {
    auto store = open_s3_store(folder_.path(), server_.settings());
    EXPECT_TRUE(store) << core::to_string(store.error());
    return *std::move(store);
  }
  void restart() {
    ingest_.reset();
    ingest_ = Ingest::create({.hub = "hub-1"}, Staging::open(staging()).value(), *store_, clock_, log_).value();
  }
  [[nodiscard]] std::string staging() const { return folder_.path() + "/staging/hub-1"; }
  v1::UploadAnswer send(const std::string& bytes, const std::string& session) {
    v1::UploadOffer offer;
    offer.set_sha256(sum_of(bytes));
    offer.set_bytes(bytes.size());
    offer.set_session_id(session);
    offer.set_part(1);
    static_cast<void>(ingest_->open("kent", offer, *catalogue_));
    v1::UploadChunk chunk;
    chunk.set_sha256(sum_of(bytes));
    chunk.set_data(bytes);
    return ingest_->take("kent", chunk);
  }
  v1::UploadAnswer commit(const std::string& bytes) { return commit_with(*ingest_, *catalogue_, bytes); }
  static v1::UploadAnswer commit_with(Ingest& ingest, Catalogue& catalogue, const std::string& bytes) {
    v1::UploadCommit request;
    request.set_sha256(sum_of(bytes));
    return ingest.commit("kent", request, catalogue, {});
  }
  [[nodiscard]] std::string object(const std::string& bytes) const { return server_.object(key_of(name(bytes))).string(); }
  [[nodiscard]] static RecordingName name(const std::string& bytes) { return {.clinic = "kent", .sha256 = sum_of(bytes)}; }
  [[nodiscard]] bool has_receipt(const std::string& bytes) { return catalogue_->find_receipt(name(bytes)).value().has_value(); }
  /// Commits in another process, which ends itself after this step.
  void commit_and_end(Store& store, const std::string& bytes, std::string_view last) {
    IngestOptions options{.hub = "hub-1"};
    options.reached = [last](std::string_view step) {
      if (step == last) ::_exit(9);
    };
    const auto ingest = Ingest::create(options, Staging::open(staging()).value(), store, clock_, log_);
    const auto database = open_database();
    Catalogue catalogue(*database);
    static_cast<void>(commit_with(**ingest, catalogue, bytes));
    ::_exit(0);
  }

  test::TemporaryFolder folder_;
  test::S3Server server_;
  core::SystemClock clock_;
  core::Log log_ = core::Log::to_stderr(core::LogLevel::Error);
  std::unique_ptr<Store> store_;
  std::unique_ptr<Ingest> ingest_;
};

TEST_F(S3StoreTest, ARecording_IsStored_Found_Listed_AndRemoved) {
  send("abc", "s1");
  ASSERT_TRUE(commit("abc").has_stored());
  EXPECT_EQ(content_of(object("abc")), "abc");
  EXPECT_EQ(value("SELECT store_key FROM part"), key_of(name("abc")));
  EXPECT_EQ(store_->has(name("abc")), true);
  EXPECT_EQ(store_->list().value(), std::vector{name("abc")});
  std::string copy;
  {
    const auto file = store_->file(name("abc")).value();
    ASSERT_TRUE(file);
    copy = file->path();
    EXPECT_EQ(content_of(copy), "abc");
  }
  EXPECT_FALSE(fs::exists(copy));
  EXPECT_FALSE(fs::exists(staging() + "/kent/" + wire::hex_of(sum_of("abc")) + ".part"));
  EXPECT_EQ(store_->remove(name("abc")), true);
  EXPECT_EQ(store_->remove(name("abc")), false);
  EXPECT_FALSE(store_->file(name("abc")).value());
}

TEST_F(S3StoreTest, List_ReadsAllPages_AndIgnoresWhatIsNoRecording) {
  for (const std::string bytes : {"a", "b", "c", "d", "e"}) {
    send(bytes, "s-" + bytes);
    ASSERT_TRUE(commit(bytes).has_stored());
  }
  fs::copy_file(object("a"), server_.object("objects/kent/notes"));
  fs::copy_file(object("a"), server_.object("objects/Not a clinic/" + wire::hex_of(sum_of("a"))));
  server_.set_fault("GET small-pages");
  EXPECT_EQ(store_->list().value().size(), 5U);
}

TEST_F(S3StoreTest, AFailureOfS3_IsAnsweredWithLater_AndCostsNothing) {
  send("abc", "s1");
  for (const char* const fault : {"PUT 403", "PUT 500", "PUT lost", "PUT etag", "PUT truncated", "HEAD 500", "HEAD size", "* 404"}) {
    server_.set_fault(fault);
    const auto answer = commit("abc");
    EXPECT_TRUE(answer.has_later()) << fault << ": " << answer.ShortDebugString();
    EXPECT_EQ(value("SELECT count(*) FROM receipt"), "0") << fault;
    server_.set_fault("");
    fs::remove(object("abc"));
  }
  EXPECT_TRUE(commit("abc").has_stored());  // what was staged is still there
  EXPECT_EQ(content_of(object("abc")), "abc");
}

TEST_F(S3StoreTest, AnObjectThatIsLost_GetsNoReceipt) {
  send("abc", "s1");
  server_.set_fault("PUT lost");
  EXPECT_TRUE(commit("abc").has_later());
  EXPECT_FALSE(has_receipt("abc"));
}

TEST_F(S3StoreTest, AnObjectWithoutRow_IsReadAndChecked) {
  send("abc", "s1");
  std::ofstream(object("abc")) << "abd";  // for example of another hub, damaged since
  fs::remove(staging() + "/kent/" + wire::hex_of(sum_of("abc")) + ".part");
  restart();
  EXPECT_FALSE(commit("abc").has_stored());
  EXPECT_FALSE(has_receipt("abc"));
  send("abc", "s1");
  EXPECT_TRUE(commit("abc").has_stored());
  EXPECT_EQ(content_of(object("abc")), "abc");
}

TEST_F(S3StoreTest, AProblemOfTheDisk_RemovesNoObject) {
  send("abc", "s1");
  ASSERT_TRUE(store_->put(name("abc"), staging() + "/kent/" + wire::hex_of(sum_of("abc")) + ".part"));
  restart();  // the object has no row: it is received and checked
  fs::remove(folder_.path() + "/fetched");
  for (const bool is_file : {false, true}) {
    if (is_file) std::ofstream(folder_.path() + "/fetched") << "";
    const auto answer = commit("abc");
    EXPECT_TRUE(answer.has_later()) << answer.ShortDebugString();
    EXPECT_EQ(content_of(object("abc")), "abc");
    const auto rebuilt = rebuild(*store_, *catalogue_, "hub-1", 1);
    ASSERT_TRUE(rebuilt) << core::to_string(rebuilt.error());
    ASSERT_EQ(rebuilt->left.size(), 1U);
    EXPECT_NE(rebuilt->left.front().find(key_of(name("abc")) + ": cannot create"), std::string::npos) << rebuilt->left.front();
  }
  fs::remove(folder_.path() + "/fetched");
  fs::create_directory(folder_.path() + "/fetched");
  EXPECT_TRUE(commit("abc").has_stored());
  server_.set_fault("GET 500");
  fs::copy_file(object("abc"), server_.object(key_of(name("other"))));
  EXPECT_EQ(rebuild(*store_, *catalogue_, "hub-1", 1).error().code, core::ErrorCode::Unreachable);
}

TEST_F(S3StoreTest, WhileS3IsAway_TheHubStarts) {
  send("abc", "s1");
  fs::remove(staging() + "/kent/" + wire::hex_of(sum_of("abc")) + ".part");
  server_.set_fault("* 500");
  store_ = new_store();
  restart();
  EXPECT_TRUE(send("abc", "s1").has_later());
  server_.set_fault("");
  send("abc", "s1");
  EXPECT_TRUE(commit("abc").has_stored());
}

TEST_F(S3StoreTest, WhileS3IsAway_TheStartAsksOnce) {
  for (const std::string bytes : {"a", "b", "c"}) {
    send(bytes, "s-" + bytes);
    fs::remove(staging() + "/kent/" + wire::hex_of(sum_of(bytes)) + ".part");
  }
  server_.set_fault("* 500");
  const std::size_t before = server_.requests().size();
  restart();
  EXPECT_EQ(std::ranges::count(server_.requests().substr(before), '\n'), 1);
  server_.set_fault("");
  for (const std::string bytes : {"a", "b", "c"}) {
    send(bytes, "s-" + bytes);
    EXPECT_TRUE(commit(bytes).has_stored());
  }
}

TEST_F(S3StoreTest, ABucketThatDoesNotExist_EndsTheStart) {
  auto settings = server_.settings();
  settings.bucket = "recordingz";
  const auto store = open_s3_store(folder_.path(), settings);
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().code, core::ErrorCode::NotFound);
}

TEST_F(S3StoreTest, Start_RemovesCopiesThatNobodyReads) {
  send("abc", "s1");
  ASSERT_TRUE(commit("abc").has_stored());
  std::string boot;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> boot;
  const std::string folder = folder_.path() + "/fetched/";
  const std::string own = boot + "." + std::to_string(::getpid()) + ".";
  const std::string of_others = folder + boot + "." + std::to_string(::getppid()) + ".0";
  const std::string gone = std::to_string(std::numeric_limits<std::int32_t>::max());
  for (const std::string& name : {"another-boot." + std::to_string(::getppid()) + ".0", boot + "." + gone + ".0", own + "0"})
    std::ofstream(folder + name) << "left";
  std::ofstream(of_others) << "read";
  const auto store = new_store();
  EXPECT_TRUE(fs::exists(of_others));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1);
  const auto one = store->file(name("abc")).value();
  const auto two = store->file(name("abc")).value();
  ASSERT_TRUE(one && two);
  EXPECT_TRUE(one->path().starts_with(folder + own)) << one->path();
  EXPECT_NE(one->path(), two->path());
}

TEST_F(S3StoreTest, KilledAtAnyStep_NoReceiptWithoutItsObject) {
  for (const std::string last : {"synchronised", "verified", "stored", "entered"}) {
    const std::string session = "session-" + last;
    send(last, session);
    ingest_.reset();
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) commit_and_end(*new_store(), last, last);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_EQ(WEXITSTATUS(status), 9) << last;
    EXPECT_EQ(has_receipt(last), last == "entered") << last;
    EXPECT_TRUE(!has_receipt(last) || content_of(object(last)) == last) << last;
    restart();
    EXPECT_TRUE(commit(last).has_stored()) << last;
    EXPECT_EQ(content_of(object(last)), last);
  }
}

TEST_F(S3StoreTest, KilledWhileS3HasNotAnswered_NoReceipt) {
  // The put is silent; or the question after it, not one that asks before whether there is an object.
  for (const std::string fault : {"PUT silence", "HEAD stored-silence"}) {
    const std::string method = fault.substr(0, fault.find(' '));
    send(method, "session-" + method);
    ingest_.reset();
    const auto store = new_store();
    const std::size_t begin = server_.requests().size();
    const auto is_asked = [&] {
      const std::string text = server_.requests();
      const std::size_t put = text.find("PUT /", begin);
      return put != std::string::npos && text.find(method + " /", put) != std::string::npos;
    };
    server_.set_fault(fault);
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) commit_and_end(*store, method, "none");
    while (!is_asked()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    ::kill(child, SIGKILL);
    ASSERT_EQ(::waitpid(child, nullptr, 0), child);
    EXPECT_FALSE(has_receipt(method));
    server_.set_fault("");
    restart();
    EXPECT_TRUE(commit(method).has_stored()) << method;
    EXPECT_EQ(content_of(object(method)), method);
  }
}

}  // namespace
}  // namespace dts::fleet::hub
