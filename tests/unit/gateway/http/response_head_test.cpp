// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/response_head.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "gateway/http/body_source.h"
#include "unit/libdts/fake_daemon.h"

namespace dts::gateway {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string kPolicy =
    "Content-Security-Policy: default-src 'self'; connect-src 'self'; frame-ancestors 'self'; base-uri 'none'; form-action 'self'; "
    "object-src 'none'\r\n";
const std::string kOtherSecurity =
    "X-Content-Type-Options: nosniff\r\n"
    "Referrer-Policy: no-referrer\r\n"
    "Cross-Origin-Opener-Policy: same-origin\r\n"
    "Cross-Origin-Resource-Policy: same-origin\r\n"
    "Permissions-Policy: camera=(), geolocation=(), microphone=(), payment=(), usb=()\r\n";

TEST(ResponseHead, CarriesLengthTypeAndSecurityHeaders) {
  const std::string type = "Content-Type: text/plain\r\n";
  EXPECT_EQ(response_head({.content_type = "text/plain"}, {.path = "/", .keeps_alive = true, .body_bytes = 12}),
            "HTTP/1.1 200 OK\r\nConnection: keep-alive\r\nContent-Length: 12\r\n" + type + kPolicy + kOtherSecurity + "\r\n");
  EXPECT_EQ(response_head({.status = 304, .content_type = "text/plain"}, {}),
            "HTTP/1.1 304 Not Modified\r\nConnection: close\r\n" + kPolicy + kOtherSecurity + "\r\n");
  for (const auto& [status, has_body] : {std::pair(101U, false), {200U, true}, {204U, false}, {304U, false}, {404U, true}}) {
    EXPECT_EQ(may_have_body(status), has_body) << status;
  }
}

TEST(ResponseHead, TlsAndApiAddTheirsAndTheRouteMaySetItsOwn) {
  const std::string start = "HTTP/1.1 404 Not Found\r\nConnection: close\r\nContent-Length: 0\r\n";
  const AnswerFrame api{.path = "/api/me", .is_secure = true};
  EXPECT_EQ(response_head({.status = 404, .content_type = ""}, api),
            start + kPolicy + kOtherSecurity + "Strict-Transport-Security: max-age=31536000\r\nCache-Control: no-store\r\n\r\n");
  const std::vector<std::pair<std::string, std::string>> own{
      {"content-security-policy", "default-src 'none'"}, {"strict-transport-security", "max-age=0"}, {"cache-control", "no-cache"}};
  std::string lines;
  for (const auto& [name, value] : own) lines += name + ": " + value + "\r\n";
  EXPECT_EQ(response_head({.status = 404, .content_type = "", .headers = own}, api), start + lines + kOtherSecurity + "\r\n");
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

class BodySourceOfFile : public ::testing::Test {
 protected:
  testing::TemporaryDirectory folder_;
  std::filesystem::path directory_ = folder_.path();
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
