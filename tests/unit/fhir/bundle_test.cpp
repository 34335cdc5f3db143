// SPDX-License-Identifier: Apache-2.0
#include "fhir/bundle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "made_session.h"
#include "report/chair_data.h"
#include "report/intended_use.h"
#include "report/session_data.h"
#include "support/committed_text.h"
#include "unit/record/xdf_fixture.h"
#include "unit/report/made_reaching.h"

namespace dts::fhir {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class BundleTest : public ::testing::Test {
 protected:
  static bool always(double) { return true; }
  [[nodiscard]] std::string write(const report::MadeStanding& made, const std::string& name = "a.xdf") {
    return report::write_standing(directory_ / name, made);
  }
  [[nodiscard]] static std::string text_of(const std::vector<std::string>& files, const std::optional<std::string>& pdf = std::nullopt) {
    const auto bundle = make_bundle({.files = files, .pdf = pdf}, always);
    EXPECT_TRUE(bundle.has_value()) << (bundle ? "" : core::to_string(bundle.error()));
    return bundle ? bundle->text : "{}";
  }
  [[nodiscard]] static Json bundle_of(const std::string& file) { return Json::parse(text_of({file})); }
  [[nodiscard]] Json bundle_of(const report::MadeStanding& made) { return bundle_of(write(made)); }

  record::xdf_test::Folder directory_;
};

TEST_F(BundleTest, HasPatientDeviceReportResultsAndTrials) {
  RecordProperty("requirement", "REP-11");
  const Json bundle = bundle_of(made_session());

  EXPECT_EQ(bundle["resourceType"], "Bundle");
  EXPECT_EQ(bundle["type"], "collection");
  std::vector<std::string> types;
  for (const Json& entry : bundle["entry"]) types.push_back(entry["resource"]["resourceType"]);
  EXPECT_THAT(types, ElementsAre("Patient", "Device", "DiagnosticReport", "Observation", "Observation", "Observation", "Observation",
                                 "Observation"));
  const Json report = resources_of(bundle, "DiagnosticReport").front();
  EXPECT_EQ(report["status"], "partial");
  EXPECT_EQ(report["result"].size(), 5U);
  EXPECT_FALSE(report.contains("presentedForm"));
  EXPECT_FALSE(report.contains("conclusion"));
  EXPECT_EQ(report["text"]["status"], "additional");
  EXPECT_THAT(report["text"]["div"].get<std::string>(), HasSubstr(std::string(report::kIntendedUse)));
}

TEST_F(BundleTest, EveryReference_IsInTheBundle) {
  const Json bundle = bundle_of(made_session());

  std::vector<std::string> urls;
  for (const Json& entry : bundle["entry"]) {
    urls.push_back(entry["fullUrl"]);
    EXPECT_EQ(urls.back(), "urn:uuid:" + entry["resource"]["id"].get<std::string>());
  }
  std::size_t count = 0;
  const std::string text = bundle.dump();
  const std::string key = "\"reference\":\"";
  for (std::size_t at = text.find(key); at != std::string::npos; at = text.find(key, at + 1), ++count) {
    EXPECT_THAT(urls, ::testing::Contains(text.substr(at + key.size(), 45)));
  }
  EXPECT_EQ(count, 5U * 2U + 6U + 4U) << "subject and device of 5, subject and results of the report, sources of the results";
}

TEST_F(BundleTest, ATrialOfStanding_HasItsMeasuresUnitsAndTimes) {
  const Json bundle = bundle_of(made_session());

  const Json trial = observation_of(bundle, "standing-trial", "trial-number", 1);
  EXPECT_EQ(trial["status"], "final");
  EXPECT_EQ(trial["effectivePeriod"]["start"], "2026-11-21T14:45:27.000000Z");
  EXPECT_EQ(trial["effectivePeriod"]["end"], "2026-11-21T14:45:47.000000Z");
  EXPECT_EQ(component(trial, "condition")["valueString"], "eyes-open");
  EXPECT_EQ(component(trial, "eyes")["valueString"], "open");
  EXPECT_EQ(component(trial, "duration_s")["valueQuantity"]["value"], 20.0);
  EXPECT_EQ(component(trial, "MVELO")["valueQuantity"].dump(),
            R"({"value":8.38123,"unit":"mm/s","system":"http://unitsofmeasure.org","code":"mm/s"})");
  EXPECT_EQ(component(trial, "PEA95_F")["valueQuantity"]["code"], "mm2");
  EXPECT_EQ(component(trial, "PEA95_F")["valueQuantity"]["unit"], "mm²");
  EXPECT_FALSE(trial.contains("interpretation"));
  EXPECT_FALSE(trial.contains("note"));
}

TEST_F(BundleTest, AMeasureWithoutAValue_HasAReason) {
  const Json bundle = bundle_of(made_session());

  const Json trial = observation_of(bundle, "standing-trial", "trial-number", 2);
  const Json entropy = component(trial, "SAMPEN_AP_20HZ");
  EXPECT_FALSE(entropy.contains("valueQuantity"));
  EXPECT_EQ(code_of(entropy["dataAbsentReason"]), "not-applicable");
  EXPECT_NE(entropy["dataAbsentReason"]["text"], "");
  EXPECT_TRUE(component(trial, "AP_USE").is_null());
  ASSERT_EQ(trial["note"].size(), 1U);
  EXPECT_THAT(trial["note"][0]["text"].get<std::string>(), HasSubstr("missing"));
}

TEST_F(BundleTest, ResultsOfTheSession_NameTheirTrials) {
  const Json bundle = bundle_of(made_session());

  const Json mean = observation_of(bundle, "condition-mean", "condition", "eyes-open");
  EXPECT_EQ(component(mean, "MVELO")["valueQuantity"]["value"], 8.38123);
  EXPECT_EQ(mean["derivedFrom"].size(), 1U);
  const Json quotient = observation_of(bundle, "romberg-quotient", "condition", "feet=two");
  EXPECT_EQ(component(quotient, "ROMBERG_MVELO")["valueQuantity"]["value"], 1.4616);
  EXPECT_TRUE(component(quotient, "MVELO").is_null()) << "a quotient is not a velocity";
  EXPECT_EQ(quotient["derivedFrom"].size(), 2U);
}

TEST_F(BundleTest, AMean_NamesNoTrialThatAGapCutShort) {
  report::MadeStanding made = made_session();
  report::add_trial(made, 3, 46.0, 3.0, "eyes-open", {{"eyes", "open"}, {"feet", "two"}});
  made.events.push_back(sway_event(3, "eyes-open", {{"eyes", "open"}, {"feet", "two"}}, {{posturography::Measure::Mvelo, 20.0}},
                                   posturography::sway_flag::kCutAtGap));
  made.events.back().set_scan(4900);

  const Json bundle = bundle_of(made);

  const Json mean = observation_of(bundle, "condition-mean", "condition", "eyes-open");
  const Json whole = observation_of(bundle, "standing-trial", "trial-number", 1);
  ASSERT_EQ(mean["derivedFrom"].size(), 1U);
  EXPECT_THAT(mean["derivedFrom"][0].dump(), HasSubstr(whole["id"].get<std::string>()));
}

TEST_F(BundleTest, AResultWithLimits_SaysThem) {
  report::MadeStanding made = made_session();
  made.events.push_back(
      session::to_event(session::SessionFigure{.name = "load_n",
                                               .value = 627.2,
                                               .unit = "N",
                                               .details = R"({"note":"about 64 kg, corrected for two feet without a stance width"})"}));
  made.events.back().set_scan(4900);

  const Json summary = observation_of(bundle_of(made), "session-summary");

  ASSERT_EQ(summary["note"].size(), 1U);
  EXPECT_EQ(summary["note"][0]["text"], "load_n: about 64 kg, corrected for two feet without a stance width");
}

TEST_F(BundleTest, AQuotientOfAStance_NamesOnlyTheTrialsOfThatStance) {
  report::MadeStanding made = made_session();
  made.events.resize(2);
  for (v1::Event& event : made.events) (*event.mutable_sway()->mutable_labels())["surface"] = "firm";
  const std::vector<std::pair<std::string, std::size_t>> sources_of_stances{
      {"feet=two,surface=firm", 2}, {"feet=two,surface=foam", 0}, {"feet=two,shoes=none", 0}, {"feet", 0}};
  for (const auto& [stance, sources] : sources_of_stances) {
    made.events.push_back(session::to_event(session::SessionFigure{.name = "romberg/" + stance + "/MVELO", .value = 1.5, .unit = "1"}));
    made.events.back().set_scan(4900);
  }

  const Json bundle = bundle_of(made);

  for (const auto& [stance, sources] : sources_of_stances) {
    const Json quotient = observation_of(bundle, "romberg-quotient", "condition", stance);
    ASSERT_FALSE(quotient.is_null()) << stance;
    EXPECT_EQ(quotient.value("derivedFrom", Json::array()).size(), sources) << stance;
  }
}

TEST_F(BundleTest, ATimeThatCannotBe_IsNotThere) {
  for (const std::int64_t offset_ns : {std::int64_t{-1'000'000'000'000'000}, std::int64_t{9'100'000'000'000'000'000}}) {
    report::MadeStanding made = made_session();
    made.facts.utc_minus_monotonic_ns = offset_ns;
    EXPECT_FALSE(observation_of(bundle_of(write(made, std::to_string(offset_ns) + ".xdf")), "standing-trial").contains("effectivePeriod"))
        << offset_ns;
  }
}

TEST_F(BundleTest, AResultThatThisVersionDoesNotKnow_IsText) {
  report::MadeStanding made = made_session();
  made.events.push_back(session::to_event(session::SessionFigure{.name = "later/thing", .value = 1.5, .unit = "furlong"}));
  made.events.back().set_scan(4900);

  const Json one = observation_of(bundle_of(made), "later");

  EXPECT_EQ(one["code"].dump(), R"({"text":"later"})");
  EXPECT_EQ(component(one, "thing")["valueQuantity"].dump(), R"({"value":1.5,"unit":"furlong"})");
}

TEST_F(BundleTest, APersonWhoSteppedOff_HasNoValues) {
  report::MadeStanding made = made_session();
  made.events[1] =
      sway_event(2, "eyes-closed", {{"eyes", "closed"}}, {{posturography::Measure::Mvelo, 99.0}}, posturography::sway_flag::kSteppedOff);
  made.events[1].set_scan(4900);

  const Json trial = observation_of(bundle_of(made), "standing-trial", "trial-number", 2);

  EXPECT_EQ(trial["status"], "final");
  EXPECT_EQ(code_of(trial["dataAbsentReason"]), "error");
  EXPECT_THAT(trial["dataAbsentReason"]["text"].get<std::string>(), HasSubstr("stepped off"));
  EXPECT_TRUE(component(trial, "MVELO").is_null());
  EXPECT_FALSE(component(trial, "condition").is_null());
}

TEST_F(BundleTest, AttemptsThatWereNeverDone_AreNotThere) {
  report::MadeStanding made = made_session();
  made.steps[1].phase = "rejected";
  made.steps[3].phase = "aborted";

  const Json bundle = bundle_of(made);

  EXPECT_TRUE(observation_of(bundle, "standing-trial").is_null());
}

TEST_F(BundleTest, ATrialThatACorrectionTakesBack_IsWithdrawnWithoutValues) {
  const std::string file = write(made_session());
  correct_outcome(file, 2, "rejected");

  const Json bundle = bundle_of(file);

  const Json trial = observation_of(bundle, "standing-trial", "trial-number", 2);
  EXPECT_EQ(trial["status"], "entered-in-error");
  EXPECT_TRUE(component(trial, "MVELO").is_null());
  EXPECT_THAT(trial["dataAbsentReason"]["text"].get<std::string>(), HasSubstr("rejected"));
  EXPECT_EQ(observation_of(bundle, "standing-trial", "trial-number", 1)["status"], "final");
  EXPECT_TRUE(observation_of(bundle, "romberg-quotient").is_null()) << "one of its trials does not count any more";
  EXPECT_EQ(observation_of(bundle, "condition-mean", "condition", "eyes-open")["status"], "amended");
  const Json report = resources_of(bundle, "DiagnosticReport").front();
  EXPECT_THAT(report["result"].dump(), Not(HasSubstr(trial["id"].get<std::string>())));
  EXPECT_EQ(report["issued"], "2026-11-21T22:26:40.000000Z");
}

TEST_F(BundleTest, ATrialThatACorrectionTakesIn_IsAmended) {
  report::MadeStanding made = made_session();
  made.steps[3].phase = "rejected";
  const std::string file = write(made);
  const std::string before = observation_of(bundle_of(file), "standing-trial", "trial-number", 1)["id"];
  correct_outcome(file, 2, "done");

  const Json bundle = bundle_of(file);

  EXPECT_EQ(observation_of(bundle, "standing-trial", "trial-number", 2)["status"], "amended");
  EXPECT_EQ(observation_of(bundle, "standing-trial", "trial-number", 1)["id"], before) << "a corrected session keeps its UUIDs";
}

/// Every member of the resources, but for the measures of standing, which `codes_test` lists.
TEST_F(BundleTest, OfAReach_IsTheCommittedText) {
  report::MadeStanding made = made_reaching(made_reach(core::TrunkClass::Moderate));
  made.facts.fields = {{"side", "right"}};
  made.facts.firmware = "7";
  made.facts.calibration_id = "c-1";
  made.facts.model_sha256 = "abc";
  made.events[0].mutable_trial_result()->mutable_reach()->clear_smoothness();

  test::expect_committed("unit/fhir/reaching_bundle.json", bundle_of(made).dump(1) + "\n");
}

TEST_F(BundleTest, ARejectedReach_HasNeitherClassNorAngle) {
  const auto reach = made_reach(core::TrunkClass::Rejected, core::class_reason::kUnsure);

  const Json trial = observation_of(bundle_of(made_reaching(reach)), "reaching-trial");

  for (const char* code : {"trunk-class", "trunk_deg", "trunk-interval90_deg"}) {
    const Json one = component(trial, code);
    EXPECT_EQ(one.size(), 2U) << one.dump() << ": a code and a reason";
    EXPECT_EQ(one["dataAbsentReason"]["text"], "the reach was rejected: unsure") << code;
  }
  EXPECT_EQ(component(trial, "p3_mm")["valueQuantity"]["value"], 5.0);
}

TEST_F(BundleTest, ASmallReach_IsNoneOrMinor) {
  const auto reach = made_reach(core::TrunkClass::Minor, core::class_reason::kMinor);

  const Json trial = observation_of(bundle_of(made_reaching(reach)), "reaching-trial");

  EXPECT_EQ(code_of(component(trial, "trunk-class")["valueCodeableConcept"]), "trunk-none-or-minor");
}

TEST_F(BundleTest, ATrialWithoutAReachWhereNoneWasExpected_SaysSo) {
  auto reach = made_reach(core::TrunkClass::Moderate);
  reach.reach.reset();
  reach.movement.reset();
  reach.expected = core::TrunkClass::None;

  const Json trial = observation_of(bundle_of(made_reaching(reach)), "reaching-trial");

  EXPECT_EQ(component(trial, "reach-found")["valueBoolean"], false);
  EXPECT_EQ(code_of(component(trial, "trunk-class")["dataAbsentReason"]), "not-applicable");
  EXPECT_TRUE(component(trial, "p3_mm").is_null());
}

TEST_F(BundleTest, AReachingSessionOfDtsd01_HasItsClasses) {
  const Json bundle = bundle_of(test::committed_file("unit/record/recordings_0_1/reaching.xdf").string());

  const Json trial = observation_of(bundle, "reaching-trial", "trial-number", 1);
  EXPECT_EQ(code_of(component(trial, "trunk-class")["valueCodeableConcept"]), "trunk-maximum");
  EXPECT_EQ(component(trial, "trunk_deg")["valueQuantity"]["value"], 55.789);
  EXPECT_EQ(component(trial, "trunk-interval90_deg")["valueRange"]["high"]["value"], 64.0567);
}

TEST_F(BundleTest, ThePatient_IsTheSubjectIdAndNothingElse) {
  RecordProperty("requirement", "REP-10");
  report::MadeStanding made = made_session();
  made.facts.label = "Mrs Example";
  made.facts.fields = {{"weight_kg", "61"}, {"side", "Mrs Example's left"}};

  const std::string text = text_of({write(made)});

  const Json patient = resources_of(Json::parse(text), "Patient").front();
  EXPECT_EQ(patient.size(), 3U) << patient.dump();
  EXPECT_EQ(patient["identifier"].dump(), R"([{"use":"secondary","type":{"text":"Subject ID, assigned by the clinic"},"value":"P017"}])");
  EXPECT_THAT(text, Not(HasSubstr("Example")));
  EXPECT_THAT(text, Not(HasSubstr("weight")));
}

TEST_F(BundleTest, WithoutASubject_ThePatientHasNoIdentifier) {
  report::MadeStanding made = made_session();
  made.facts.subject = "";

  EXPECT_FALSE(resources_of(bundle_of(made), "Patient").front().contains("identifier"));
}

TEST_F(BundleTest, ACorrectedSubject_IsThatOfThePatient) {
  const std::string file = write(made_session());
  const Json before = bundle_of(file);
  record::Corrections corrections{.session_id = kSession};
  corrections.add(
      {.utc_ns = 1, .who = "local", .field = record::CorrectedField::Subject, .old_value = "P017", .new_value = "P018", .reason = "test"});
  ASSERT_TRUE(record::write_corrections(record::corrections_file(file, kSession), corrections));

  const std::string text = text_of({file});

  EXPECT_EQ(resources_of(Json::parse(text), "Patient").front()["identifier"][0]["value"], "P018");
  EXPECT_THAT(text, Not(HasSubstr("P017")));
  const Json after = Json::parse(text);
  const std::string id = resources_of(after, "Patient").front()["id"];
  EXPECT_NE(id, resources_of(before, "Patient").front()["id"].get<std::string>()) << "it is another person";
  EXPECT_EQ(resources_of(after, "DiagnosticReport").front()["id"], resources_of(before, "DiagnosticReport").front()["id"]);
  for (const Json& one : resources_of(after, "Observation")) {
    EXPECT_EQ(one["status"], "amended");
    EXPECT_EQ(one["subject"]["reference"], "urn:uuid:" + id);
  }
}

TEST_F(BundleTest, ThePdf_IsInTheReport) {
  const Json bundle = Json::parse(text_of({write(made_session())}, "%PDF-1"));

  const Json form = resources_of(bundle, "DiagnosticReport").front()["presentedForm"];
  ASSERT_EQ(form.size(), 1U);
  EXPECT_EQ(form[0]["contentType"], "application/pdf");
  EXPECT_EQ(form[0]["data"], "JVBERi0x");
  EXPECT_EQ(form[0]["size"], 6);
}

TEST_F(BundleTest, OnlyASimulatedRig_HasTheLabelOfTestData) {
  RecordProperty("requirement", "REP-3");
  report::MadeStanding made = made_session();
  EXPECT_THAT(bundle_of(made).dump(), Not(HasSubstr("HTEST")));
  made.facts.device_uri = "sim:floor";

  const Json bundle = bundle_of(write(made, "b.xdf"));

  EXPECT_EQ(bundle["meta"]["security"][0]["code"], "HTEST");
  for (const Json& entry : bundle["entry"]) EXPECT_EQ(entry["resource"]["meta"]["security"][0]["code"], "HTEST");
}

TEST_F(BundleTest, AReplayedRecording_HasTheLabelOfTestData) {
  report::MadeStanding made = made_session();
  made.facts.device_uri = "replay:/var/lib/dtsd/a.xdf";

  const Json bundle = bundle_of(write(made, "b.xdf"));

  for (const Json& entry : bundle["entry"]) EXPECT_EQ(entry["resource"]["meta"]["security"][0]["code"], "HTEST");
  EXPECT_THAT(bundle.dump(), HasSubstr("A recording was played on this rig"));
}

TEST_F(BundleTest, TheSameRecording_GivesTheSameBytesInAnotherFolder) {
  const std::string file = write(made_session());
  const std::string elsewhere = directory_ / "folder";
  std::filesystem::create_directory(elsewhere);
  std::filesystem::copy_file(file, elsewhere + "/b.xdf");
  std::filesystem::copy_file(file + ".idx", elsewhere + "/b.xdf.idx");

  EXPECT_EQ(text_of({file}), text_of({elsewhere + "/b.xdf"}));
}

TEST_F(BundleTest, RecordingsOfTwoClinics_HaveOtherUuids) {
  report::MadeStanding other = made_session();
  other.facts.boot_id = "another computer";

  const Json one = bundle_of(made_session());
  const Json two = bundle_of(write(other, "b.xdf"));

  EXPECT_NE(one["entry"][0]["fullUrl"], two["entry"][0]["fullUrl"]) << "the same subject ID in two clinics";
}

TEST_F(BundleTest, TwoParts_AreOneBundle) {
  report::MadeStanding second = made_session();
  second.facts.part = 2;
  second.facts.started_utc_ns += 60'000'000'000;
  const std::vector<std::string> files{write(made_session()), write(second, "b.xdf")};

  const Json bundle = Json::parse(text_of(files));

  EXPECT_EQ(resources_of(bundle, "Patient").size(), 1U);
  EXPECT_EQ(resources_of(bundle, "Device").size(), 1U) << "it is the same rig";
  EXPECT_EQ(resources_of(bundle, "Observation").size(), 4U) << "the trials: results of one part are not those of the session";
  std::vector<int> parts;
  for (const Json& one : resources_of(bundle, "Observation")) {
    EXPECT_EQ(one["status"], "final");
    parts.push_back(component(one, "part")["valueInteger"]);
  }
  EXPECT_THAT(parts, ElementsAre(1, 1, 2, 2));
  EXPECT_EQ(bundle.dump().find("null"), std::string::npos);
}

TEST_F(BundleTest, TrialsOfAnInterruptedPart_ArePreliminary) {
  report::MadeStanding interrupted = made_session();
  interrupted.events.resize(2);  // without the results of the session
  report::MadeStanding second = made_session();
  second.facts.part = 2;

  const Json bundle = Json::parse(text_of({write(interrupted), write(second, "b.xdf")}));

  std::vector<std::string> statuses;
  for (const Json& one : resources_of(bundle, "Observation")) statuses.push_back(one["status"]);
  EXPECT_THAT(statuses, ElementsAre("preliminary", "preliminary", "final", "final"));
  EXPECT_EQ(observation_of(bundle_of(write(interrupted, "c.xdf")), "standing-trial")["status"], "preliminary") << "a crash";
}

TEST_F(BundleTest, AnInterruptedStandingSession_HasTheTrialsOfItsReport) {
  report::MadeStanding made = made_session();
  made.events.resize(1);  // the crash came before dtsd had recorded the result of trial 2
  const std::string file = write(made);

  const Json trial = observation_of(bundle_of(file), "standing-trial", "trial-number", 2);
  const auto session = report::read_session({.files = {file}}, always);
  ASSERT_TRUE(session) << session.error().what;
  EXPECT_EQ(trial["status"], "preliminary");
  const auto mvelo = session->trials.at(1).analysis->measures.get(posturography::Measure::Mvelo);
  ASSERT_FALSE(component(trial, "MVELO").is_null());
  EXPECT_NEAR(component(trial, "MVELO")["valueQuantity"]["value"].get<double>(), *mvelo, 1e-5 * *mvelo);
  const Json first = observation_of(bundle_of(file), "standing-trial", "trial-number", 1);
  EXPECT_EQ(component(first, "MVELO")["valueQuantity"]["value"], 8.38123) << "as recorded";
}

TEST_F(BundleTest, AnInterruptedChairSession_HasTheTrialsOfItsReport) {
  report::MadeReaching first{.has_results = false};  // the crash came before dtsd had recorded a result
  first.reaches = {{.trial = 1}, {.trial = 2, .rise_mm = 0.0}, {.trial = 3, .outcome = "redone"}, {.trial = 3, .attempt = 2}};
  report::MadeReaching second;
  second.facts.part = 2;
  second.reaches = {{.trial = 4}, {.trial = 5, .outcome = "aborted"}};
  second.reaches[0].movement.trunk_deg = 31.0;
  const std::vector<std::string> files{report::write_reaching(directory_ / "1.xdf", first),
                                       report::write_reaching(directory_ / "2.xdf", second)};

  const Json bundle = Json::parse(text_of(files));
  const auto chair = report::read_chair_session({.files = files}, always);
  ASSERT_TRUE(chair) << chair.error().what;

  std::size_t valid = 0;
  for (const report::ChairTrial& trial : chair->trials) {
    const Json one = observation_of(bundle, "reaching-trial", "trial-number", trial.recorded.trial);
    if (trial.recorded.outcome != "done") continue;
    ASSERT_FALSE(one.is_null()) << trial.recorded.trial;
    EXPECT_EQ(component(one, "attempt")["valueInteger"], trial.recorded.attempt);
    EXPECT_EQ(one.contains("dataAbsentReason"), !trial.is_valid()) << trial.recorded.trial;
    if (!trial.is_valid()) continue;
    ++valid;
    EXPECT_EQ(component(one, "trunk_deg")["valueQuantity"]["value"], trial.movement()->trunk_deg) << trial.recorded.trial;
  }
  EXPECT_EQ(valid, 3U) << "trials 1, 3 and 4; nothing was found in trial 2";
  EXPECT_EQ(resources_of(bundle, "Observation").size(), 4U) << "neither the redone nor the aborted attempt";
}

/// Without rsvg-convert, the bundle has no PDF and the reason.
TEST_F(BundleTest, OfASessionWithItsPdf_ReportsItsProgress) {
  std::vector<double> done;
  const auto bundle = make_session_bundle({write(made_session())}, "test 1", [&](double share) {
    done.push_back(share);
    return true;
  });

  ASSERT_TRUE(bundle) << core::to_string(bundle.error());
  const Json report = resources_of(Json::parse(bundle->text), "DiagnosticReport").front();
  EXPECT_EQ(report.contains("presentedForm"), bundle->without_pdf.empty());
  EXPECT_THAT(bundle->without_pdf, Not(HasSubstr("interrupted")));
  EXPECT_THAT(done, ::testing::Each(::testing::AllOf(::testing::Ge(0.0), ::testing::Le(1.0))));
  EXPECT_LT(done.front(), 0.5);
  EXPECT_GT(done.back(), 0.5);
}

TEST_F(BundleTest, PartsOfTwoSessions_Fail) {
  report::MadeStanding other = made_session();
  other.facts.session_id = "20261121T150000Z-floor-2";

  const auto bundle = make_bundle({.files = {write(made_session()), write(other, "b.xdf")}}, always);

  ASSERT_FALSE(bundle);
  EXPECT_EQ(bundle.error().code, core::ErrorCode::Unsupported);
}

TEST_F(BundleTest, ADamagedFile_Fails) {
  const std::string file = write(made_session());
  std::filesystem::permissions(file, std::filesystem::perms::owner_write, std::filesystem::perm_options::add);
  std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
  bytes.seekp(static_cast<std::streamoff>(std::filesystem::file_size(file) / 2));
  bytes.put('\x7f').put('\x7f').flush();

  EXPECT_FALSE(make_bundle({.files = {file}}, always));
}

TEST_F(BundleTest, WithoutAFile_Fails) {
  EXPECT_FALSE(make_bundle({.files = {}}, always));
  EXPECT_FALSE(make_bundle({.files = {"no/such.xdf"}}, always));
}

TEST_F(BundleTest, StoppedByItsCaller_Fails) {
  const auto bundle = make_bundle({.files = {write(made_session())}}, [](double) { return false; });

  ASSERT_FALSE(bundle);
  EXPECT_EQ(bundle.error().code, core::ErrorCode::Failed);
}

}  // namespace
}  // namespace dts::fhir
