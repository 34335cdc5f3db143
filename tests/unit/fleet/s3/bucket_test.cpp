// SPDX-License-Identifier: Apache-2.0
// With a small S3 that checks signatures, and that answers wrongly when a test wants it.
#include "fleet/s3/bucket.h"

#include <dlfcn.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>

#include "fleet/s3/sha256.h"
#include "support/s3_server.h"

namespace {
/// The folder of the system's authorities, if a test has another one.
const char* system_authorities = nullptr;
}  // namespace

/// Replaces the function of OpenSSL, through which libcurl reads the folder of authorities.
extern "C" __attribute__((visibility("default"))) int X509_STORE_load_path(void* store, const char* folder) {
  static const auto real = reinterpret_cast<int (*)(void*, const char*)>(::dlsym(RTLD_NEXT, "X509_STORE_load_path"));
  return real(store, system_authorities == nullptr ? folder : system_authorities);
}

namespace dts::fleet::s3 {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr auto kOn = [] { return true; };
const std::string kKey = "objects/kent/0123";

std::string sum_of(std::string_view bytes) {
  Sha256 sum;
  sum.add(bytes);
  return sum.finish();
}

std::string content_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

class BucketTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { server_ = new test::S3Server; }
  static void TearDownTestSuite() { delete server_; }
  void SetUp() override {
    server_->set_fault("");
    fs::remove(server_->object(kKey));
    bucket_ = Bucket::open(server_->settings()).value();
  }
  std::string file_of(const std::string& bytes) {
    std::ofstream(folder_.path() + "/file", std::ios::binary) << bytes;
    return folder_.path() + "/file";
  }
  core::Status put(const std::string& bytes) { return bucket_->put(kKey, file_of(bytes), sum_of(bytes)); }
  /// Returns the error of a put while the server answers wrongly.
  core::Error put_error(const std::string& fault, const std::string& bytes) {
    server_->set_fault(fault);
    const auto put_now = put(bytes);
    EXPECT_FALSE(put_now) << fault;
    return put_now ? core::Error{.code = core::ErrorCode::Internal, .what = "", .hint = ""} : put_now.error();
  }
  [[nodiscard]] static std::string large() {
    std::string bytes(Bucket::kMostWhole + 5'000'001, 'x');
    for (std::size_t at = 0; at < bytes.size(); at += 1000) bytes[at] = static_cast<char>(at / 1000);
    return bytes;
  }

  static inline test::S3Server* server_ = nullptr;
  test::TemporaryFolder folder_;
  std::unique_ptr<Bucket> bucket_;
};

TEST_F(BucketTest, PutGetRemove) {
  EXPECT_EQ(bucket_->size(kKey).value(), std::nullopt);
  const auto stored = put("abc");
  ASSERT_TRUE(stored) << core::to_string(stored.error());
  EXPECT_EQ(bucket_->size(kKey).value(), 3U);
  const std::string copy = folder_.path() + "/copy";
  ASSERT_TRUE(bucket_->get(kKey, copy, kOn));
  EXPECT_EQ(content_of(copy), "abc");
  EXPECT_EQ(fs::status(copy).permissions(), fs::perms(0600));
  EXPECT_EQ(bucket_->remove(kKey), true);
  EXPECT_EQ(bucket_->remove(kKey), false);
  EXPECT_EQ(bucket_->get(kKey, folder_.path() + "/none", kOn).error().code, core::ErrorCode::NotFound);
  EXPECT_FALSE(fs::exists(folder_.path() + "/none"));
}

TEST_F(BucketTest, AnEmptyFile_IsStored) {
  ASSERT_TRUE(put(""));
  EXPECT_EQ(bucket_->size(kKey).value(), 0U);
}

TEST_F(BucketTest, Put_OfAnotherContent_LeavesNoObject) {
  EXPECT_EQ(bucket_->put(kKey, file_of("abd"), sum_of("abc")).error().code, core::ErrorCode::Unreachable);  // the server rejects it
  EXPECT_FALSE(fs::exists(server_->object(kKey)));
  server_->set_fault("PUT unchecked");
  EXPECT_EQ(bucket_->put(kKey, file_of("abd"), sum_of("abc")).error().code, core::ErrorCode::DataDamaged);
  EXPECT_FALSE(fs::exists(server_->object(kKey)));
}

TEST_F(BucketTest, AWrongAnswer_IsNeverASuccess) {
  for (const char* const fault :
       {"PUT 400", "PUT 403", "PUT 404", "PUT 500", "PUT 503", "PUT 204", "PUT 301", "PUT truncated", "PUT oversized", "PUT lost",
        "PUT etag", "PUT no-etag", "HEAD 403", "HEAD 404", "HEAD 500", "HEAD size"}) {
    const auto error = put_error(fault, "abc");
    EXPECT_EQ(error.code, core::ErrorCode::Unreachable) << fault << ": " << error.what;
    EXPECT_THAT(error.what, HasSubstr(kKey)) << fault;
    server_->set_fault("");
    fs::remove(server_->object(kKey));
  }
  EXPECT_THAT(put_error("PUT 403", "abc").what, HasSubstr("403, Told: the test wants this status"));
}

TEST_F(BucketTest, AServerThatIsAway_IsUnreachable) {
  Settings settings = server_->settings();
  settings.endpoint = "http://127.0.0.1:1";
  const auto away = Bucket::open(settings).value();
  EXPECT_EQ(away->put(kKey, file_of("abc"), sum_of("abc")).error().code, core::ErrorCode::Unreachable);
  EXPECT_EQ(away->size(kKey).error().code, core::ErrorCode::Unreachable);
  EXPECT_EQ(away->remove(kKey).error().code, core::ErrorCode::Unreachable);
  EXPECT_EQ(away->list("", "").error().code, core::ErrorCode::Unreachable);
}

TEST_F(BucketTest, AnotherSecret_IsRejected) {
  const Settings settings = server_->settings();
  std::ofstream(folder_.path() + "/other") << "tester\nanother\n";
  fs::permissions(folder_.path() + "/other", fs::perms(0600));
  Settings other = settings;
  other.credentials_file = folder_.path() + "/other";
  const auto rejected = Bucket::open(other).value()->put(kKey, file_of("abc"), sum_of("abc"));
  EXPECT_THAT(rejected.error().what, HasSubstr("403"));
  EXPECT_THAT(rejected.error().hint, HasSubstr("keys"));
}

TEST_F(BucketTest, ALargeFile_IsSentInParts) {
  const std::string bytes = large();
  const auto stored = put(bytes);
  ASSERT_TRUE(stored) << core::to_string(stored.error());
  EXPECT_TRUE(content_of(server_->object(kKey)) == bytes);
  EXPECT_THAT(server_->requests(), HasSubstr("partNumber=5&"));
  EXPECT_EQ(server_->uploads(), 0);
}

TEST_F(BucketTest, ALargeFile_ThatFails_LeavesNothing) {
  const std::string bytes = large();
  for (const char* const fault : {"PUT 500", "PUT etag", "POST 403", "POST truncated", "POST late-error", "HEAD size"}) {
    EXPECT_EQ(put_error(fault, bytes).code, core::ErrorCode::Unreachable) << fault;
    EXPECT_EQ(server_->uploads(), 0) << fault;
    EXPECT_EQ(fs::exists(server_->object(kKey)), std::string(fault) == "HEAD size") << fault;
  }
  server_->set_fault("");
  fs::remove(server_->object(kKey));
  EXPECT_EQ(bucket_->put(kKey, file_of(bytes), sum_of("another")).error().code, core::ErrorCode::DataDamaged);
  EXPECT_EQ(server_->uploads(), 0);
  EXPECT_FALSE(fs::exists(server_->object(kKey)));
}

TEST_F(BucketTest, PartsThatArePutTogether_WithoutAnAnswer_AreFound) {
  const std::string bytes = large();
  server_->set_fault("POST unanswered");
  const auto stored = put(bytes);
  EXPECT_TRUE(stored) << core::to_string(stored.error());
  EXPECT_TRUE(content_of(server_->object(kKey)) == bytes);
}

TEST_F(BucketTest, AnOlderObjectOfTheSameSize_IsNotTakenForTheNewOne) {
  const std::string bytes = large();
  ASSERT_TRUE(put(std::string(bytes.size(), 'y')));
  EXPECT_EQ(put_error("POST late-error", bytes).code, core::ErrorCode::Unreachable);
}

TEST_F(BucketTest, ABucketThatDoesNotExist_IsAnError) {
  Settings settings = server_->settings();
  settings.bucket = "recordingz";
  const auto opened = Bucket::open(settings);
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, core::ErrorCode::NotFound);
  EXPECT_THAT(opened.error().what, HasSubstr("no bucket 'recordingz'"));

  server_->set_fault("HEAD 500");  // then it is not known at the start
  const auto missing = Bucket::open(settings).value();
  for (const char* const fault : {"", "HEAD 500"}) {
    server_->set_fault(fault);
    EXPECT_EQ(missing->size(kKey).error().code, core::ErrorCode::Unreachable);
    EXPECT_EQ(missing->remove(kKey).error().code, core::ErrorCode::Unreachable);
    EXPECT_EQ(missing->get(kKey, folder_.path() + "/none", kOn).error().code, core::ErrorCode::Unreachable);
  }
}

TEST_F(BucketTest, ABucketThatTheKeyMayNotAskFor_IsOpened) {
  for (const char* const fault : {"HEAD 403", "HEAD 500"}) {
    server_->set_fault(fault);
    EXPECT_TRUE(Bucket::open(server_->settings())) << fault;
  }
}

TEST_F(BucketTest, Get_KeepsNoHalfFile) {
  ASSERT_TRUE(put("abc"));
  const std::string copy = folder_.path() + "/copy";
  for (const char* const fault : {"GET 403", "GET 404", "GET 500", "GET truncated", "GET oversized"}) {
    server_->set_fault(fault);
    EXPECT_FALSE(bucket_->get(kKey, copy, kOn)) << fault;
    EXPECT_FALSE(fs::exists(copy)) << fault;
  }
  server_->set_fault("");
  EXPECT_EQ(bucket_->get(kKey, copy, [] { return false; }).error().code, core::ErrorCode::WrongState);
  EXPECT_FALSE(fs::exists(copy));
  for (const std::string& file : {folder_.path(), folder_.path() + "/none/copy"}) {
    EXPECT_EQ(bucket_->get(kKey, file, kOn).error().code, core::ErrorCode::Failed) << file;
  }
  for (const char* const key : {"", "../etc/passwd", "objects/kent/0123?x=1", "objects/%2e"}) {
    EXPECT_EQ(bucket_->get(key, copy, kOn).error().code, core::ErrorCode::DataDamaged) << key;
  }
}

TEST_F(BucketTest, Remove_ThatFails_IsNoSuccess) {
  ASSERT_TRUE(put("abc"));
  for (const char* const fault : {"DELETE 403", "DELETE 500", "HEAD 500"}) {
    server_->set_fault(fault);
    EXPECT_EQ(bucket_->remove(kKey).error().code, core::ErrorCode::Unreachable) << fault;
  }
  EXPECT_TRUE(fs::exists(server_->object(kKey)));
}

TEST_F(BucketTest, List_HasPages) {
  for (const char* const key : {"list/a", "list/b", "list/c", "other/d"}) ASSERT_TRUE(bucket_->put(key, file_of("abc"), sum_of("abc")));
  server_->set_fault("GET small-pages");
  const auto first = bucket_->list("list/", "").value();
  EXPECT_THAT(first.keys, ElementsAre("list/a", "list/b"));
  const auto second = bucket_->list("list/", first.next).value();
  EXPECT_THAT(second.keys, ElementsAre("list/c"));
  EXPECT_EQ(second.next, "");
}

TEST_F(BucketTest, List_ThatIsWrong_Fails) {
  for (const char* const fault : {"GET 403", "GET 500", "GET truncated", "GET oversized", "GET endless"}) {
    server_->set_fault(fault);
    auto page = bucket_->list("", "");
    while (page && !page->next.empty()) page = bucket_->list("", page->next);
    ASSERT_FALSE(page) << fault;
    EXPECT_EQ(page.error().code, core::ErrorCode::Unreachable) << fault;
  }
}

/// Makes FOLDER/NAME.pem and FOLDER/NAME.key, a certificate of 127.0.0.1 that has signed itself. Returns the first.
std::string certify(const std::string& folder, const std::string& name) {
  const std::string file = folder + "/" + name;
  const std::string command = "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -noenc -days 2 -subj /CN=" + name +
                              " -addext subjectAltName=IP:127.0.0.1 -keyout " + file + ".key -out " + file + ".pem 2>/dev/null";
  EXPECT_EQ(std::system(command.c_str()), 0);
  return file + ".pem";
}

TEST(AuthorityTest, OfAFile_ExcludesTheAuthoritiesOfTheSystem) {
  const test::TemporaryFolder folder;
  const std::string known = certify(folder.path(), "known");
  const std::string other = certify(folder.path(), "other");
  const std::string authorities = folder.path() + "/authorities";
  fs::create_directory(authorities);
  fs::copy_file(known, authorities + "/known.pem");
  ASSERT_EQ(std::system(("openssl rehash " + authorities).c_str()), 0);
  system_authorities = authorities.c_str();
  const test::S3Server server(known, folder.path() + "/known.key");
  const auto size_with = [&](const std::string& ca) {
    Settings settings = server.settings();
    settings.ca_file = ca;
    return Bucket::open(settings).value()->size(kKey);
  };
  EXPECT_TRUE(size_with("")) << "the folder of the system is not read";
  EXPECT_TRUE(size_with(known));
  const auto stranger = size_with(other);
  EXPECT_FALSE(stranger);
  EXPECT_TRUE(stranger || stranger.error().what.find("certificate") != std::string::npos) << core::to_string(stranger.error());
  system_authorities = nullptr;
}

/// Another implementation: DTS_S3="ENDPOINT BUCKET REGION CREDENTIALS", for example that of s3rver. See tests/fleet/s3.py.
TEST(OtherServerTest, PutGetListRemove) {
  const char* const given = std::getenv("DTS_S3");
  if (given == nullptr) GTEST_SKIP() << "DTS_S3 names no server";
  Settings settings;
  std::istringstream(given) >> settings.endpoint >> settings.bucket >> settings.region >> settings.credentials_file;
  const auto bucket = Bucket::open(settings).value();
  test::TemporaryFolder folder;
  const std::string file = folder.path() + "/file";
  for (const std::size_t bytes : {std::size_t{0}, std::size_t{1000}, static_cast<std::size_t>(Bucket::kMostWhole) + 1000}) {
    const std::string content(bytes, 'x');
    std::ofstream(file, std::ios::binary) << content;
    const std::string key = "objects/kent/" + std::to_string(bytes);
    const auto stored = bucket->put(key, file, sum_of(content));
    ASSERT_TRUE(stored) << core::to_string(stored.error());
    EXPECT_EQ(bucket->size(key).value(), bytes);
    ASSERT_TRUE(bucket->get(key, file + "-" + std::to_string(bytes), kOn));
    EXPECT_TRUE(content_of(file + "-" + std::to_string(bytes)) == content);
  }
  const Page page = bucket->list("objects/", "").value();
  EXPECT_EQ(page.keys.size(), 3U);
  EXPECT_FALSE(bucket->put("objects/kent/1", file, sum_of("another")));
  EXPECT_EQ(bucket->size("objects/kent/1").value(), std::nullopt);
  for (const std::string& key : page.keys) EXPECT_EQ(bucket->remove(key), true);
  EXPECT_TRUE(bucket->list("objects/", "").value().keys.empty());
}

}  // namespace
}  // namespace dts::fleet::s3
