// SPDX-License-Identifier: Apache-2.0
// The dashboard and the alert rules in config/ name metrics and labels: a name that nobody exports is a rule that never fires.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "unit/gateway/metrics/metrics_fixture.h"

namespace dts::gateway {
namespace {

using ::testing::HasSubstr;

const std::string kConfig = std::string(DTS_SOURCE_DIR) + "/config";

std::string read(const std::string& file) {
  std::ifstream stream(file);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::set<std::string> matches(const std::string& text, const std::string& pattern) {
  const std::regex wanted(pattern);
  std::set<std::string> found;
  for (auto match = std::sregex_iterator(text.begin(), text.end(), wanted); match != std::sregex_iterator(); ++match) {
    found.insert((*match)[1].str());
  }
  return found;
}

/// Names as they are written in front of labels or values.
std::set<std::string> exported_names() {
  return matches(metrics_text(carried(eventful_status()), some_counts()), R"((?:^|\n)(dts_[a-z0-9_]+)[{ ])");
}

/// "state=\"failed\"", also as a JSON text has it.
std::set<std::string> labels_in(std::string text) {
  text = std::regex_replace(text, std::regex(R"(\\")"), "\"");
  return matches(text, R"re(\b((?:state|cause|ring)="[^"$]*"))re");
}

class ShippedRules : public ::testing::TestWithParam<std::string> {};

TEST_P(ShippedRules, NameOnlyWhatIsExported) {
  const std::string text = read(kConfig + "/" + GetParam());
  const std::string exported = metrics_text(carried(eventful_status()), some_counts());
  const std::set<std::string> names = exported_names();
  const std::set<std::string> used = matches(text, R"(\b(dts_[a-z0-9_]+))");

  EXPECT_GT(used.size(), 10U) << "the file is there and says something";
  for (const std::string& name : used) EXPECT_TRUE(names.contains(name)) << name;
  for (const std::string& label : labels_in(text)) EXPECT_THAT(exported, HasSubstr(label));
}

INSTANTIATE_TEST_SUITE_P(All, ShippedRules, ::testing::Values("grafana/dtsd.json", "prometheus/dtsd-alerts.yml"),
                         [](const auto& parameter) { return parameter.index == 0 ? "Dashboard" : "Alerts"; });

TEST(ShippedDashboard, IsJsonWhosePanelsHaveQueriesAndPlacesOfTheirOwn) {
  const auto dashboard = nlohmann::json::parse(read(kConfig + "/grafana/dtsd.json"));
  std::set<int> ids;
  std::set<std::pair<int, int>> places;

  for (const auto& panel : dashboard.at("panels")) {
    EXPECT_TRUE(ids.insert(panel.at("id").get<int>()).second) << panel.at("title");
    EXPECT_TRUE(places.emplace(panel.at("gridPos").at("x"), panel.at("gridPos").at("y")).second) << panel.at("title");
    EXPECT_FALSE(panel.at("targets").empty()) << panel.at("title");
    for (const auto& target : panel.at("targets")) EXPECT_THAT(target.at("expr").get<std::string>(), HasSubstr("dts_"));
  }
  EXPECT_GE(ids.size(), 8U);
}

TEST(ShippedAlerts, EachHasExpressionSeverityAndWhatToDo) {
  const std::string text = read(kConfig + "/prometheus/dtsd-alerts.yml");
  const auto count = [&text](const std::string& pattern) {
    const std::regex wanted(pattern);
    return std::distance(std::sregex_iterator(text.begin(), text.end(), wanted), std::sregex_iterator());
  };
  const auto alerts = count("\n +- alert: [A-Z][A-Za-z]+\n");

  EXPECT_GE(alerts, 8);
  EXPECT_EQ(count("\n +expr: .+"), alerts);
  EXPECT_EQ(count("\n +severity: (warning|critical)\n"), alerts);
  EXPECT_EQ(count("\n +summary: .+"), alerts);
  EXPECT_EQ(count("\n +description: .+"), alerts);
}

}  // namespace
}  // namespace dts::gateway
