// SPDX-License-Identifier: Apache-2.0
// Whole pages as committed texts, a line for each element of the picture: any change of a page is seen in a diff.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <pugixml.hpp>
#include <string>
#include <string_view>

#include "made_reaching.h"
#include "made_standing.h"
#include "report/chair_data.h"
#include "report/chair_pictures.h"
#include "report/page_parts.h"
#include "report/session_data.h"
#include "support/committed_text.h"
#include "unit/record/xdf_fixture.h"

namespace dts::report {
namespace {

using ::testing::HasSubstr;

/// A coordinate may differ by one in its last digit between machines: 0.01 mm of 10 mm.
constexpr double kTolerance = 1e-3;

/// A path as the box around it, its length, its first point and its last: the same whichever of two equal samples thinning keeps.
std::string outline_of(const char* data) {
  std::array<double, 4> box{1e9, 1e9, -1e9, -1e9};
  double length = 0.0;
  int lines = 0;
  std::array<double, 2> first{};
  std::array<double, 2> last{};
  char step = 0;
  double x = 0.0;
  double y = 0.0;
  int used = 0;
  while (std::sscanf(data, " %c%lf %lf%n", &step, &x, &y, &used) == 3) {
    data += used;
    if (std::string_view(data).starts_with("h0.01")) data += 5;
    if (++lines == 1) first = {x, y};
    if (step == 'L') length += std::hypot(x - last[0], y - last[1]);
    last = {x, y};
    box = {std::min(box[0], x), std::min(box[1], y), std::max(box[2], x), std::max(box[3], y)};
  }
  std::array<char, 200> text{};
  std::snprintf(text.data(), text.size(), "box %.2f %.2f %.2f %.2f length %.0f. from %.2f %.2f to %.2f %.2f", box[0], box[1], box[2],
                box[3], length, first[0], first[1], last[0], last[1]);
  return text.data();
}

/// "2.10" becomes "2.1".
std::string shortened(std::string number) {
  if (number.find('.') == std::string::npos || number.find_first_not_of("-.0123456789") != std::string::npos) return number;
  number.erase(number.find_last_not_of('0') + 1);
  if (number.ends_with('.')) number.pop_back();
  return number;
}

/// Adds the elements in `node`; texts at one height stand on one line, as the row of a table does.
void add_lines(const pugi::xml_node& node, std::string& text) {
  std::string height;
  for (const pugi::xml_node& child : node.children()) {
    if (child.type() != pugi::node_element) continue;
    const std::string_view element = child.name();
    const std::string y = element == "text" ? child.attribute("y").value() : "";
    const bool goes_on = !y.empty() && y == height;
    height = y;
    if (goes_on) text.back() = ' ';
    text += goes_on ? "; " : std::string(element) + " ";
    for (const pugi::xml_attribute& attribute : child.attributes()) {
      const std::string_view name = attribute.name();
      if (name == "stroke-linejoin" || name == "xmlns" || (name == "y" && goes_on)) continue;
      std::string value = name == "d" ? outline_of(attribute.value()) : shortened(attribute.value());
      std::ranges::replace_if(
          value, [](char letter) { return letter == '(' || letter == ')'; }, ' ');
      text += value + " ";
    }
    const std::string words = child.text().get();
    text += words.empty() ? "" : "| " + words;
    text.erase(text.find_last_not_of(' ') + 1);
    text += '\n';
    add_lines(child, text);
  }
}

/// Returns a picture as lines: the name of an element, its values and its text.
std::string lines_of_picture(const std::string& svg) {
  pugi::xml_document document;
  EXPECT_TRUE(document.load_string(svg.c_str())) << svg.substr(0, 400);
  std::string text;
  add_lines(document, text);
  return text;
}

void expect_page(const std::string& name, const std::string& svg) {
  test::expect_committed("unit/report/pages/" + name + ".txt", lines_of_picture(svg), kTolerance);
}

class PageGolden : public ::testing::Test {
 protected:
  static bool always(double) { return true; }
  [[nodiscard]] ChairData chair_of(const MadeReaching& made) {
    auto chair = read_chair_session({.files = {write_reaching(directory_ / "a.xdf", made)}, .software = "test 1"}, always);
    EXPECT_TRUE(chair) << (chair ? "" : core::to_string(chair.error()));
    if (!chair || chair->parts.size() != 1) return {};
    chair->parts[0].sha256 = "of the file";  // floats may be rounded differently on another machine
    return std::move(*chair);
  }

  record::xdf_test::Folder directory_;
};

TEST_F(PageGolden, Standing) {
  MadeStanding made{.length_s = 36.0};
  made.facts.fields = {{"weight_kg", "71.5"}};
  add_trial(made, 1, 1.0, 10.5, "eyes-open", {{"eyes", "open"}, {"feet", "two"}});
  add_trial(made, 2, 12.5, 10.5, "eyes-closed", {{"eyes", "closed"}, {"feet", "two"}});
  add_trial(made, 3, 24.0, 10.5, "eyes-open", {{"eyes", "open"}, {"feet", "two"}}, "rejected");
  auto session = read_session({.files = {write_standing(directory_ / "a.xdf", made)}, .software = "test 1"}, always);
  ASSERT_TRUE(session) << core::to_string(session.error());
  session->parts.at(0).sha256 = "of the file";
  session->plate = PlateSize{.a_mm = 430.0, .b_mm = 400.0};

  expect_page("standing_session", svg_of(session_content(*session, {.trials = 9, .pictures = 9})));
  expect_page("standing_trial", svg_of(trial_content(*session, session->trials.at(0))));
}

TEST_F(PageGolden, Reaching) {
  MadeReaching made;
  made.reaches = {{.trial = 1},
                  {.trial = 2, .condition = "max", .target_cm = 124.0, .rise_mm = 2.2},
                  {.trial = 3, .rise_mm = 1.4, .outcome = "redone"},
                  {.trial = 3, .rise_mm = 1.4, .attempt = 2},
                  {.trial = 4, .flags = core::reach_flag::kTimeout}};
  made.reaches[1].movement = {.trunk_class = core::TrunkClass::Maximum,
                              .probability = {0.0, 0.02, 0.98},
                              .trunk_deg = 52.5,
                              .trunk_lo_deg = 44.3,
                              .trunk_hi_deg = 60.8};
  made.reaches[3].movement.trunk_deg = 27.5;
  made.reaches[4].movement.trunk_class = core::TrunkClass::Rejected;
  made.reaches[4].movement.reasons = core::class_reason::kUnsure;
  const ChairData chair = chair_of(made);
  ASSERT_EQ(chair.trials.size(), 5U);

  expect_page("reaching_session", svg_of(session_content(chair, {.trials = 9, .pictures = 9})));
  expect_page("reaching_trial", svg_of(trial_content(chair, chair.trials[1])));
}

/// A small reach does not fill the picture: its axis has at least 0.3 mm above P1.
TEST_F(PageGolden, SmallReaches) {
  const ChairData chair = chair_of({.reaches = {{.trial = 1, .rise_mm = 0.1}}});
  pugi::xml_document document;
  Canvas canvas = new_picture(document, 95.0, 52.0, "small");
  draw_reaches(canvas, 95.0, 52.0, chair);
  expect_page("small_reach", text_of(document, true));
}

/// Everything that a page can have, and more than fits on one.
TEST_F(PageGolden, LayOut) {
  PageContent page{.title = "Title", .subtitle = "subtitle", .facts = {}, .alerts = {"Short.", ""}, .sections = {}};
  for (const char* name : {"One", "Two", "Three", "A long name of four"}) page.facts.push_back({.name = name, .value = "value"});
  page.facts[1].value = "a value that is longer than the width of its column on the page, so that it is broken";
  while (page.alerts[1].size() < 160) page.alerts[1] += "long alert ";
  Table table{.title = "Table",
              .columns = {{.head = "Name", .share = 2.0}, {.head = "Number of something", .is_number = true}, {.head = "Text"}},
              .rows = {{.cells = {"heading"}, .is_heading = true}, {.cells = {"a", "1.5", "words that need more than one line here"}}},
              .footnotes = {"a footnote"}};
  page.sections.push_back({.columns = {{table, Notes{.title = "Notes", .items = {"one", "two"}}},
                                       {Figure{.title = "Figure", .height_mm = 215.0, .draw = [](Canvas& canvas) {
                                                 canvas.rect(0.0, 0.0, 90.0, 215.0, "none", {});
                                               }}}}});
  for (int row = 0; row < 9; ++row) table.rows.push_back({.cells = {"row", std::to_string(row), "text"}});
  page.sections.push_back({.columns = {{std::move(table)}}});

  const auto pages = svg_document_of(std::array{page}, "footer");
  ASSERT_EQ(pages.size(), 2U);
  expect_page("lay_out", pages[0]);
  expect_page("lay_out_2", pages[1]);
  EXPECT_THAT(svg_of(page), HasSubstr("This page is full"));
}

/// What comes after a gap has other numbers of scans: 10 s after the cue are shown.
TEST_F(PageGolden, TrialThatEndsBehindAGap) {
  const ChairData chair = chair_of({.reaches = {{.trial = 1, .end_segment = 2}, {.trial = 2}, {.trial = 3}}});
  ASSERT_EQ(chair.trials.size(), 3U);
  EXPECT_EQ(chair.trials[0].trace.mm.size(), 1100U);
  EXPECT_THAT(trial_content(chair, chair.trials[0]).alerts, ::testing::Contains("Scans are missing in this trial: it has no result."));
}

TrialData cut_trial(std::uint32_t number) {
  TrialData trial{.recorded = {.trial = number, .outcome = "done"}};
  trial.analysis.emplace();
  trial.analysis->flags = posturography::sway_flag::kCutAtGap;
  trial.analysis->duration_s = 19.0;
  return trial;
}

TEST(ManyTrials, AreNamedUpToALimit) {
  const auto excluded_of = [](const SessionData& session) {
    const PageContent page = session_content(session, {.trials = 9, .pictures = 9});
    return std::get<Notes>(page.sections.back().columns.at(1).at(0)).items;
  };
  SessionData session;
  session.parts.push_back({.file = "a.xdf", .damage = ""});
  for (std::uint32_t number = 1; number <= 50; ++number) session.trials.push_back(cut_trial(number));
  EXPECT_EQ(excluded_of(session).size(), 40U);
  for (TrialData& trial : session.trials) trial.recorded.outcome = "rejected";
  session.planned_trials = 21;
  const auto excluded = excluded_of(session);
  ASSERT_EQ(excluded.size(), 21U);
  EXPECT_EQ(excluded[19], "Trial 20: rejected: not valid.");
  EXPECT_EQ(excluded[20],
            "21 of 21 planned trials have no valid result: 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, ....");
}

TEST(LiveValues, OfOneTrial_AreInTheSingular) {
  SessionData session;
  session.parts.push_back({.file = "a.xdf", .damage = ""});
  session.trials.push_back(cut_trial(1));
  session.trials[0].recorded.live.emplace();
  const PageContent page = session_content(session, {.trials = 9, .pictures = 9});
  EXPECT_EQ(std::get<Notes>(page.sections.back().columns.at(1).at(1)).items.at(0), "Live and recomputed values match in 1 trial.");
}

}  // namespace
}  // namespace dts::report
