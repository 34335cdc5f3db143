// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "support/committed_text.h"
#include "visits/document.h"
#include "visits/plain_words.h"
#include "visits/retest.h"
#include "visits/series.h"

namespace dts::visits {
namespace {

constexpr std::int64_t kDayNs = 86'400'000'000'000;
constexpr std::int64_t kFirstNs = 1'795'000'000'000'000'000;  // 2026-11-18 UTC

v1::SessionRecord session_on(int day, const std::string& rig, const std::string& protocol) {
  v1::SessionRecord session;
  session.set_session_id(rig + "-" + std::to_string(day));
  session.set_rig(rig);
  session.set_protocol(protocol);
  session.set_state("complete");
  session.set_started_utc_ns(kFirstNs + day * kDayNs);
  return session;
}

void add_result(v1::SessionRecord& session, const std::string& name, double value, const std::string& unit, const std::string& details) {
  auto& result = *session.add_results();
  result.set_name(name);
  result.set_value(value);
  result.set_unit(unit);
  result.set_details(details);
}

constexpr const char* kAnalysis = R"({"trials":2,"sd":1.5,"profile":"lp10","rate_hz":100,"duration_s":30})";

v1::SessionRecord standing_on(int day, double ellipse_mm2, double velocity_ml) {
  v1::SessionRecord session = session_on(day, "floor", "romberg");
  add_result(session, "eyes-open/PEA95_F", ellipse_mm2, "mm2", kAnalysis);
  add_result(session, "eyes-open/MVELO_ML", velocity_ml, "mm/s", kAnalysis);
  add_result(session, "romberg/feet=two,surface=firm/PEA95_F", 1.23, "1", R"({"open":200,"closed":246})");
  return session;
}

std::string targets_of(double trunk_deg, const std::string& classes, double target_cm = 85.0) {
  return R"({"targets":[{"condition":"120","target_cm":)" + std::to_string(target_cm) +
         R"(,"reaches_detected":5,"angles":3,"trunk_mean_deg":)" + std::to_string(trunk_deg) +
         R"(,"trunk_sd_deg":2.04,"d2_mean_mm":1.5,"classes":)" + classes + "}]}";
}

v1::SessionRecord reaching_on(int day, double trunk_deg) {
  v1::SessionRecord session = session_on(day, "chair", "reaching-short");
  add_result(session, "targets", 1, "1", targets_of(trunk_deg, R"({"none":0,"minor":2,"moderate":1,"maximum":0,"rejected":4})"));
  add_result(session, "class_agreement_share", 0.75, "1", R"({"agreed":6,"compared":8})");
  add_result(session, "rejected_share", 0.1, "1", R"({"rejected":1,"classified":9})");
  add_result(session, "trunk_sd_deg", 2.04, "deg", "");
  return session;
}

v1::SubjectRecord subject_with(const std::vector<v1::SessionRecord>& sessions) {
  v1::SubjectRecord subject;
  subject.mutable_about()->set_subject("P017");
  for (const v1::SessionRecord& session : sessions) *subject.add_sessions() = session;
  return subject;
}

const Series* find(const std::vector<Series>& all, const std::string& condition, const std::string& measure) {
  const auto found = std::ranges::find_if(all, [&](const Series& one) { return one.condition == condition && one.measure == measure; });
  return found == all.end() ? nullptr : &*found;
}

TEST(Series, AreSortedByTimeWhateverTheOrderOfTheSessions) {
  const auto all = series_of(subject_with({standing_on(7, 190, 4.0), standing_on(0, 240, 5.0)}));
  const Series* const ellipse = find(all, "eyes-open", "PEA95_F");
  ASSERT_NE(ellipse, nullptr);
  ASSERT_EQ(ellipse->points.size(), 2U);
  EXPECT_EQ(ellipse->points.front().session_id, "floor-0");
  EXPECT_EQ(ellipse->points.back().value, 190);
  EXPECT_EQ(ellipse->points.back().spread, 1.5);
  EXPECT_EQ(ellipse->points.back().trials, 2U);
  EXPECT_EQ(ellipse->rig + " " + ellipse->protocol + " " + ellipse->unit, "floor romberg mm2");
  EXPECT_NE(find(all, "romberg/feet=two,surface=firm", "PEA95_F"), nullptr) << "a quotient is no result of one condition";
}

TEST(Series, LeaveOutWhatIsDeletedOrRunningOrOfAnotherPart) {
  auto deleted = standing_on(1, 1, 1);
  deleted.set_is_deleted(true);
  auto running = standing_on(2, 2, 2);
  running.set_state("running");
  auto resumed = standing_on(3, 3, 3);
  add_result(resumed, "eyes-open/PEA95_F_part_2", 99, "mm2", kAnalysis);
  const auto all = series_of(subject_with({deleted, running, resumed}));
  ASSERT_NE(find(all, "eyes-open", "PEA95_F"), nullptr);
  EXPECT_EQ(find(all, "eyes-open", "PEA95_F")->points.size(), 1U);
  EXPECT_EQ(find(all, "eyes-open", "PEA95_F_part_2"), nullptr);
}

TEST(Series, AResumedSessionHasTheResultsOfThePartWithMostTrials) {
  auto crashed = session_on(0, "floor", "romberg");
  add_result(crashed, "eyes-open/PEA95_F_part_2", 99, "mm2", kAnalysis);
  auto both = session_on(1, "floor", "romberg");
  add_result(both, "eyes-open/PEA95_F", 50, "mm2", R"({"trials":1,"profile":"lp10","rate_hz":100,"duration_s":30})");
  add_result(both, "eyes-open/PEA95_F_part_2", 77, "mm2", kAnalysis);
  const auto all = series_of(subject_with({crashed, both}));
  ASSERT_EQ(all.size(), 1U);
  ASSERT_EQ(all[0].points.size(), 2U);
  EXPECT_EQ(all[0].points[0].value, 99);
  EXPECT_EQ(all[0].points[1].value, 77);
}

TEST(Series, TrialsOfUnknownLengthAreNotCompared) {
  constexpr const char* kUnknown = R"({"trials":2,"profile":"lp10","rate_hz":100})";
  auto one = session_on(0, "floor", "romberg");
  add_result(one, "eyes-open/PEA95_F", 50, "mm2", kUnknown);
  auto other = session_on(1, "floor", "romberg");
  add_result(other, "eyes-open/PEA95_F", 60, "mm2", kUnknown);
  EXPECT_EQ(comparable_points(series_of(subject_with({one, other}))[0]).size(), 1U);
}

TEST(PlainWords, TitlesAreInTheLanguageOfTheSentences) {
  v1::ListProtocolsResponse protocols;
  auto& protocol = *protocols.add_protocols();
  protocol.set_name("reaching-short");
  auto& condition = *protocol.add_conditions();
  condition.set_name("120");
  condition.set_title("120 % of arm length");
  auto& translation = *condition.add_translations();
  translation.set_language("de");
  translation.set_title("120 % der Armlänge");
  EXPECT_EQ(titles_of(protocols, english()).begin()->second, "120 % of arm length");
  EXPECT_EQ(titles_of(protocols, german()).begin()->second, "120 % der Armlänge");
}

TEST(Series, NeverMixRigsOrProtocols) {
  RecordProperty("requirement", "UI-13");
  auto other = standing_on(1, 200, 4);
  other.set_protocol("quiet-standing");
  auto plate = standing_on(2, 200, 4);
  plate.set_rig("plate");
  const auto all = series_of(subject_with({standing_on(0, 200, 4), other, plate}));
  EXPECT_EQ(std::ranges::count(all, "MVELO_ML", &Series::measure), 3);
}

TEST(Series, PointsOfAnotherAnalysisAreNotCompared) {
  auto longer = session_on(0, "floor", "romberg");
  add_result(longer, "eyes-open/PEA95_F", 240, "mm2", R"({"trials":2,"profile":"lp10","rate_hz":100,"duration_s":60})");
  auto nearly = session_on(1, "floor", "romberg");
  add_result(nearly, "eyes-open/PEA95_F", 230, "mm2", R"({"trials":2,"profile":"lp10","rate_hz":100,"duration_s":30.02})");
  const auto all = series_of(subject_with({longer, nearly, standing_on(2, 200, 4)}));
  const auto points = comparable_points(*find(all, "eyes-open", "PEA95_F"));
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points.front().value, 230);
  EXPECT_EQ(find(all, "eyes-open", "PEA95_F")->points.size(), 3U) << "it is shown nevertheless";
}

TEST(Series, ReachesOfTheOtherArmAreNotCompared) {
  RecordProperty("requirement", "UI-13");
  const auto reaching_with = [](int day, double deg, const std::string& side) {
    auto session = reaching_on(day, deg);
    (*session.mutable_fields())["side"] = side;
    return session;
  };
  const auto all = series_of(subject_with({reaching_with(0, 26, "left"), reaching_with(1, 6, "right"), reaching_with(2, 24, "left")}));
  const auto points = comparable_points(*find(all, "120", "trunk_mean_deg"));
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points.front().value, 26);
  EXPECT_EQ(comparable_points(series_of(subject_with({reaching_on(0, 26), reaching_with(1, 6, "right")}))[0]).size(), 1U) << "unknown arm";
}

TEST(Series, AnglesOnAnotherScaleAreNotCompared) {
  RecordProperty("requirement", "UI-13");
  const auto reaching_with = [](int day, int on_own_scale) {
    auto session = session_on(day, "chair", "reaching-short");
    add_result(session, "targets", 1, "1",
               R"({"targets":[{"condition":"120","target_cm":85,"reaches_detected":3,"angles":3,"angles_on_own_scale":)" +
                   std::to_string(on_own_scale) + R"(,"trunk_mean_deg":20,"trunk_sd_deg":2,"d2_mean_mm":1,"classes":{"minor":3}}]})");
    for (const char* result : {"trunk_at_critical_boundary_deg", "trunk_sd_deg", "class_agreement_share", "rejected_share", "sparc_mean"})
      add_result(session, result, 1, "1", "");
    return session;
  };
  for (const auto& [scales, compared] : {std::pair(std::vector{0, 3}, 1U),
                                         {std::vector{3, 3}, 2U},
                                         {std::vector{0, 0}, 2U},
                                         {std::vector{1, 3}, 1U},
                                         {std::vector{1, 2}, 1U}}) {
    const auto all = series_of(subject_with({reaching_with(0, scales[0]), reaching_with(1, scales[1])}));
    for (const char* measure : {"trunk_mean_deg", "trunk_sd_deg", "trunk_class"}) {
      EXPECT_EQ(comparable_points(*find(all, "120", measure)).size(), compared) << measure << ' ' << scales[0] << scales[1];
    }
    for (const char* measure : {"trunk_at_critical_boundary_deg", "trunk_sd_deg", "class_agreement_share", "rejected_share"}) {
      EXPECT_EQ(comparable_points(*find(all, "", measure)).size(), compared) << measure << ' ' << scales[0] << scales[1];
    }
    EXPECT_EQ(comparable_points(*find(all, "120", "d2_mean_mm")).size(), 2U) << "it has no scale";
    EXPECT_EQ(comparable_points(*find(all, "", "sparc_mean")).size(), 2U) << "it has no scale";
  }
}

TEST(Series, TargetsOfTheChairHaveAngleSpreadAndMedianClass) {
  const auto all = series_of(subject_with({reaching_on(0, 12.1)}));
  ASSERT_NE(find(all, "120", "trunk_mean_deg"), nullptr);
  EXPECT_EQ(find(all, "120", "trunk_mean_deg")->points.front().spread, 2.04);
  EXPECT_EQ(find(all, "120", "trunk_mean_deg")->points.front().trials, 3U);
  EXPECT_EQ(find(all, "120", "d2_mean_mm")->points.front().trials, 5U) << "also those without a sound angle";
  EXPECT_EQ(find(all, "120", "trunk_class")->points.front().value, 1.0) << "rejected reaches have no class";
  EXPECT_EQ(find(all, "120", "trunk_class")->points.front().trials, 3U);
  const auto median_of = [](const std::string& classes) {
    auto session = session_on(0, "chair", "reaching-short");
    add_result(session, "targets", 1, "1", targets_of(1, classes));
    const auto series = series_of(subject_with({session}));
    const Series* const found = find(series, "120", "trunk_class");
    return found == nullptr ? -1.0 : found->points.front().value;
  };
  EXPECT_EQ(median_of(R"({"none":1,"maximum":1})"), 1.5);
  EXPECT_EQ(median_of(R"({"none":0,"moderate":1,"maximum":2})"), 3.0);
  EXPECT_EQ(median_of(R"({"rejected":3})"), -1.0);
}

TEST(Series, BadDetailsOfAPeerAreIgnored) {
  for (const char* details : {"", "[]", "{", "null", R"({"targets":5})", R"({"targets":[5,{},{"condition":3}]})",
                              R"({"targets":[{"condition":"120","trunk_mean_deg":"x","classes":[1]}]})",
                              R"({"targets":[{"condition":"120","trunk_mean_deg":1e999,"classes":{"none":-5,"minor":1e300}}]})"}) {
    auto session = session_on(0, "chair", "reaching-short");
    add_result(session, "targets", 1, "1", details);
    add_result(session, "eyes-open/MVELO", std::numeric_limits<double>::quiet_NaN(), "mm/s", details);
    EXPECT_TRUE(series_of(subject_with({session})).empty()) << details;
    EXPECT_TRUE(words_of_session(session, english()).empty()) << details;
  }
}

TEST(PlainWords, SayHowEyesClosedDiffers) {
  RecordProperty("requirement", "UI-14");
  v1::SessionRecord session = standing_on(0, 200, 4);
  add_result(session, "romberg/feet=one,surface=firm/PEA95_F", 3.0, "1", R"({"open":700,"closed":2100})");
  add_result(session, "romberg/MVELO", 0.5, "1", R"({"open":8,"closed":4})");
  add_result(session, "romberg/MVELO_ML", 0.5, "1", R"({"open":8,"closed":4})");
  EXPECT_EQ(words_of_session(session, english()),
            (std::vector<std::string>{
                "Two feet, firm surface: with eyes closed the ellipse is 23 % larger than with eyes open (246 against 200 mm²).",
                "One foot, firm surface: with eyes closed the ellipse is 200 % larger than with eyes open (2100 against 700 mm²).",
                "With eyes closed the mean velocity is 50 % lower than with eyes open (4.0 against 8.0 mm/s)."}));
  EXPECT_EQ(words_of_session(standing_on(0, 200, 4), german()),
            std::vector<std::string>{
                "Zwei Füße, fester Untergrund: Mit geschlossenen Augen ist die Ellipse 23 % größer als mit offenen (246 gegenüber 200 mm²)."});
}

TEST(PlainWords, NameTheStance) {
  EXPECT_EQ(stance_words("feet=one,head=back,surface=foam,task", english()), "One foot, head back, foam, task");
  EXPECT_EQ(stance_words("feet=one,surface=foam", german()), "Ein Fuß, Schaumstoff");
  EXPECT_EQ(stance_words("", english()), "");
}

/// Every sentence in this language: with a rise, a fall and no change, with one and with several.
std::string every_sentence(const Sentences& words) {
  std::string text = words.language() + "\n";
  const auto add = [&text](const std::string& sentence) { text += sentence + "\n"; };
  const std::string day = "2026-11-21";
  for (const char* name : {"eyes-open", "eyes-closed", "on_foam", ""})
    add(words.condition(name, "") + "; " + words.condition(name, "Title"));
  for (const Change& change : {Change{.from = 8.0, .to = 9.84}, Change{.from = 8.0, .to = 4.0}, Change{.from = 8.0, .to = 8.02}}) {
    add(words.ellipse_eyes_closed("S", {.from = 25.0 * change.from, .to = 25.0 * change.to}));
    add(words.velocity_eyes_closed("", change));
    add(words.ellipse_since("C", {.from = 25.0 * change.from, .to = 25.0 * change.to}, day));
    add(words.velocity_since("C", change, day));
    add(words.velocity_ml_since("C", change, day));
    add(words.trunk_since("C", change.from, change.to, day));
    add(words.trunk_spread_since("C", change.from, change.to, day));
  }
  add(words.trunk_at_target("C", 12.34, 0));
  for (const std::uint32_t count : {1U, 4U}) {
    add(words.trunk_at_target("C", 12.34, count));
    add(words.classes_as_expected(1, count));
    add(words.reaches_without_class(1, count));
  }
  add(words.trunk_consistency(2.04));
  add(words.within_retest(65.0));
  add(words.beyond_retest(65.0));
  add(words.no_retest_known());
  return text;
}

TEST(Sentences, AreThoseOfTheCommittedText) {
  RecordProperty("requirement", "UI-14");
  test::expect_committed("unit/visits/sentences.txt", every_sentence(english()) + "\n" + every_sentence(german()));
  EXPECT_EQ((Change{.from = 0.0, .to = 8.0}).percent(), 0) << "no share of nothing";
}

TEST(PlainWords, HalfAShareHasNoSentence) {
  for (const char* details : {R"({"agreed":6,"rejected":6})", R"({"compared":8,"classified":8})"}) {
    v1::SessionRecord session = session_on(0, "chair", "reaching-short");
    add_result(session, "class_agreement_share", 0.75, "1", details);
    add_result(session, "rejected_share", 0.75, "1", details);
    EXPECT_TRUE(words_of_session(session, english()).empty()) << details;
  }
}

TEST(PlainWords, SayWhatTheTrunkDid) {
  v1::ListProtocolsResponse protocols;
  auto& protocol = *protocols.add_protocols();
  protocol.set_name("reaching-short");
  auto& condition = *protocol.add_conditions();
  condition.set_name("120");
  condition.set_title("120 % of arm length");
  EXPECT_EQ(
      words_of_session(reaching_on(0, 12.14), english(), titles_of(protocols, english())),
      (std::vector<std::string>{"120 % of arm length: the trunk bent 12.1° on average, in 3 reaches.",
                                "The trunk class was as expected for the target in 6 of 8 trials. A trial without a reach counts if its "
                                "target needs no trunk movement.",
                                "The trunk class is missing for 1 of 9 reaches.",
                                "At the same target the trunk angle varied by 2.0° from reach to reach (standard deviation)."}));
  EXPECT_EQ(words_of_session(reaching_on(0, 12.14), german()).front(),
            "120: Der Rumpf beugte sich im Mittel um 12,1°, bei 3 Reichbewegungen.");
}

TEST(PlainWords, CompareWithTheVisitBeforeAndTheFirst) {
  const auto series = series_of(subject_with({standing_on(0, 240, 5.0), standing_on(7, 200, 4.0), standing_on(14, 210, 9.0)}));
  const auto words = words_of_changes(series, english());
  EXPECT_EQ(words,
            (std::vector<std::string>{
                "Eyes open: the mean velocity to the sides is 125 % higher than on 2026-11-25 (9.0 against 4.0 mm/s). This is more "
                "than the variation between two days that is known of people above 65 and trials of 45 s (65 % of the mean of both).",
                "Eyes open: the mean velocity to the sides is 80 % higher than on 2026-11-18 (9.0 against 5.0 mm/s). This is within "
                "the variation between two days that is known of people above 65 and trials of 45 s (65 % of the mean of both).",
                "Eyes open: the ellipse is 5 % larger than on 2026-11-25 (210 against 200 mm²).",
                "Eyes open: the ellipse is 13 % smaller than on 2026-11-18 (210 against 240 mm²).",
                "For measures without this remark no published variation is known here: the difference may be chance."}));
}

TEST(PlainWords, ADifferenceWithinTheKnownVariationSaysSo) {
  RecordProperty("requirement", "UI-14");
  const auto series = series_of(subject_with({standing_on(0, 240, 5.0), standing_on(7, 200, 4.0)}));
  const auto words = words_of_changes(series, german());
  ASSERT_FALSE(words.empty());
  EXPECT_EQ(words.front(),
            "Augen offen: Die mittlere Geschwindigkeit in seitlicher Richtung ist 20 % niedriger als am 18.11.2026 (4,0 gegenüber 5,0 "
            "mm/s). Das liegt innerhalb der Streuung von Tag zu Tag, die für Menschen über 65 und Durchgänge von 45 s bekannt ist (65 % "
            "des Mittels beider Werte).");
}

TEST(PlainWords, OneVisitHasNoChange) {
  EXPECT_TRUE(words_of_changes(series_of(subject_with({standing_on(0, 240, 5.0)})), english()).empty());
  EXPECT_TRUE(words_of_changes(series_of(subject_with({standing_on(0, 0.0, 0.0), standing_on(1, 1.0, 1.0)})), english()).empty())
      << "no share of nothing";
}

TEST(PlainWords, TheTrunkIsComparedInDegrees) {
  const auto words = words_of_changes(series_of(subject_with({reaching_on(0, 15.0), reaching_on(7, 12.0)})), english());
  ASSERT_GE(words.size(), 2U);
  EXPECT_EQ(words[0], "120: the trunk bent 3.0° less than on 2026-11-18 (12.0° against 15.0°).");
  EXPECT_EQ(words[1], "120: the trunk angle varied as much as on 2026-11-18 (standard deviation 2.0° against 2.0°).");
}

TEST(Retest, IsKnownOnlyWithASource) {
  RecordProperty("requirement", "UI-13");
  const std::vector<Point> points{{.duration_s = 30.0}};
  Series series{.condition = "eyes-open", .measure = "MVELO_ML", .points = points};
  ASSERT_NE(retest_of(series), nullptr);
  EXPECT_NE(std::string(retest_of(series)->source).find("doi:"), std::string::npos);
  series.condition = "foam-eyes-open";
  EXPECT_EQ(retest_of(series), nullptr) << "people on foam were not measured there";
  series = {.condition = "eyes-open", .measure = "MVELO", .points = points};
  EXPECT_EQ(retest_of(series), nullptr);
  for (const auto& [duration_s, is_known] : {std::pair(29.0, false), {30.0, true}, {60.0, true}, {61.0, false}}) {
    series = {.condition = "eyes-closed", .measure = "MVELO_ML", .points = {{.duration_s = duration_s}}};
    EXPECT_EQ(retest_of(series) != nullptr, is_known) << "the study has 45 s";
  }
}

/// 65 % of the mean of 5 and 10 is 4.9: a rise from 5 to 10 is more than that, and so is the fall back.
TEST(Retest, ARiseAndTheFallBackAreJudgedAlike) {
  RecordProperty("requirement", "UI-14");
  const Retest retest{.percent = 65.0};
  EXPECT_FALSE(retest.is_within(5.0, 10.0));
  EXPECT_FALSE(retest.is_within(10.0, 5.0));
  EXPECT_TRUE(retest.is_within(10.0, 17.0));
  EXPECT_TRUE(retest.is_within(17.0, 10.0));
}

TEST(Sentences, TheLanguageIsTheFirstPartOfItsTag) {
  EXPECT_EQ(&sentences_in("de"), &german());
  EXPECT_EQ(&sentences_in("de-AT"), &german());
  for (const char* other : {"en", "", "den", "fr"}) EXPECT_EQ(&sentences_in(other), &english()) << other;
  EXPECT_EQ(figure(-0.04, 1, ','), "0,0");
  EXPECT_EQ(figure(1234.5, 1, ','), "1234,5");
  EXPECT_EQ(figure(1e300, 1, '.'), "-");
}

TEST(Document, HasSeriesAndWords) {
  const auto subject = subject_with({standing_on(7, 200, 4.0), standing_on(0, 240, 5.0), reaching_on(3, 12)});
  const auto document = document_of(subject, {}, english());
  EXPECT_EQ(document["subject"], "P017");
  EXPECT_EQ(document["words"]["sessions"].size(), 3U);
  EXPECT_EQ(document["words"]["sessions"][0]["session"], "floor-7");
  EXPECT_FALSE(document["words"]["changes"].empty());
  const auto only = document_of(subject, {}, german(), "MVELO_ML");
  ASSERT_EQ(only["series"].size(), 1U);
  EXPECT_EQ(only["series"][0]["retest"]["percent"], 65.0);
  EXPECT_EQ(only["series"][0]["points"][1]["utc_ns"], std::to_string(kFirstNs + 7 * kDayNs));
  EXPECT_EQ(only["language"], "de");
}

}  // namespace
}  // namespace dts::visits
