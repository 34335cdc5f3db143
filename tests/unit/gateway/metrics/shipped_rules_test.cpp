// SPDX-License-Identifier: Apache-2.0
// The dashboard and the alert rules in config/ name metrics and labels: a name that nobody exports is a rule that never fires.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "unit/gateway/metrics/metrics_fixture.h"

namespace dts::gateway {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

using Names = std::set<std::string>;

std::string shipped(const std::string& file) {
  std::ifstream stream(std::string(DTS_SOURCE_DIR) + "/config/" + file);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::vector<std::smatch> matches(const std::string& text, const std::string& pattern) {
  const std::regex wanted(pattern);
  return {std::sregex_iterator(text.begin(), text.end(), wanted), std::sregex_iterator()};
}

Names first_groups(const std::string& text, const std::string& pattern) {
  Names found;
  for (const std::smatch& match : matches(text, pattern)) found.insert(match[1].str());
  return found;
}

/// What is written in front of a value: all series of one name.
struct Series {
  bool is_cumulative = false;           ///< Of a counter or a histogram: its value says nothing, only its growth does.
  std::map<std::string, Names> labels;  ///< The values of each.
};
using Page = std::map<std::string, Series>;

Page exported_page() {
  Page page;
  std::istringstream lines(metrics_text(carried(eventful_status()), some_counts()));
  bool is_cumulative = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("# TYPE ")) is_cumulative = !line.ends_with(" gauge");
    if (line.starts_with('#')) continue;
    Series& series = page[line.substr(0, line.find_first_of("{ "))];
    series.is_cumulative = is_cumulative;
    for (const std::smatch& label : matches(line, R"re((\w+)="([^"]*)")re")) series.labels[label[1].str()].insert(label[2].str());
  }
  return page;
}

/// Prometheus adds these two to all that it reads.
bool is_known(const std::string& label, const Series& series) {
  return label == "instance" || label == "job" || series.labels.contains(label);
}

/// `matchers`: state="failed",rig=~"$rig"; what Grafana puts in place of its variables is not known here.
void check_matchers(const std::string& matchers, const Series& series) {
  for (const std::smatch& match : matches(matchers, R"re((\w+)\s*(=~|!~|!=|=)\s*"([^"]*)")re")) {
    const std::string label = match[1].str();
    EXPECT_TRUE(is_known(label, series)) << match.str();
    if (!series.labels.contains(label) || match[3].str().starts_with('$')) continue;
    EXPECT_THAT(series.labels.at(label), Contains(match[3].str())) << match.str();
  }
}

Names grouped_by(const std::string& expression, const std::string& keyword) {
  Names labels;
  const std::string lists = "\\b(?:" + keyword + R"()\s*\(([^)]*)\))";
  for (const std::string& list : first_groups(expression, lists)) labels.merge(first_groups(list, R"((\w+))"));
  return labels;
}

/// Every metric is exported, with the labels that it is chosen, grouped or joined by, and is used as its kind wants it.
void check_expression(const std::string& expression, const Page& page) {
  SCOPED_TRACE(expression);
  const Names grouping = grouped_by(expression, "by|on|without|ignoring");
  // function( name {matchers} [range]
  for (const std::smatch& use : matches(expression, R"re((?:\b(\w+)\()?\b(dts_\w+)(?:\{([^}]*)\})?(\[)?)re")) {
    const auto exported = page.find(use[2].str());
    ASSERT_NE(exported, page.end()) << use[2].str() << " is not exported";
    const Series& series = exported->second;
    check_matchers(use[3].str(), series);
    for (const std::string& label : grouping) EXPECT_TRUE(is_known(label, series)) << use[2].str() << " has no label " << label;
    const bool is_growth = use[1] == "rate" || use[1] == "increase";
    const bool counts_starts = use[1] == "resets";  // of an uptime too, which is no counter
    EXPECT_TRUE(series.is_cumulative ? is_growth || counts_starts : !is_growth) << use.str();
    EXPECT_EQ(is_growth || counts_starts, use[4].matched) << use.str() << " needs a range, or must have none";
  }
}

/// A legend or a summary can only name what the result still has.
void check_named_labels(const Names& named, const std::string& expression, const Page& page) {
  const Names kept = grouped_by(expression, "by");
  const auto metrics = matches(expression, R"(\bdts_\w+)");
  for (const std::string& label : named) {
    const bool is_kept = kept.empty() || kept.contains(label);
    const bool is_there = metrics.empty() ? label == "instance" : is_known(label, page.at(metrics.front().str()));
    EXPECT_TRUE(is_kept && is_there) << expression << " has no label " << label;
  }
}

struct Panel {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
  std::string title;
};

Panel to_panel(const nlohmann::json& panel) {
  const auto& at = panel.at("gridPos");
  return {.x = at.at("x"), .y = at.at("y"), .width = at.at("w"), .height = at.at("h"), .title = panel.at("title")};
}

bool do_overlap(const Panel& one, const Panel& other) {
  return one.x < other.x + other.width && other.x < one.x + one.width && one.y < other.y + other.height && other.y < one.y + one.height;
}

class ShippedRules : public ::testing::TestWithParam<std::string> {};

TEST_P(ShippedRules, NameOnlyWhatIsExported) {
  const Names used = first_groups(shipped(GetParam()), R"(\b(dts_[a-z0-9_]+))");
  const Page page = exported_page();

  EXPECT_GT(used.size(), 10U) << "the file is there and says something";
  for (const std::string& name : used) EXPECT_TRUE(page.contains(name)) << name;
}

INSTANTIATE_TEST_SUITE_P(All, ShippedRules, ::testing::Values("grafana/dtsd.json", "prometheus/dtsd-alerts.yml"),
                         [](const auto& parameter) { return parameter.index == 0 ? "Dashboard" : "Alerts"; });

TEST(ShippedDashboard, AsksForWhatIsExported_MachineByMachine) {
  const auto dashboard = nlohmann::json::parse(shipped("grafana/dtsd.json"));
  const Page page = exported_page();

  for (const auto& panel : dashboard.at("panels")) {
    EXPECT_FALSE(panel.at("targets").empty()) << panel.at("title");
    for (const auto& target : panel.at("targets")) {
      const std::string expression = target.at("expr");
      const std::string legend = target.at("legendFormat");
      EXPECT_THAT(expression, HasSubstr("dts_"));
      check_expression(expression, page);
      const Names named = first_groups(legend, R"(\{\{(\w+)\}\})");
      EXPECT_THAT(named, Contains("instance")) << panel.at("title") << ": " << legend;
      check_named_labels(named, expression, page);
    }
  }
}

TEST(ShippedDashboard, ItsVariables_AreLabels) {
  const auto dashboard = nlohmann::json::parse(shipped("grafana/dtsd.json"));
  const Page page = exported_page();
  std::size_t variables = 0;

  for (const auto& variable : dashboard.at("templating").at("list")) {
    if (variable.at("type") != "query") continue;
    ++variables;
    const std::string query = variable.at("query").at("query");
    std::smatch match;
    ASSERT_TRUE(std::regex_match(query, match, std::regex(R"(label_values\((dts_\w+)(?:\{([^}]*)\})?, (\w+)\))"))) << query;
    ASSERT_TRUE(page.contains(match[1].str())) << query;
    EXPECT_TRUE(is_known(match[3].str(), page.at(match[1].str()))) << query;
    check_matchers(match[2].str(), page.at(match[1].str()));
  }
  EXPECT_EQ(variables, 2U);
}

TEST(ShippedDashboard, ItsPanels_HaveNumbersAndPlacesOfTheirOwn) {
  const auto dashboard = nlohmann::json::parse(shipped("grafana/dtsd.json"));
  constexpr int kColumns = 24;
  std::set<int> numbers;
  std::vector<Panel> placed;

  for (const auto& described : dashboard.at("panels")) {
    const Panel panel = to_panel(described);
    EXPECT_TRUE(numbers.insert(described.at("id").get<int>()).second) << panel.title;
    EXPECT_TRUE(panel.x >= 0 && panel.y >= 0 && panel.width > 0 && panel.height > 0 && panel.x + panel.width <= kColumns) << panel.title;
    for (const Panel& other : placed) EXPECT_FALSE(do_overlap(panel, other)) << panel.title << " lies on " << other.title;
    placed.push_back(panel);
  }
  EXPECT_GE(placed.size(), 8U);
}

TEST(ShippedAlerts, AskForWhatIsExported_WithSeverityAndWhatToDo) {
  RecordProperty("requirement", "CFG-7");
  const std::string text = shipped("prometheus/dtsd-alerts.yml");
  const Page page = exported_page();
  const std::string head = R"re(\n +- alert: [A-Z][A-Za-z]+\n +expr: (.+)\n(?: +for: \d+[sm]\n)? +labels:\n)re";
  const std::string tail = R"re( +severity: (?:warning|critical)\n +annotations:\n +summary: "(.+)"\n +description: "(.+)"\n)re";
  const auto alerts = matches(text, head + tail);

  EXPECT_GE(alerts.size(), 8U);
  EXPECT_EQ(alerts.size(), matches(text, "- alert:").size()) << "one lacks something";
  for (const std::smatch& alert : alerts) {
    const std::string expression = alert[1].str();
    check_expression(expression, page);
    check_named_labels(first_groups(alert[2].str() + alert[3].str(), R"(\$labels\.(\w+))"), expression, page);
  }
}

}  // namespace
}  // namespace dts::gateway
