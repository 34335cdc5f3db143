// SPDX-License-Identifier: Apache-2.0
// PDF documents. The tests need rsvg-convert (librsvg2-bin), which scripts/lib.sh installs; pdftotext (poppler-utils) reads their text.
#include "report/pdf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <optional>

#include "made_reaching.h"
#include "made_standing.h"
#include "report/report.h"
#include "unit/record/xdf_fixture.h"

namespace dts::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Sets an environment variable and restores it.
class Setting {
 public:
  Setting(const char* name, const char* value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    ::setenv(name, value, 1);
  }
  ~Setting() {
    if (before_)
      ::setenv(name_, before_->c_str(), 1);
    else
      ::unsetenv(name_);
  }
  Setting(const Setting&) = delete;
  Setting& operator=(const Setting&) = delete;

 private:
  const char* name_;
  std::optional<std::string> before_;
};

std::string output_of(const std::string& command) {
  std::string text;
  std::FILE* const pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return text;
  std::array<char, 4096> chunk{};
  for (std::size_t count = 0; (count = std::fread(chunk.data(), 1, chunk.size(), pipe)) > 0;) text.append(chunk.data(), count);
  ::pclose(pipe);
  return text;
}

class PdfTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (output_of("rsvg-convert --version 2>/dev/null").empty())
      GTEST_SKIP() << "rsvg-convert is not installed: apt-get install librsvg2-bin";
  }
  static bool always(double) { return true; }
  static bool wanted() { return true; }
  [[nodiscard]] std::string chair() {
    MadeReaching made;
    for (std::uint32_t trial = 1; trial <= 3; ++trial) made.reaches.push_back({.trial = trial});
    made.facts.subject = "M\u00FCller-7";
    return write_reaching(directory_ / "chair.xdf", made);
  }
  [[nodiscard]] static std::string pdf_of_report(const std::string& file) {
    auto report = make_report({.files = {file}, .software = "test 1", .with_html = false, .with_svg = false, .with_pdf = true}, always);
    EXPECT_TRUE(report.has_value()) << (report ? "" : core::to_string(report.error()));
    if (!report) return {};
    EXPECT_EQ(report->pages.size(), 1U);
    EXPECT_EQ(report->pages.front().file, kPdfName);
    return report->pages.front().text;
  }
  /// Returns the text of the document; empty without pdftotext.
  [[nodiscard]] std::string text_of_document(const std::string& document) {
    const std::string file = directory_ / "text.pdf";
    std::ofstream(file, std::ios::binary) << document;
    return output_of("pdftotext -layout '" + file + "' - 2>&1");
  }
  static bool can_read_text() { return !output_of("pdftotext -v 2>&1 | grep -i version").empty(); }

  record::xdf_test::Folder directory_;
};

TEST_F(PdfTest, TheSameRecording_GivesTheSameBytesInEveryTimeZoneAndLanguage) {
  RecordProperty("requirement", "REP-9");
  const std::string file = chair();
  const std::string first = pdf_of_report(file);
  const Setting zone("TZ", "Asia/Tokyo");
  const Setting language("LC_ALL", "de_DE.UTF-8");
  const Setting date("SOURCE_DATE_EPOCH", "12345");
  const Setting home("HOME", "/tmp");
  const std::string second = pdf_of_report(file);

  EXPECT_TRUE(first.starts_with("%PDF-"));
  EXPECT_EQ(first, second);
  EXPECT_NE(first.find(kPageMark, first.size() - 1024), std::string::npos);
}

TEST_F(PdfTest, TextCanBeExtracted) {
  RecordProperty("requirement", "REP-11");
  if (!can_read_text()) GTEST_SKIP() << "pdftotext is not installed: apt-get install poppler-utils";
  const std::string text = text_of_document(pdf_of_report(chair()));

  EXPECT_THAT(text, HasSubstr("M\u00FCller-7"));
  EXPECT_THAT(text, HasSubstr("Trunk class by target"));
  EXPECT_THAT(text, HasSubstr("moderate"));
  EXPECT_THAT(text, HasSubstr("P3: maximum"));
  EXPECT_THAT(text, HasSubstr("20261121T144525Z-chair-1, test 1")) << "the foot of every page";
  EXPECT_THAT(text, testing::ContainsRegex("1 ?/ ?4"));
  std::size_t feet = 0;
  for (std::size_t at = text.find("No diagnosis, no decision"); at != std::string::npos;
       at = text.find("No diagnosis, no decision", at + 1)) {
    ++feet;
  }
  EXPECT_EQ(feet, 4U) << "intended use at the foot of every page";
}

TEST_F(PdfTest, OfTheSessionAlone_HasNoPageOfATrial) {
  const std::string file = chair();
  const auto session = make_session_pdf({.files = {file}, .software = "test 1"}, always);

  ASSERT_TRUE(session) << core::to_string(session.error());
  EXPECT_TRUE(session->starts_with("%PDF-"));
  EXPECT_LT(session->size(), pdf_of_report(file).size());
  if (!can_read_text()) return;
  EXPECT_THAT(text_of_document(*session), Not(HasSubstr("P3: maximum")));
}

TEST_F(PdfTest, OfAFloorSession_NothingIsLeftOut) {
  MadeStanding made{.length_s = 115.0};
  for (std::uint32_t trial = 1; trial <= 10; ++trial)
    add_trial(made, trial, 1.0 + 11.0 * (trial - 1), 10.0, "eyes-open", {{"eyes", "open"}});
  const std::string document = pdf_of_report(write_standing(directory_ / "floor.xdf", made));

  ASSERT_TRUE(document.starts_with("%PDF-"));
  if (!can_read_text()) GTEST_SKIP() << "pdftotext is not installed: apt-get install poppler-utils";
  const std::string text = text_of_document(document);
  EXPECT_THAT(text, Not(HasSubstr("This page is full")));
  EXPECT_THAT(text, HasSubstr("Methods, for a paper"));
  EXPECT_THAT(text, HasSubstr("trial 10"));
}

TEST_F(PdfTest, NoPages_AndTooMany_AreRefused) {
  EXPECT_EQ(pdf_of({}, 0, wanted).error().code, core::ErrorCode::LimitExceeded);
  const std::vector<std::string> many(kMostPdfPages + 1, "<svg xmlns='http://www.w3.org/2000/svg'/>");
  EXPECT_EQ(pdf_of(many, 0, wanted).error().code, core::ErrorCode::LimitExceeded);
}

TEST_F(PdfTest, WhatIsNoSvg_FailsWithTheWordsOfTheProgram) {
  const std::vector<std::string> pages{"this is no picture"};
  const auto document = pdf_of(pages, 0, wanted);

  ASSERT_FALSE(document);
  EXPECT_THAT(document.error().what, HasSubstr("rsvg-convert failed: "));
}

TEST_F(PdfTest, OtherFilesAreNotRead) {
  std::ofstream(directory_ / "secret.svg") << R"(<svg xmlns="http://www.w3.org/2000/svg"><text>secret words</text></svg>)";
  const std::string other =
      "<svg xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink' width='100' height='100'><image "
      "width='50' height='50' xlink:href='file://" +
      (directory_ / "secret.svg") + "'/><text y='20'>own words</text></svg>";
  const std::vector<std::string> pages{other};
  const auto document = pdf_of(pages, 0, wanted);

  ASSERT_TRUE(document) << core::to_string(document.error());
  if (!can_read_text()) GTEST_SKIP() << "pdftotext is not installed: apt-get install poppler-utils";
  EXPECT_THAT(text_of_document(*document), HasSubstr("own words"));
  EXPECT_THAT(text_of_document(*document), Not(HasSubstr("secret")));
}

TEST_F(PdfTest, Stopped_KillsTheProgram) {
  // A picture of many blurs takes longer than the time between two looks.
  std::string slow =
      "<svg xmlns='http://www.w3.org/2000/svg' width='2000' height='2000'><filter id='f'><feGaussianBlur stdDeviation='90'/></filter>";
  for (int k = 0; k < 200; ++k) slow += "<rect width='2000' height='2000' filter='url(#f)'/>";
  const std::vector<std::string> pages{slow + "</svg>"};
  const auto document = pdf_of(pages, 0, [] { return false; });

  ASSERT_FALSE(document);
  EXPECT_THAT(document.error().what, HasSubstr("interrupted"));
}

TEST(PdfWithoutProgram, NamesThePackage) {
  const Setting path("PATH", "/no/such/folder");
  const std::vector<std::string> pages{"<svg xmlns='http://www.w3.org/2000/svg'/>"};
  const auto document = pdf_of(pages, 0, [] { return true; });

  ASSERT_FALSE(document);
  EXPECT_EQ(document.error().code, core::ErrorCode::Unsupported);
  EXPECT_THAT(document.error().hint, HasSubstr("librsvg2-bin"));
}

}  // namespace
}  // namespace dts::report
