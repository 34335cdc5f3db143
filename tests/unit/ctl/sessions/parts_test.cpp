// SPDX-License-Identifier: Apache-2.0
// Commands about the recordings of a session that the daemon knows.
#include <filesystem>

#include "made_recording.h"
#include "record/xdf/recovery.h"
#include "unit/ctl/run_fixture.h"

namespace dts::ctl {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class PartsTest : public RunTest {
 protected:
  PartsTest() {
    session_.set_session_id("s1");
    session_.set_rig("floor");
  }
  [[nodiscard]] std::string path(const std::string& name) const { return (directory_.path() / name).string(); }
  void add_part(const std::string& file, v1::PartState state = v1::PART_STATE_COMPLETE, const std::string& sha256 = {}) {
    v1::SessionPart& part = *session_.add_parts();
    part.set_part(static_cast<std::uint32_t>(session_.parts_size()));
    part.set_state(state);
    part.set_file(file);
    part.set_sha256(sha256);
  }

  v1::SessionRecord session_;
  testing::FakeController daemon_{control_, [this](const v1::Request& request, int) {
                                    return std::vector{testing::reply(request, [&](v1::Response& response) {
                                      if (request.show_session().session_id() == "s1") {
                                        *response.mutable_session_record() = session_;
                                        return;
                                      }
                                      response.mutable_error()->set_code(v1::ERROR_CODE_NOT_FOUND);
                                      response.mutable_error()->set_what("no session of that id");
                                    })};
                                  }};
};

TEST_F(PartsTest, VerifyOfASession_AllPartsAreReadAndComparedWithTheCatalogue) {
  const std::string first = make_recording(path("a.xdf"));
  add_part(first, v1::PART_STATE_COMPLETE, record::verify(first)->sha256);
  add_part(make_recording(path("a.2.xdf"), Ending::Incomplete, 2), v1::PART_STATE_INCOMPLETE);

  EXPECT_EQ(run_with({"session", "verify", "s1", "--json"}), cli::kOk);

  EXPECT_EQ(json().at("files").size(), 2U);
  EXPECT_EQ(json().at("files").at(0).at("part"), 1);
  EXPECT_EQ(json().at("files").at(1).at("state"), "incomplete");
  EXPECT_EQ(json().at("files").at(1).at("valid_trials"), 1);
  EXPECT_EQ(json().at("files").at(1).at("planned_trials"), 2);
  EXPECT_EQ(json().at("valid_trials"), 2);
  EXPECT_EQ(json().at("planned_trials"), 2) << "one plan, whatever the number of parts";
  EXPECT_EQ(json().at("lost_scans"), 0);
  EXPECT_EQ(json().at("gaps"), 0);
}

TEST_F(PartsTest, VerifyOfAnotherFileThanWasRecorded_ExitsWithSeven) {
  add_part(make_recording(path("a.xdf")), v1::PART_STATE_COMPLETE, std::string(64, 'a'));

  EXPECT_EQ(run_with({"session", "verify", "s1"}), 7);

  EXPECT_THAT(out(), HasSubstr("DAMAGED"));
  EXPECT_THAT(out(), HasSubstr("not the file that was recorded"));
}

TEST_F(PartsTest, ExportOfASession_AllPartsAreExported) {
  add_part(make_recording(path("a.xdf")));
  add_part(make_recording(path("a.2.xdf"), Ending::Closed, 2));

  EXPECT_EQ(run_with({"session", "export", "s1", "--format", "csv", "--out", path("tables")}), cli::kOk);

  EXPECT_TRUE(fs::exists(path("tables/20261121T144525Z-floor-1_raw.csv")));
  EXPECT_TRUE(fs::exists(path("tables/20261121T144525Z-floor-1.2_raw.csv")));
}

TEST_F(PartsTest, ExportThatFailsAtTheSecondPart_SaysWhatIsThereAlready) {
  add_part(make_recording(path("a.xdf")));
  add_part(make_recording(path("b.xdf")));  // claims to be the first part too: its files exist by then

  EXPECT_EQ(run_with({"session", "export", "s1", "--format", "csv", "--out", path("tables")}), 6);

  EXPECT_THAT(talk(), HasSubstr("exported before: " + path("tables/20261121T144525Z-floor-1_raw.csv")));
  EXPECT_EQ(out(), "");
}

TEST_F(PartsTest, FileThatIsNotHere_SaysThatItLiesOnTheDaemonsHost) {
  add_part(path("elsewhere.xdf"));

  EXPECT_EQ(run_with({"session", "export", "s1", "--format", "csv"}), cli::kFailed);

  EXPECT_THAT(talk(), HasSubstr("daemon's host"));
}

TEST_F(PartsTest, FileThatIsGone_ExitsWithSeven) {
  add_part(path("gone.xdf"), v1::PART_STATE_MISSING);

  EXPECT_EQ(run_with({"session", "verify", "s1"}), 7);
}

TEST_F(PartsTest, SessionStillRecording_ExitsWithWrongState) {
  add_part(make_recording(path("a.xdf"), Ending::Killed), v1::PART_STATE_RECORDING);

  EXPECT_EQ(run_with({"session", "verify", "s1"}), 6);

  EXPECT_THAT(talk(), HasSubstr("dtsctl session stop --rig floor"));
}

TEST_F(PartsTest, UnknownOrUnrecordedSession_ExitsWithFive) {
  EXPECT_EQ(run_with({"session", "verify", "s2"}), 5);
  EXPECT_EQ(run_with({"session", "verify", "s1"}), 5) << "without parts";
}

}  // namespace
}  // namespace dts::ctl
