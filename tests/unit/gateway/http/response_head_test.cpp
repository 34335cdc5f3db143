// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/response_head.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <fstream>

#include "gateway/http/body_source.h"

namespace dts::gateway {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

TEST(ResponseHead, CarriesTheSecurityHeaders) {
  const std::string head = response_head({}, {.path = "/", .keeps_alive = true, .body_bytes = 12});

  EXPECT_THAT(head, StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(head, HasSubstr("Content-Length: 12\r\n"));
  EXPECT_THAT(head, HasSubstr("Connection: keep-alive\r\n"));
  EXPECT_THAT(head, HasSubstr("Content-Security-Policy: default-src 'self'; connect-src 'self'; frame-ancestors 'self';"));
  EXPECT_THAT(head, HasSubstr("X-Content-Type-Options: nosniff\r\n"));
  EXPECT_THAT(head, HasSubstr("Referrer-Policy: no-referrer\r\n"));
  EXPECT_THAT(head, HasSubstr("Cross-Origin-Opener-Policy: same-origin\r\n"));
  EXPECT_THAT(head, HasSubstr("Cross-Origin-Resource-Policy: same-origin\r\n"));
  EXPECT_THAT(head, HasSubstr("Permissions-Policy: "));
  EXPECT_THAT(head, Not(HasSubstr("Strict-Transport-Security")));
  EXPECT_THAT(head, Not(HasSubstr("Cache-Control")));
  EXPECT_TRUE(head.ends_with("\r\n\r\n"));
}

TEST(ResponseHead, TheRouteMaySetItsOwnPolicy) {
  const std::string head = response_head({.headers = {{"content-security-policy", "default-src 'none'"}}}, {});

  EXPECT_THAT(head, HasSubstr("content-security-policy: default-src 'none'\r\n"));
  EXPECT_THAT(head, Not(HasSubstr("Content-Security-Policy")));
}

TEST(ResponseHead, TlsAndApiAddTheirs) {
  const std::string head = response_head({}, {.path = "/api/me", .is_secure = true});

  EXPECT_THAT(head, HasSubstr("Strict-Transport-Security: max-age="));
  EXPECT_THAT(head, HasSubstr("Cache-Control: no-store\r\n"));
}

TEST(ResponseHead, ALineBreakInAHeaderSplitsNothing) {
  for (const std::string& end : {std::string("\r\n"), std::string("\r"), std::string("\n"), std::string(1, '\0')}) {
    const std::string forged = "x" + end + "Set-Cookie: dts_token=forged";
    EXPECT_THAT(response_head({.headers = {{"Location", forged}, {forged, "y"}}}, {}), Not(HasSubstr("forged")));
  }
  const std::string head = response_head({.headers = {{"Content-Length", "7"}, {"Connection", "upgrade"}}}, {});
  EXPECT_THAT(head, Not(HasSubstr("Content-Length: 7")));
  EXPECT_THAT(head, Not(HasSubstr("upgrade")));
}

TEST(ResponseHead, NotModifiedHasNoLength) {
  EXPECT_THAT(response_head({.status = 304}, {}), Not(HasSubstr("Content-Length")));
  EXPECT_FALSE(may_have_body(304));
  EXPECT_TRUE(may_have_body(404));
}

class BodySourceOfFile : public ::testing::Test {
 protected:
  BodySourceOfFile() {
    char name[] = "/tmp/dts-XXXXXX";
    directory_ = ::mkdtemp(name);
  }
  ~BodySourceOfFile() override { std::filesystem::remove_all(directory_); }
  std::filesystem::path directory_;
};

TEST_F(BodySourceOfFile, ComesInPiecesAndSaysWhenItIsDone) {
  const std::string content(BodySource::kPieceBytes * 2 + 5, 'x');
  std::ofstream(directory_ / "a") << content;
  int done = 0;
  std::string got;

  {
    BodySource source(FileBody{.path = directory_ / "a", .when_done = [&] { ++done; }});
    ASSERT_TRUE(source.is_good());
    EXPECT_EQ(source.size_bytes(), content.size());
    for (auto piece = source.next(); piece && !piece->empty(); piece = source.next()) got += *piece;
    EXPECT_EQ(done, 0);
  }

  EXPECT_EQ(got, content);
  EXPECT_EQ(done, 1);
}

TEST_F(BodySourceOfFile, ShorterThanPromisedIsAnError) {
  std::ofstream(directory_ / "a") << std::string(1000, 'x');
  BodySource source(FileBody{.path = directory_ / "a"});

  std::filesystem::resize_file(directory_ / "a", 0);

  EXPECT_EQ(source.size_bytes(), 1000U);
  EXPECT_FALSE(source.next().has_value());
}

TEST_F(BodySourceOfFile, WhatIsNoFileIsNotServed) {
  ASSERT_EQ(::mkfifo((directory_ / "fifo").c_str(), 0600), 0);
  std::filesystem::create_symlink("/etc/passwd", directory_ / "link");

  for (const char* name : {"fifo", "link", "absent", "."}) {
    int done = 0;
    {
      EXPECT_FALSE(BodySource(FileBody{.path = directory_ / name, .when_done = [&] { ++done; }}).is_good()) << name;
    }
    EXPECT_EQ(done, 1) << name;
  }
}

}  // namespace
}  // namespace dts::gateway
