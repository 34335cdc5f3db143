// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <pugixml.hpp>
#include <regex>

#include "core/losses.h"
#include "made_decision.h"
#include "made_standing.h"
#include "report/report.h"
#include "report/translation.h"
#include "session/session_events.h"
#include "unit/record/xdf_fixture.h"

namespace dts::report {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::vector<std::pair<std::string, std::string>> kGermanOpen{{"eyes", "open"}, {"feet", "two"}, {"surface", "firm"}};
const std::vector<std::pair<std::string, std::string>> kGermanClosed{{"eyes", "closed"}, {"feet", "two"}, {"surface", "firm"}};

struct EveryText : pugi::xml_tree_walker {
  std::vector<std::string> texts;
  bool for_each(pugi::xml_node& node) override {
    if (node.type() == pugi::node_pcdata && std::string_view(node.parent().name()) != "style") texts.emplace_back(node.value());
    return true;
  }
};

std::vector<std::string> texts_of(const Page& page) {
  pugi::xml_document document;
  EXPECT_TRUE(document.load_string(page.text.c_str(), pugi::parse_default | pugi::parse_doctype)) << page.file;
  EveryText walker;
  document.traverse(walker);
  return walker.texts;
}

/// What is the same in both languages: values, keys and names of measures, devices and programs, references to literature.
bool is_of_both_languages(const std::string& text) {
  static const std::regex kWord("[A-Za-z]{3}");
  static const std::regex kShared(
      "P017|romberg|quiet-standing|rejected|deg|deg/s|Filter|PF(50|95) .*|.*Gait Posture.*|.*IEEE Trans.*|.*Exp Brain Res.*|2026.* "
      "UTC|20261121T144525Z-floor-1|"
      "floor|COP");
  return !std::regex_search(text, kWord) || std::regex_match(text, kShared);
}

class GermanReport : public ::testing::Test {
 protected:
  [[nodiscard]] std::string write(const MadeStanding& made) {
    return write_standing(directory_ / ("recording-" + std::to_string(++written_) + ".xdf"), made);
  }
  [[nodiscard]] static std::vector<Page> pages(const std::string& file, Language language) {
    auto report = make_report({.files = {file}, .software = "test 1.2.3", .language = language}, [](double) { return true; });
    EXPECT_TRUE(report.has_value()) << (report ? "" : core::to_string(report.error()));
    return report ? report->pages : std::vector<Page>{};
  }
  /// Returns the texts that the German pages have in English.
  [[nodiscard]] std::vector<std::string> english_texts(const MadeStanding& made) {
    const std::string file = write(made);
    const std::vector<Page> english = pages(file, Language::English);
    const std::vector<Page> german = pages(file, Language::German);
    std::vector<std::string> same;
    EXPECT_EQ(english.size(), german.size());
    for (std::size_t index = 0; index < std::min(english.size(), german.size()); ++index) {
      if (!english[index].file.ends_with(".html")) continue;  // the SVG page has the same content, broken into lines
      const auto before = texts_of(english[index]);
      const auto after = texts_of(german[index]);
      EXPECT_EQ(before.size(), after.size()) << english[index].file;
      for (std::size_t text = 0; text < std::min(before.size(), after.size()); ++text) {
        if (before[text] == after[text] && !is_of_both_languages(before[text])) same.push_back(before[text]);
      }
    }
    return same;
  }
  static MadeStanding romberg() {
    MadeStanding made{.length_s = 120.0};
    made.facts.protocol = "romberg";
    made.facts.fields = {{"weight_kg", "71.5"}};
    made.facts.label = "rejected";
    made.facts.protocol_definition =
        "name = \"romberg\"\ntitle = \"Romberg's test\"\nde = { title = \"Romberg-Test\" }\n[[field]]\nname = \"weight_kg\"\n"
        "label = \"Body weight\"\nde = { label = \"Gewicht\" }\nunit = \"kg\"\nminimum = 10\nmaximum = 250\n[trials]\nblocks = 3\n"
        "[[trials.condition]]\nname = \"eyes-open\"\ntitle = \"Eyes open\"\nde = { title = \"Augen offen\" }\n"
        "[[trials.condition]]\nname = \"eyes-closed\"\ntitle = \"Eyes closed\"\nde = { title = \"Augen geschlossen\" }\n";
    add_trial(made, 1, 2.0, 20.0, "eyes-open", kGermanOpen);
    add_trial(made, 2, 25.0, 20.0, "eyes-closed", kGermanClosed);
    add_trial(made, 3, 50.0, 8.0, "eyes-open", kGermanOpen);
    add_trial(made, 4, 60.0, 35.0, "eyes-closed", kGermanClosed, "redone");
    add_trial(made, 4, 97.0, 20.0, "eyes-closed", kGermanClosed, "done", 2);
    return made;
  }

  record::xdf_test::Folder directory_;
  int written_ = 0;
};

TEST_F(GermanReport, Pages_HaveNoEnglishText) {
  RecordProperty("requirement", "UI-12");
  EXPECT_THAT(english_texts(romberg()), ElementsAre());
  MadeStanding simulated = romberg();
  simulated.facts.device_uri = "sim:floor?noise=0.5";
  simulated.facts.firmware = "7";
  EXPECT_THAT(english_texts(simulated), ElementsAre());
}

TEST_F(GermanReport, DecisionsHaveNoEnglishText) {
  RecordProperty("requirement", "UI-12");
  v1::SteadinessDecision decision = made_decision();
  decision.clear_about();  // a text of the model's maker
  MadeStanding made = romberg();
  const auto add = [&](std::uint32_t trial, const v1::SteadinessDecision& one) {
    session::SwayTrialResult result{
        .trial = trial, .attempt = trial == 4 ? 2U : 1U, .analysis = posturography::Analysis{}, .decision = one};
    result.analysis->rate_hz = 100.0;
    result.analysis->samples = 2000;
    result.analysis->duration_s = 20.0;
    made.events.push_back(session::to_event(result, "20261121T144525Z-floor-1", "dtsd 0.2.0"));
    made.events.back().set_scan(11900);
  };
  add(1, decision);
  decision.set_outcome(v1::DECISION_OUTCOME_NOT_COMPARABLE);
  add(2, decision);
  decision.set_outcome(v1::DECISION_OUTCOME_OUTSIDE);
  decision.add_outside("MVELO");
  decision.set_is_better_than_one_measure(true);
  decision.clear_condition();
  add(3, decision);
  decision.set_outcome(v1::DECISION_OUTCOME_NOT_VALID);
  add(4, decision);

  EXPECT_THAT(english_texts(made), ElementsAre("group60", "group60", "group60", "group60", "group60", "group60", "group60", "group60"));
  const std::string session = pages(write(made), Language::German).front().text;
  for (const char* part :
       {"wie under60, Wahrscheinlichkeit 0,83", "MVELO liegt außerhalb der Lerndaten", "aus Daten von 124 Personen gelernt",
        "(0,73..0,88; 0,50 ist Zufall)", "Körpergröße mit Geschlecht unterscheidet ohne Platte ebenso gut (0,83)",
        "Keine Aussage über Gesundheit oder Sturzgefahr."}) {
    EXPECT_THAT(session, HasSubstr(part));
  }
}

TEST_F(GermanReport, WithoutAProtocol_HasNoEnglishText) { EXPECT_THAT(english_texts(MadeStanding{}), ElementsAre()); }

TEST_F(GermanReport, Page_HasTheNamesOfTheProtocolAndADecimalComma) {
  const std::string session = pages(write(romberg()), Language::German).front().text;
  for (const char* part : {"lang=\"de\"", "Romberg-Test (romberg)", "Gewicht", "71,5 kg", "Augen offen (n = ", "21. November 2026"}) {
    EXPECT_THAT(session, HasSubstr(part));
  }
  EXPECT_THAT(session, HasSubstr("test 1.2.3"));   // a version is no number
  EXPECT_THAT(session, HasSubstr("Tabelle 4.2"));  // nor is the number of a table
}

TEST_F(GermanReport, WhatAPersonTyped_IsNotTranslated) {
  const std::string session = pages(write(romberg()), Language::German).front().text;
  EXPECT_THAT(session, HasSubstr("Stichwort"));
  EXPECT_THAT(session, HasSubstr("rejected"));  // the label of this session
}

TEST(ReportTranslation, FindsTheClosestTextAndTranslatesItsParts) {
  const Translation german(Language::German, {});
  EXPECT_EQ(german("done, not valid: feet moved"), "fertig, nicht gültig: Füße bewegt");
  EXPECT_EQ(german("No Romberg quotient for feet two: no trial with eyes closed counts."),
            "Kein Romberg-Quotient (zwei Füße): kein Durchgang „Augen geschlossen“ zählt.");
  EXPECT_EQ(german("subject ID: none -> left, 2026-11-21 14:45:25 UTC, ward 1.5: None."),
            "Personen-ID: leer -> left, 2026-11-21 14:45:25 UTC, ward 1.5: None.");
  EXPECT_EQ(german("1.11 (0.80-1.32)"), "1,11 (0,80-1,32)");
  EXPECT_EQ(german("100.0 and 1000 Hz"), "100,0 und 1000 Hz");
  EXPECT_EQ(german("100.0 and 1000 Hz (maker's program 1.2)"), "100,0 und 1000 Hz (maker's program 1.2)");
  EXPECT_EQ(german("minor, p 0.42"), "gering, Wahrsch. 0,42");
  EXPECT_EQ(german("a text that nobody has translated 0.2.0 sim:a?b=0.5"), "a text that nobody has translated 0.2.0 sim:a?b=0.5");
  EXPECT_EQ(Translation(Language::English, {})("1.5 done"), "1.5 done");
}

TEST(ReportTranslation, CorrectionsHaveNoEnglishWordOfTheProgram) {
  const Translation german(Language::German, {});
  EXPECT_EQ(german("rejected: not valid (corrected; recorded: done)"), "verworfen: nicht gültig (berichtigt; aufgezeichnet: fertig)");
  EXPECT_EQ(german("outcome of trial 1, attempt 2: done -> rejected, 2026-11-21 14:45:25 UTC, anna: done."),
            "Ausgang von Durchgang 1, Versuch 2: fertig -> verworfen, 2026-11-21 14:45:25 UTC, anna: done.");
  EXPECT_EQ(german("label: [removed] -> none, 2026-11-21 14:45:25 UTC, anna: open."),
            "Stichwort: [entfernt] -> leer, 2026-11-21 14:45:25 UTC, anna: open.");
  PageContent page;
  page.facts = {{.name = "Subject ID", .value = "done (corrected; recorded: open)"},
                {.name = "Label", .value = "open (corrected; recorded: none)"}};
  const PageContent translated = german(page);
  EXPECT_EQ(translated.facts[0].value, "done (berichtigt; aufgezeichnet: open)");  // what a person typed stays
  EXPECT_EQ(translated.facts[1].value, "open (berichtigt; aufgezeichnet: leer)");
}

TEST(ReportTranslation, DamageAndGapsHaveNoEnglishText) {
  const Translation german(Language::German, {});
  EXPECT_EQ(
      german("The recording a.xdf is damaged (incomplete: no footer; recovered, at most 0.75 s are lost): only the undamaged part is "
             "shown."),
      "Die Aufzeichnung a.xdf ist beschädigt (unvollständig: kein Abschluss; wiederhergestellt, höchstens 0,75 s fehlen): Gezeigt wird "
      "nur der unbeschädigte Teil.");
  EXPECT_EQ(german("chunk torn at byte 1234; no footer: it was never closed"),
            "Block abgerissen bei Byte 1234; kein Abschluss: Sie wurde nie geschlossen");
  EXPECT_EQ(german("The recording a.xdf has gaps: 12 scans lost in 1 gap: overrun 1."),
            "Die Aufzeichnung a.xdf hat Lücken: 12 Abtastungen verloren in 1 Lücke: Puffer des Geräts voll 1.");
  EXPECT_EQ(german("40 scans lost in 3 gaps: unplugged 2, ring_full 1"),
            "40 Abtastungen verloren in 3 Lücken: Gerät abgezogen 2, Verarbeitung oder Datenträger zu langsam 1");
  EXPECT_EQ(german("the trial has no samples"), "der Durchgang hat keine Messwerte");
  EXPECT_EQ(german("the session has too many samples for one report"), "die Untersuchung hat zu viele Messwerte für einen Bericht");
}

TEST(ReportTranslation, ReasonsOfATrialWithoutValuesHaveNoEnglishText) {
  const Translation german(Language::German, {});
  EXPECT_EQ(german("No values: samples were dropped before the analysis: analyse the recording with dtslab sway."),
            "Keine Werte: vor der Auswertung gingen Messwerte verloren: die Aufzeichnung mit dtslab sway auswerten.");
  EXPECT_EQ(german("No values: only 12 samples (0.12 s) are left of the centre of pressure, and 20 are needed."),
            "Keine Werte: nur 12 Messwerte (0,12 s) des Druckmittelpunkts sind übrig, 20 sind nötig.");
  EXPECT_EQ(german("No Romberg quotient for feet two: the trials with eyes open last 20 s, those with eyes closed 12.5 s."),
            "Kein Romberg-Quotient (zwei Füße): die Durchgänge mit offenen Augen dauern 20 s, die mit geschlossenen 12,5 s.");
}

/// No reason for a gap stays English, whichever is added.
TEST(ReportTranslation, EveryReasonOfAGapHasGerman) {
  const Translation german(Language::German, {});
  for (std::size_t reason = 0; reason < core::kGapReasons; ++reason) {
    core::Losses losses;
    losses.add(static_cast<core::GapReason>(reason), {.gaps = 1, .scans = 12});
    const std::string english = core::to_text(losses);
    const std::string name = english.substr(english.rfind(": ") + 2);
    EXPECT_THAT(german(english), ::testing::Not(HasSubstr(name))) << english;
  }
}

TEST(ReportTranslation, EveryGermanTextHasThePlacesOfTheEnglishOne) {
  const auto places = [](std::string_view text) {
    std::size_t count = 0;
    for (std::size_t at = text.find('{'); at != std::string_view::npos; at = text.find('{', at + 1)) ++count;
    return count;
  };
  for (const auto& [english, german] : german_texts()) EXPECT_EQ(places(english), places(german)) << english;
}

}  // namespace
}  // namespace dts::report
