// SPDX-License-Identifier: Apache-2.0
#include "gateway/archive/archive.h"

#include <fstream>

#include "report/report.h"
#include "unit/gateway/archive/archive_fixture.h"

namespace dts::gateway {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST_F(ArchiveTest, Report_ListsItsPages) {
  add_standing();

  const HttpResponse answer = get("report");

  EXPECT_EQ(answer.status, 200U) << text_of(answer);
  EXPECT_EQ(answer.content_type, "application/json");
  EXPECT_THAT(json_of(answer)["pages"].get<std::vector<std::string>>(),
              ElementsAre("session.html", "session.svg", "trial-01.html", "trial-01.svg"));
  EXPECT_TRUE(json_of(answer)["damage"].empty());
}

TEST_F(ArchiveTest, Page_IsWhatDtsctlReportMakes) {
  const std::string file = add_standing().parts(0).file();
  const auto expected =
      report::make_report({.files = {file}, .software = "dtsctl " + std::string(client::version())}, [](double) { return true; });
  ASSERT_TRUE(expected.has_value());

  const HttpResponse html = get("report/session.html");
  const HttpResponse svg = get("report/session.svg");

  EXPECT_EQ(html.content_type, "text/html; charset=utf-8");
  EXPECT_EQ(text_of(html), expected->pages.at(0).text);
  EXPECT_EQ(svg.content_type, "image/svg+xml");
  EXPECT_EQ(text_of(svg), expected->pages.at(1).text);
  for (const HttpResponse& page : {html, svg}) {
    EXPECT_THAT(header_of(page, "Content-Security-Policy"), HasSubstr("default-src 'none'"));
    EXPECT_THAT(header_of(page, "Content-Security-Policy"), HasSubstr("sandbox"));
    EXPECT_EQ(header_of(page, "X-Content-Type-Options"), "nosniff");
  }
  EXPECT_EQ(get("report/trial-02.html").status, 404U);
}

TEST_F(ArchiveTest, ReportMadeOnce_IsKeptUntilTheRecordingIsAnother) {
  v1::SessionRecord& session = add_standing();
  EXPECT_EQ(get("report").status, 200U);
  fs::rename(session.parts(0).file(), path("moved.xdf"));
  EXPECT_EQ(get("report").status, 500U) << "a file that cannot be read is told, whatever is kept";
  fs::rename(path("moved.xdf"), session.parts(0).file());

  begin("report/session.html");
  EXPECT_EQ(answers_.size(), 1U) << "answered at once, without the worker";
  wait_for(1);
  session.mutable_parts(0)->set_sha256("other");
  begin("report/session.html");
  EXPECT_TRUE(answers_.empty());
  EXPECT_EQ(wait_for(1).front().status, 200U);
}

TEST_F(ArchiveTest, CorrectedSession_GetsAnotherReport_AndADeletedOneNone) {
  v1::SessionRecord& session = add_standing();
  EXPECT_EQ(get("report").status, 200U);
  session.add_corrections()->set_new_value("P018");
  begin("report/session.html");
  EXPECT_TRUE(answers_.empty()) << "it is made again";
  EXPECT_EQ(wait_for(1).front().status, 200U);
  session.set_is_deleted(true);
  for (const char* what : {"report", "report/session.html", "export/csv", "export/xdf/1"}) {
    EXPECT_EQ(get(what).status, 409U) << what;
    EXPECT_EQ(json_of(get(what))["hint"], "restore the session first");
  }
}

TEST_F(ArchiveTest, AfterAnErasure_NothingIsKept) {
  add_standing();
  EXPECT_EQ(get("report").status, 200U);
  EXPECT_EQ(get("export/csv").status, 200U);
  EXPECT_EQ(cached().size(), 1U);
  begin("export/bids");  // under way while the subject is erased
  archive_->forget();
  EXPECT_THAT(cached(), ::testing::Each(::testing::StartsWith("work-")));
  static_cast<void>(wait_for(1));
  EXPECT_TRUE(cached().empty()) << "and what was under way is not kept";
  begin("report/session.html");
  EXPECT_TRUE(answers_.empty()) << "the report is made again";
  EXPECT_EQ(wait_for(1).front().status, 200U);
}

TEST_F(ArchiveTest, ReportOfARunningSession_IsRefusedUntilItIsOver) {
  v1::SessionRecord& session = add_standing();
  session.set_state("running");
  for (const char* what : {"report", "report/session.html", "export/csv", "export/bids"}) {
    const HttpResponse answer = get(what);
    EXPECT_EQ(answer.status, 409U) << what;
    EXPECT_EQ(json_of(answer)["hint"], "stop the session first");
  }
  EXPECT_EQ(get("export/xdf/1").status, 200U) << "this part is over";

  session.set_state("complete");
  EXPECT_EQ(get("report").status, 200U);
}

TEST_F(ArchiveTest, ReportOfASessionWithoutReachesAndCop_SaysWhatToDo) {
  add_two_parts();

  const HttpResponse answer = get("report");

  EXPECT_EQ(answer.status, 404U);
  EXPECT_EQ(json_of(answer)["hint"], "choose a session of a floor platform or of a chair: dtsctl session list");
}

TEST_F(ArchiveTest, Pdf_IsMadeOnRequestAndDownloaded) {
  const std::string file = add_standing().parts(0).file();
  const auto expected = report::make_report(
      {.files = {file}, .software = "dtsctl " + std::string(client::version()), .with_html = false, .with_svg = false, .with_pdf = true},
      [](double) { return true; });

  const HttpResponse answer = get("report/report.pdf");

  if (!expected) {  // rsvg-convert is not installed
    EXPECT_EQ(answer.status, 501U);
    EXPECT_THAT(json_of(answer)["hint"].get<std::string>(), HasSubstr("librsvg2-bin"));
    return;
  }
  EXPECT_EQ(answer.status, 200U);
  EXPECT_EQ(answer.content_type, "application/pdf");
  EXPECT_EQ(header_of(answer, "Content-Disposition"), "attachment; filename=\"" + kId + "-report.pdf\"");
  EXPECT_EQ(text_of(answer), expected->pages.front().text);
  EXPECT_THAT(json_of(get("report"))["pages"].dump(), ::testing::Not(::testing::HasSubstr("report.pdf")))
      << "the list is that of the pages";
}

TEST_F(ArchiveTest, Recording_IsTheFileItself) {
  const std::string file = add_two_parts().parts(1).file();

  const HttpResponse answer = get("export/xdf/2");

  EXPECT_EQ(answer.status, 200U);
  EXPECT_EQ(file_of(answer).path, file);
  EXPECT_EQ(header_of(answer, "Content-Disposition"), "attachment; filename=\"b.xdf\"");
  EXPECT_EQ(get("export/xdf/3").status, 404U);
}

TEST_F(ArchiveTest, RecordingWithAnOddName_GetsAPlainOne) {
  add_session({ctl::make_recording(path("a \"b\"\r\nX: y.xdf"))});

  EXPECT_EQ(header_of(get("export/xdf/1"), "Content-Disposition"), "attachment; filename=\"a__b___X__y.xdf\"");
}

TEST_F(ArchiveTest, PartThatIsNotOver_IsNotGiven) {
  v1::SessionPart& part = *add_two_parts().mutable_parts(0);

  part.set_state(v1::PART_STATE_RECORDING);
  EXPECT_EQ(get("export/xdf/1").status, 409U);
  part.set_state(v1::PART_STATE_MISSING);
  EXPECT_EQ(get("export/xdf/1").status, 422U);
  part.set_state(v1::PART_STATE_UNSPECIFIED);
  EXPECT_EQ(get("export/xdf/1").status, 422U);
  for (const auto state : {v1::PART_STATE_INCOMPLETE, v1::PART_STATE_INTERRUPTED, v1::PART_STATE_RECOVERED}) {
    part.set_state(state);
    EXPECT_EQ(get("export/xdf/1").status, 200U) << state;
  }
}

TEST_F(ArchiveTest, FileThatIsNoRecording_IsNeverGivenAway) {
  v1::SessionPart& part = *add_two_parts().mutable_parts(0);
  std::ofstream(path("secret")) << "root:x:0:0";
  std::ofstream(path("short")) << "XD";

  for (const std::string& file : {path("secret"), path("short"), path(""), std::string("/dev/zero"), std::string("a.xdf")}) {
    part.set_file(file);
    for (const char* what : {"export/xdf/1", "export/csv", "report"}) EXPECT_GE(get(what).status, 400U) << file << ' ' << what;
  }
}

TEST_F(ArchiveTest, WhatTheDaemonSays_BecomesAStatus) {
  EXPECT_EQ(get("report").status, 404U);
  add_session({});
  EXPECT_EQ(get("report").status, 404U) << "nothing was recorded";
  sessions_["other"] = sessions_[kId];
  EXPECT_EQ(get("report", "GET", "other").status, 500U) << "it is another session";
}

TEST_F(ArchiveTest, PathThatLeadsNowhere_IsNotAskedFor) {
  add_standing();
  for (const char* what : {"", "nothing", "report/", "report/../session.html", "report/.hidden", "report/a/b", "report/a b", "export",
                           "export/xdf", "export/xdf/", "export/xdf/0", "export/xdf/-1", "export/xdf/1x", "export/xdf/99999999999",
                           "export/xdf/1/2", "export/csv/1", "export/zip"}) {
    EXPECT_EQ(get(what).status, 404U) << what;
  }
  for (const std::string& id :
       {std::string(), std::string("a b"), std::string(".."), std::string("a'b"), std::string("\xff"), std::string(129, 'a')}) {
    EXPECT_EQ(get("report", "GET", id).status, 404U) << id;
  }
  EXPECT_EQ(asked_, 0);
  EXPECT_EQ(get("report", "DELETE").status, 405U);
}

}  // namespace
}  // namespace dts::gateway
