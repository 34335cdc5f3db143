// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <mutex>

#include "ctl/sway_reading.h"
#include "unit/ctl/run_fixture.h"

namespace dts::ctl {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

void add_measure(v1::Sway& sway, const char* symbol, double value, const char* unit) {
  v1::SwayMeasure& measure = *sway.add_measures();
  measure.set_symbol(symbol);
  measure.set_value(value);
  measure.set_unit(unit);
}

v1::SessionRecord session_of(const std::string& id, std::int64_t started_utc_ns, double mvelo, const std::string& duration = "20") {
  v1::SessionRecord session;
  session.set_session_id(id);
  session.set_rig("floor");
  session.set_protocol("quiet-standing");
  session.set_subject("P017");
  session.set_state("complete");
  session.set_started_utc_ns(started_utc_ns);
  v1::TrialRecord& trial = *session.add_trials();
  trial.set_trial(1);
  trial.set_attempt(1);
  trial.set_condition("eyes-open");
  trial.set_outcome("done");
  v1::Sway& sway = *trial.mutable_sway();
  sway.set_duration_s(20.0);
  sway.set_rate_hz(100.0);
  sway.set_is_valid(false);
  sway.set_flags(v1::SWAY_FLAG_MOVED);
  add_measure(sway, "MVELO", mvelo, "mm/s");
  add_measure(sway, "RDIST", 7.5, "mm");
  for (const auto& [name, value, unit] :
       {std::tuple("MVELO", mvelo, "mm/s"), {"RDIST", mvelo / 8.0, "mm"}, {"MFREQ", 20.0 - mvelo, "Hz"}}) {
    v1::SessionResult& figure = *session.add_results();
    figure.set_name(std::string("eyes-open/") + name);
    figure.set_value(value);
    figure.set_unit(unit);
    figure.set_details("{\"trials\":1,\"duration_s\":" + duration + "}");
  }
  return session;
}

class SwayViewTest : public RunTest {
 protected:
  std::vector<std::string> answer(const v1::Request& request) {
    const std::lock_guard lock(mutex_);
    return {testing::reply(request, [&](v1::Response& response) {
      if (request.has_list_sessions()) {
        asked_subject_ = request.list_sessions().subject();
        for (const auto& [id, session] : sessions_) *response.mutable_sessions()->add_sessions() = session;
      } else if (sessions_.contains(request.show_session().session_id())) {
        *response.mutable_session_record() = sessions_.at(request.show_session().session_id());
      }
    })};
  }

  std::mutex mutex_;
  std::string asked_subject_;
  std::map<std::string, v1::SessionRecord> sessions_{{"s1", session_of("s1", 2'000'000'000'000'000'000, 12.0)},
                                                     {"s2", session_of("s2", 1'000'000'000'000'000'000, 8.0)}};
  testing::FakeController daemon_{control_, [this](const v1::Request& asked, int) { return answer(asked); }};
};

TEST_F(SwayViewTest, ShowHasTheMeasuresOfEachTrialAndItsFlags) {
  EXPECT_EQ(run_with({"session", "show", "s1"}), cli::kOk);
  EXPECT_THAT(out(), ::testing::ContainsRegex(" 12[.]00 +7[.]50 .*moved"));
  EXPECT_EQ(run_with({"session", "show", "s1", "--json"}), cli::kOk);
  EXPECT_EQ(json().at("trials").at(0).at("sway").at("flags").at(0), "moved");
  EXPECT_EQ(json().at("trials").at(0).at("sway").at("measures").at(0).at("symbol"), "MVELO");
  EXPECT_EQ(json().at("trials").at(0).at("sway").at("measures").at(0).at("value"), 12.0);
}

TEST_F(SwayViewTest, CompareHasTheOldestFirstAndTheChange) {
  EXPECT_EQ(run_with({"session", "compare", "s1", "s2"}), cli::kOk);
  EXPECT_THAT(out(), HasSubstr("eyes-open/MVELO  mm/s                8.000               12.000  +4.00 (+50 %)\n"));
  EXPECT_THAT(out(), HasSubstr("+0.50 (+50 %)\n"));
  EXPECT_THAT(out(), HasSubstr("-4.00 (-33 %)\n"));
  EXPECT_THAT(talk(), Not(HasSubstr("warning")));
  EXPECT_EQ(run_with({"session", "compare", "--subject", "P017", "--json"}), cli::kOk);
  EXPECT_EQ(asked_subject_, "P017");
  EXPECT_EQ(json().at("sessions").at(0).at("session_id"), "s2");
  EXPECT_EQ(json().at("figures").at(0).at("values"), nlohmann::json::parse("[8.0, 12.0]"));
  EXPECT_EQ(json().at("figures").at(0).at("percent").at(0), 50.0);
}

TEST_F(SwayViewTest, CompareOfAFigureThatOneSessionLacks_HasNoDifference) {
  sessions_["s2"].mutable_results()->DeleteSubrange(0, 1);
  sessions_["s1"].mutable_results()->RemoveLast();
  EXPECT_EQ(run_with({"session", "compare", "s1", "s2", "--json"}), cli::kOk);
  const auto figures = json().at("figures");
  for (const auto& [index, values] : {std::pair(0, "[1.0, 1.5]"), {1, "[12.0, null]"}, {2, "[null, 12.0]"}}) {
    EXPECT_EQ(figures.at(index).at("values"), nlohmann::json::parse(values));
    EXPECT_EQ(figures.at(index).at("differences").at(0).is_null(), index != 0);
  }
}

TEST_F(SwayViewTest, CompareOfASubjectLeavesOtherRigsAndEmptySessionsOut) {
  sessions_["s3"] = session_of("s3", 500'000'000'000'000'000, 9.0);
  sessions_["s3"].set_rig("chair");
  sessions_["s4"] = session_of("s4", 400'000'000'000'000'000, 9.0);
  sessions_["s4"].clear_results();
  EXPECT_EQ(run_with({"session", "compare", "--subject", "P017", "--json"}), cli::kOk);
  EXPECT_EQ(json().at("sessions").size(), 2U);
  EXPECT_THAT(talk(), HasSubstr("2 sessions are left out"));
}

TEST_F(SwayViewTest, CompareSaysWhatDoesNotCompare) {
  sessions_["s1"] = session_of("s1", 2'000'000'000'000'000'000, 12.0, "60");
  sessions_["s1"].set_subject("P018");
  EXPECT_EQ(run_with({"session", "compare", "s1", "s2"}), cli::kOk);
  EXPECT_THAT(talk(), HasSubstr("eyes-open: trials last 20 in one session and 60 in another"));
  EXPECT_THAT(talk(), HasSubstr("different subjects"));
}

TEST_F(SwayViewTest, CompareSaysWhenALengthIsTrueOfOneSessionOnly) {
  sessions_["s1"].mutable_results(0)->set_details("{\"trials\":2}");  // of several lengths
  sessions_["s1"].mutable_results(0)->set_unit("cm/s");
  EXPECT_EQ(run_with({"session", "compare", "s1", "s2"}), cli::kOk);
  EXPECT_THAT(talk(), HasSubstr("eyes-open: trials are equally long in one session and not in another"));
  EXPECT_THAT(talk(), HasSubstr("eyes-open/MVELO has not the same unit in all sessions"));
}

TEST_F(SwayViewTest, CompareBelievesNoDetailsThatAreNested) {
  const std::string deep = std::string(100'000, '[') + std::string(100'000, ']');
  for (const char* id : {"s1", "s2"}) {
    sessions_[id].mutable_results(0)->set_details(R"({"duration_s":)" + (id[1] == '1' ? deep : deep.substr(1, deep.size() - 2)) + "}");
  }
  EXPECT_EQ(run_with({"session", "compare", "s1", "s2"}), cli::kOk);
  EXPECT_THAT(out(), HasSubstr("+4.00 (+50 %)"));
  EXPECT_THAT(talk(), Not(HasSubstr("[[")));
}

TEST_F(SwayViewTest, CompareOfOneOrNoneIsRefused) {
  EXPECT_EQ(run_with({"session", "compare"}), cli::kUsage);
  EXPECT_THAT(talk(), ::testing::StartsWith("dtsctl: which sessions?\n"));
  EXPECT_EQ(run_with({"session", "compare", "s1"}), 5);
}

TEST(SwayText, SaysWhatIsPreliminaryAndWhatIsInvalid) {
  v1::Sway sway;
  sway.set_is_preliminary(true);
  sway.set_is_valid(true);
  sway.set_duration_s(12.5);
  add_measure(sway, "AREA_CE", 99.0, "mm2");
  add_measure(sway, "MVELO", 8.123, "mm/s");
  EXPECT_EQ(sway_text(sway), "preliminary, no trial, 12.5 s: MVELO 8.12 mm/s");
  sway.set_is_preliminary(false);
  sway.set_is_valid(false);
  sway.set_trial(3);
  sway.set_condition("eyes-open");
  sway.set_flags(v1::SWAY_FLAG_MOVED);
  EXPECT_EQ(sway_text(sway), "trial 3 (eyes-open), 12.5 s: MVELO 8.12 mm/s  [moved]  INVALID");
  sway.set_problem("a gap");
  EXPECT_EQ(sway_text(sway), "trial 3 (eyes-open), no values: a gap");
}

}  // namespace
}  // namespace dts::ctl
