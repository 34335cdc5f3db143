// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/static_files.h"

#include <gtest/gtest.h>

#include <fstream>

#include "unit/gateway/read_response.h"
#include "unit/libdts/fake_daemon.h"

namespace dts::gateway {
namespace {

namespace fs = std::filesystem;

class StaticFilesTest : public ::testing::Test {
 protected:
  StaticFilesTest() {
    write("index.html", "<!DOCTYPE html>");
    write("assets/index-1a2b.js", "run()");
  }
  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((root_ / name).parent_path());
    std::ofstream(root_ / name, std::ios::binary) << text;
  }
  [[nodiscard]] HttpResponse get(const std::string& path, const std::string& if_none_match = "", const std::string& method = "GET") const {
    const auto files = StaticFiles::load(root_);
    EXPECT_TRUE(files.has_value());
    HttpRequest request{.method = method, .path = path};
    if (!if_none_match.empty()) request.headers["if-none-match"] = if_none_match;
    HttpResponse answer;
    files->serve(request, [&answer](HttpResponse told) { answer = std::move(told); });
    return answer;
  }

  testing::TemporaryDirectory directory_;
  fs::path root_ = directory_.path() / "dist";
};

TEST_F(StaticFilesTest, Root_IsTheIndex) {
  const HttpResponse answer = get("/");

  EXPECT_EQ(answer.status, 200U);
  EXPECT_EQ(text_of(answer), "<!DOCTYPE html>");
  EXPECT_EQ(answer.content_type, "text/html; charset=utf-8");
  EXPECT_EQ(header_of(answer, "Cache-Control"), "no-cache");
  EXPECT_EQ(text_of(get("/patient")), "<!DOCTYPE html>");
  EXPECT_EQ(text_of(get("/index.html", "", "HEAD")), "<!DOCTYPE html>") << "the transport leaves the body out";
}

TEST_F(StaticFilesTest, FileWithAHashInItsName_MayBeKeptForEver) {
  const HttpResponse answer = get("/assets/index-1a2b.js");

  EXPECT_EQ(text_of(answer), "run()");
  EXPECT_EQ(header_of(answer, "Cache-Control"), "public, max-age=31536000, immutable");
}

TEST_F(StaticFilesTest, WhatIsNotThere_IsNotFound) {
  for (const char* path : {"/nothing", "/patient/", "/patients", "/assets", "/assets/", "//index.html", "/index.html/", "/INDEX.HTML",
                           "/./index.html", "index.html", "/assets/../index.html", "/....//index.html", "/..;/index.html",
                           "/%2e%2e/index.html", "/assets\\index-1a2b.js", ""}) {
    EXPECT_EQ(get(path).status, 404U) << path;
  }
}

TEST_F(StaticFilesTest, Links_AreNotFollowed) {
  std::ofstream(directory_.path() / "secret.txt") << "secret";
  fs::create_directory(directory_.path() / "outside");
  std::ofstream(directory_.path() / "outside" / "secret.txt") << "secret";
  fs::create_symlink(directory_.path() / "secret.txt", root_ / "secret.txt");
  fs::create_directory_symlink(directory_.path() / "outside", root_ / "outside");

  EXPECT_EQ(get("/secret.txt").status, 404U);
  EXPECT_EQ(get("/outside/secret.txt").status, 404U);
}

TEST_F(StaticFilesTest, FileThatTheBrowserHas_IsNotSentAgain) {
  const std::string etag = header_of(get("/"), "ETag");

  ASSERT_GT(etag.size(), 2U);
  for (const std::string& list : {etag, "W/" + etag, "\"x\", " + etag + " ,\"y\"", std::string("*")}) {
    const HttpResponse answer = get("/", list);
    EXPECT_EQ(answer.status, 304U) << list;
    EXPECT_EQ(text_of(answer), "");
    EXPECT_EQ(header_of(answer, "ETag"), etag);
  }
  for (const std::string& list : {std::string("\"x\""), etag.substr(1), std::string(","), "x" + etag}) {
    EXPECT_EQ(get("/", list).status, 200U) << list;
  }
}

TEST_F(StaticFilesTest, ChangedFile_HasAnotherTag) {
  const std::string before = header_of(get("/"), "ETag");
  write("index.html", "123456789");

  EXPECT_NE(header_of(get("/"), "ETag"), before);
  EXPECT_EQ(header_of(get("/"), "ETag"), "\"995dc9bbdf1939fa\"") << "CRC-64/XZ: the same after a restart";
}

TEST_F(StaticFilesTest, ContentTypes_FollowFromTheNames) {
  const std::map<std::string, std::string> expected{{"a.css", "text/css; charset=utf-8"},
                                                    {"a.js", "text/javascript; charset=utf-8"},
                                                    {"a.svg", "image/svg+xml"},
                                                    {"a.png", "image/png"},
                                                    {"a.woff2", "font/woff2"},
                                                    {"a.json", "application/json"},
                                                    {"a.js.map", "application/json"},
                                                    {"a.txt", "text/plain; charset=utf-8"},
                                                    {"a.ico", "image/x-icon"},
                                                    {"a.webmanifest", "application/manifest+json"},
                                                    {"a.wasm", "application/octet-stream"},
                                                    {"a", "application/octet-stream"}};
  for (const auto& [name, type] : expected) write(name, "x");

  for (const auto& [name, type] : expected) EXPECT_EQ(get("/" + name).content_type, type) << name;
}

TEST_F(StaticFilesTest, OtherMethods_AreRefused) {
  const HttpResponse answer = get("/", "", "POST");

  EXPECT_EQ(answer.status, 405U);
  EXPECT_EQ(header_of(answer, "Allow"), "GET, HEAD");
}

TEST_F(StaticFilesTest, FolderWithoutAnIndex_IsNoDashboard) {
  fs::remove(root_ / "index.html");

  const auto without = StaticFiles::load(root_);
  const auto nowhere = StaticFiles::load(directory_.path() / "nowhere");

  ASSERT_FALSE(without.has_value());
  EXPECT_EQ(without.error().code, client::ErrorCode::InvalidArgument);
  ASSERT_FALSE(nowhere.has_value());
  EXPECT_EQ(nowhere.error().code, client::ErrorCode::InvalidArgument);
}

TEST_F(StaticFilesTest, MoreThan64MiB_AreRefused) {
  write("a.bin", "");
  fs::resize_file(root_ / "a.bin", 64ULL << 20U);

  const auto loaded = StaticFiles::load(root_);

  ASSERT_FALSE(loaded.has_value());
  EXPECT_EQ(loaded.error().code, client::ErrorCode::LimitExceeded);
}

}  // namespace
}  // namespace dts::gateway
