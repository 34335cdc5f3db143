// SPDX-License-Identifier: Apache-2.0
// A program for PDFs that never ends: the other requests are answered, and the PDF ends with an error.
#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>

#include "unit/gateway/archive/archive_fixture.h"
#include "unit/gateway/archive/unpacked.h"

namespace dts::gateway {
namespace {

using ::testing::HasSubstr;

/// With a stand-in for rsvg-convert first in PATH.
class HangingPdfTest : public ArchiveTest {
 protected:
  HangingPdfTest() {
    const std::string program = path("rsvg-convert");
    std::ofstream(program) << "#!/bin/sh\nexec /bin/sleep 100000\n";
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    const char* const before = std::getenv("PATH");  // NOLINT(concurrency-mt-unsafe): before the archive's threads need it
    path_before_ = before == nullptr ? "" : before;
    set_path(directory_.path().string() + ":" + path_before_);
  }
  ~HangingPdfTest() override {
    archive_.reset();  // ends the programs
    set_path(path_before_);
  }
  void open_with_limit(std::chrono::seconds limit) {
    options_.pdf_limit = limit;
    open();
  }

 private:
  static void set_path(const std::string& value) {
    ::setenv("PATH", value.c_str(), 1);  // NOLINT(concurrency-mt-unsafe)
  }
  std::string path_before_;
};

TEST_F(HangingPdfTest, PagesAndOtherExports_AreAnswered) {
  open_with_limit(std::chrono::hours(1));
  add_standing();
  begin("report/report.pdf");
  begin("export/fhir");

  EXPECT_EQ(get("report").status, 200U);
  EXPECT_EQ(get("report/session.html").content_type, "text/html; charset=utf-8");
  const HttpResponse table = get("export/csv");
  EXPECT_EQ(table.status, 200U);
  EXPECT_EQ(table.content_type, "application/zip");
  EXPECT_TRUE(answers_.empty()) << "the two PDFs are under way";
}

TEST_F(HangingPdfTest, APdf_EndsAtItsLimitWithAnError_AndABundleHasNone) {
  open_with_limit(std::chrono::seconds(1));
  add_standing();

  const HttpResponse answer = get("report/report.pdf");
  EXPECT_EQ(answer.status, 500U);
  EXPECT_THAT(json_of(answer)["what"].get<std::string>(), HasSubstr("rsvg-convert did not finish within 1 s"));
  EXPECT_THAT(json_of(answer)["hint"].get<std::string>(), HasSubstr("open the HTML page and print it"));

  const auto files = testing::unpacked(file_of(get("export/fhir")).path);
  EXPECT_THAT(files.at("NOTES.txt"), HasSubstr("did not finish within 1 s"));
}

}  // namespace
}  // namespace dts::gateway
