// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <sstream>

#include "fhir/bundle.h"
#include "unit/gateway/archive/archive_fixture.h"
#include "unit/gateway/archive/unpacked.h"

namespace dts::gateway {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ArchiveExportsTest = ArchiveTest;

TEST_F(ArchiveExportsTest, ExportOfATornRecording_SaysWhatIsMissing) {
  add_session({ctl::make_recording(path("a.xdf"), ctl::Ending::Killed)}).mutable_parts(0)->set_state(v1::PART_STATE_INTERRUPTED);

  const HttpResponse answer = get("export/csv");

  ASSERT_EQ(answer.status, 200U);
  const auto files = testing::unpacked(file_of(answer).path);
  ASSERT_TRUE(files.contains("DAMAGE.txt"));
  EXPECT_THAT(files.at("DAMAGE.txt"), HasSubstr("a.xdf.part: "));
}

TEST_F(ArchiveExportsTest, Csv_HasAllParts) {
  add_two_parts();

  const HttpResponse answer = get("export/csv");

  ASSERT_EQ(answer.status, 200U) << text_of(answer);
  EXPECT_EQ(answer.content_type, "application/zip");
  EXPECT_EQ(header_of(answer, "Content-Disposition"), "attachment; filename=\"" + kId + "-csv.zip\"");
  const auto files = testing::unpacked(file_of(answer).path);
  std::vector<std::string> names;
  for (const auto& [name, text] : files) names.push_back(name);
  const std::string begin = kId + "-csv/" + kId;
  EXPECT_THAT(names, ElementsAre(begin + ".2_events.csv", begin + ".2_raw.csv", begin + ".2_recording.json", begin + ".2_trials.csv",
                                 begin + "_events.csv", begin + "_raw.csv", begin + "_recording.json", begin + "_trials.csv"));
  EXPECT_THAT(files.at(begin + "_raw.csv"), HasSubstr("t_s,segment,scan,w1_v,w2_v\n0,0,0,0.5,0.5\n"));
}

TEST_F(ArchiveExportsTest, Bids_IsADatasetInAFolder) {
  add_two_parts();

  const HttpResponse answer = get("export/bids", "HEAD");

  ASSERT_EQ(answer.status, 200U);
  const auto files = testing::unpacked(file_of(answer).path);
  EXPECT_TRUE(files.contains(kId + "-bids/dataset_description.json"));
  EXPECT_TRUE(files.contains(kId + "-bids/participants.tsv"));
}

TEST_F(ArchiveExportsTest, Fhir_IsOneBundleOfAllPartsAndSaysThatItHasNoPdf) {
  add_two_parts();

  const HttpResponse answer = get("export/fhir");

  ASSERT_EQ(answer.status, 200U) << text_of(answer);
  EXPECT_EQ(header_of(answer, "Content-Disposition"), "attachment; filename=\"" + kId + "-fhir.zip\"");
  const auto files = testing::unpacked(file_of(answer).path);
  ASSERT_EQ(files.size(), 2U);
  const auto bundle = fhir::make_session_bundle({path("a.xdf"), path("b.xdf")}, "any", [](double) { return true; });
  ASSERT_TRUE(bundle.has_value());
  EXPECT_EQ(files.at(kId + "-fhir/" + kId + ".fhir.json"), bundle->text);
  EXPECT_THAT(files.at("NOTES.txt"), HasSubstr("The bundle has no PDF: "));
}

TEST_F(ArchiveExportsTest, FhirOfATornRecording_SaysWhatIsMissing) {
  add_session({ctl::make_recording(path("a.xdf"), ctl::Ending::Killed)}).mutable_parts(0)->set_state(v1::PART_STATE_INTERRUPTED);

  const auto files = testing::unpacked(file_of(get("export/fhir")).path);

  ASSERT_TRUE(files.contains("DAMAGE.txt"));
  EXPECT_THAT(files.at("DAMAGE.txt"), HasSubstr("a.xdf.part: "));
}

TEST_F(ArchiveExportsTest, C3dOfARecordingWithoutCentreOfPressure_SaysWhy) {
  add_two_parts();

  const HttpResponse answer = get("export/c3d");

  EXPECT_NE(answer.status, 200U);
  EXPECT_THAT(text_of(answer), HasSubstr("has no centre of pressure and no force"));
}

TEST_F(ArchiveExportsTest, ExportMadeAgain_IsTheSameBytes) {
  add_two_parts();
  const auto bytes_of = [](const HttpResponse& answer) {
    std::ostringstream bytes;
    bytes << std::ifstream(file_of(answer).path, std::ios::binary).rdbuf();
    return bytes.str();
  };
  const std::string first = bytes_of(get("export/bids"));
  sessions_[kId].mutable_parts(0)->set_sha256("not as before");

  const std::string second = bytes_of(get("export/bids"));

  EXPECT_EQ(cached().size(), 2U);
  EXPECT_GT(first.size(), 1000U);
  EXPECT_TRUE(first == second);
  EXPECT_EQ(first.substr(10, 4), std::string("\0\0\x21\0", 4)) << "the first of January 1980: no clock was asked";
}

TEST_F(ArchiveExportsTest, ExportUnderWay_IsShared) {
  add_two_parts();
  for (int count = 0; count < 20; ++count) begin("export/csv");

  const auto answers = wait_for(20);

  for (const HttpResponse& answer : answers) {
    ASSERT_EQ(answer.status, 200U);
    EXPECT_EQ(file_of(answer).path, file_of(answers.front()).path);
  }
  EXPECT_THAT(cached(), ElementsAre(file_of(answers.front()).path.filename().string()));
}

TEST_F(ArchiveExportsTest, MoreThanEightWaiting_AreSentAway) {
  for (int number = 0; number < 12; ++number) {
    const std::string id = "s" + std::to_string(number);
    add_session({ctl::make_recording(path(id + ".xdf"))}, id);
  }
  for (int number = 0; number < 12; ++number) begin("export/csv", "GET", "s" + std::to_string(number));

  ASSERT_EQ(answers_.size(), 3U) << "one is made, eight wait, three are told at once";
  for (const HttpResponse& answer : answers_) {
    EXPECT_EQ(answer.status, 503U);
    EXPECT_NE(header_of(answer, "Retry-After"), "");
  }
  const auto answers = wait_for(12);
  EXPECT_EQ(std::ranges::count(answers, 200U, &HttpResponse::status), 9);
}

TEST_F(ArchiveExportsTest, OldestExport_MakesRoomForNewOnes) {
  options_.cache_bytes = 100'000;  // half of it for zip files of about 2.5 kB, which stand for 20 kB of text
  open();
  std::vector<std::string> seen;
  for (int number = 0; number < 40; ++number) {
    const std::string id = "s" + std::to_string(number);
    add_session({ctl::make_recording(path(id + ".xdf"))}, id);
    const HttpResponse answer = get("export/csv", "GET", id);
    ASSERT_EQ(answer.status, 200U) << number << text_of(answer);
    seen.push_back(file_of(answer).path.string());
  }

  std::uintmax_t bytes = 0;
  for (const std::string& name : cached()) bytes += fs::file_size(options_.cache_directory / "dts-gateway-exports" / name);
  EXPECT_LE(bytes, 50'000U);
  EXPECT_FALSE(fs::exists(seen.front()));
  EXPECT_TRUE(fs::exists(seen.back()));
}

TEST_F(ArchiveExportsTest, ExportThatIsBeingSent_IsNotRemoved) {
  options_.cache_bytes = 100'000;
  open();
  std::vector<HttpResponse> under_way;
  unsigned last_status = 200;
  for (int number = 0; number < 60 && last_status == 200; ++number) {
    const std::string id = "s" + std::to_string(number);
    add_session({ctl::make_recording(path(id + ".xdf"))}, id);
    under_way.push_back(get("export/csv", "GET", id));
    last_status = under_way.back().status;
  }
  EXPECT_EQ(last_status, 503U) << "no room is left, and none can be made";
  under_way.pop_back();
  ASSERT_FALSE(under_way.empty());
  for (const HttpResponse& answer : under_way) EXPECT_TRUE(fs::exists(file_of(answer).path));

  file_of(under_way.front()).when_done();

  add_session({ctl::make_recording(path("more.xdf"))}, "more");
  EXPECT_EQ(get("export/csv", "GET", "more").status, 200U);
  EXPECT_FALSE(fs::exists(file_of(under_way.front()).path));
}

TEST_F(ArchiveExportsTest, ExportThatIsTooLarge_IsRefusedAndLeavesNothing) {
  options_.cache_bytes = 10'000;
  open();
  add_two_parts();

  for (const char* what : {"export/csv", "export/bids"}) {
    const HttpResponse answer = get(what);
    EXPECT_EQ(answer.status, 507U) << "and not 429: waiting does not help";
    EXPECT_THAT(json_of(answer)["what"], HasSubstr("too large"));
    EXPECT_THAT(json_of(answer)["hint"], HasSubstr("dtsctl session export " + kId));
  }
  EXPECT_TRUE(cached().empty());
}

TEST_F(ArchiveExportsTest, DamagedRecording_IsNotExported) {
  const std::string file = add_two_parts().parts(1).file();
  fs::permissions(file, fs::perms::owner_write, fs::perm_options::add);
  {
    std::fstream stream(file, std::ios::binary | std::ios::in | std::ios::out);
    stream.seekp(static_cast<std::streamoff>(fs::file_size(file) / 2));
    stream.put('\x55');
  }

  EXPECT_EQ(get("export/csv").status, 422U);

  EXPECT_TRUE(cached().empty());
}

TEST_F(ArchiveExportsTest, Start_RemovesWhatWasLeftAndNothingElse) {
  add_two_parts();
  fs::create_directories(options_.cache_directory / "dts-gateway-exports" / "work-1" / "data");
  std::ofstream(options_.cache_directory / "dts-gateway-exports" / "work-1" / "data" / "x.csv") << "x";
  std::ofstream(options_.cache_directory / "mine") << "x";

  open();

  EXPECT_TRUE(cached().empty());
  EXPECT_TRUE(fs::exists(options_.cache_directory / "mine"));
  EXPECT_EQ(fs::status(options_.cache_directory / "dts-gateway-exports").permissions(), fs::perms::owner_all);
  archive_.reset();
  EXPECT_FALSE(fs::exists(options_.cache_directory / "dts-gateway-exports")) << "nothing about anybody stays behind";
}

TEST_F(ArchiveExportsTest, CacheThatCannotBeWritten_IsRefused) {
  std::ofstream(path("file")) << "x";

  const auto opened = Archive::open(io_, {.cache_directory = path("file")}, [](const auto&, const auto&) {});

  ASSERT_FALSE(opened.has_value());
  EXPECT_EQ(opened.error().code, client::ErrorCode::Failed);
}

TEST_F(ArchiveExportsTest, GoneWhileSomethingIsMade_TellsNobody) {
  add_two_parts();
  begin("export/csv");

  archive_.reset();
  io_.poll();

  EXPECT_TRUE(answers_.empty());
}

}  // namespace
}  // namespace dts::gateway
