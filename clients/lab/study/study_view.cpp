// SPDX-License-Identifier: Apache-2.0
#include "lab/study/study_view.h"

#include "cli/table.h"
#include "lab/study/angle_windows.h"
#include "lab/study/comparison.h"

namespace dts::lab::study {
namespace {

using cli::decimal;
using core::TrunkClass;

constexpr std::array<TrunkClass, 4> kWanted = {TrunkClass::None, TrunkClass::Minor, TrunkClass::Moderate, TrunkClass::Maximum};

const char* word(TrunkClass trunk_class) {
  switch (trunk_class) {
    case TrunkClass::Rejected: return "no_answer";
    case TrunkClass::None: return "none";
    case TrunkClass::Minor: return "minor";
    case TrunkClass::Moderate: return "moderate";
    case TrunkClass::Maximum: return "maximum";
  }
  return "?";
}

cli::Json to_json(const Confusion& answers) {
  cli::Json json = cli::Json::object();
  for (const TrunkClass wanted : kWanted) {
    if (answers.of(wanted) == 0) continue;
    for (const TrunkClass answer : kEveryAnswer) json[word(wanted)][word(answer)] = answers.count(wanted, answer);
  }
  return json;
}

template <class Names>
cli::Json to_json(const std::vector<Confusion>& answers, const Names& name_of) {
  cli::Json json = cli::Json::object();
  for (std::size_t k = 0; k < answers.size(); ++k) json[std::string(name_of(k))] = to_json(answers[k]);
  return json;
}

cli::Json to_json(const NetworkResult& result) {
  cli::Json json{{"trained_on", result.trained_on}};
  cli::set_number(json, "own_r", result.own_r);
  json["teachers"] = to_json(result.teachers, [](std::size_t k) { return teachers()[k].name; });
  json["healthy"] = to_json(result.healthy, [](std::size_t k) { return healthy()[k].name; });
  json["stroke"] = to_json(result.stroke, [](std::size_t k) { return stroke()[k].name; });
  return json;
}

cli::Json to_json(const Draw& draw) {
  const auto name_of = [&](std::size_t k) { return draw.recommended.names[k]; };
  return {{"seed", draw.seed},
          {"nn1", to_json(draw.nn1)},
          {"nn2_one_pace", to_json(draw.nn2_one_pace)},
          {"nn2", to_json(draw.nn2)},
          {"recommended", to_json(draw.recommended.general.answers, name_of)},
          {"recommended_own_scale", to_json(draw.recommended.own.answers, name_of)}};
}

cli::Json to_json(const ComparedFigure& figure) {
  cli::Json json{{"name", figure.name}, {"what", figure.sentence}};
  if (figure.of > 0) json["of"] = figure.of;
  if (figure.thesis) json["thesis"] = *figure.thesis;
  cli::set_number(json, "least", figure.least());
  cli::set_number(json, "median", figure.median());
  cli::set_number(json, "most", figure.most());
  json["draws"] = figure.ours;  // values that are not finite become null
  return json;
}

cli::Json to_json(const Window& window) {
  return {{"least_deg", window.least_deg}, {"mean_deg", window.mean_deg}, {"most_deg", window.most_deg}};
}

std::string figure_text(const ComparedFigure& figure, double value) {
  return figure.of > 0 ? decimal(value, 0) + "/" + std::to_string(figure.of) : decimal(value, 3);
}

void print_comparison(const std::vector<Draw>& draws, cli::Console& console) {
  cli::Table table({"EXPERIMENT", ">THESIS", ">OURS, MEDIAN", ">LEAST", ">MOST"});
  for (const ComparedFigure& figure : compare(draws)) {
    table.add({{figure.sentence},
               {figure.thesis ? figure_text(figure, *figure.thesis) : "-"},
               {figure_text(figure, figure.median())},
               {figure_text(figure, figure.least())},
               {figure_text(figure, figure.most())}});
  }
  table.print(console);
}

void print_volunteers(const Draw& draw, cli::Console& console) {
  console.out << '\n'
              << cli::styled(console, cli::Style::Bold, "Correct of 15, median draw (seed " + std::to_string(draw.seed) + ")") << "\n\n";
  cli::Table table({"VOLUNTEER", "120 % NN1", "NN2", "150 % NN1", "NN2", "MAXIMUM NN1", "NN2"});
  const auto add = [&](std::string_view name, const Confusion& nn1, const Confusion& nn2) {
    std::vector<cli::Cell> cells{{std::string(name)}};
    for (const TrunkClass wanted : {TrunkClass::Minor, TrunkClass::Moderate, TrunkClass::Maximum}) {
      cells.push_back({cell_text(nn1, wanted)});
      cells.push_back({cell_text(nn2, wanted)});
    }
    table.add(std::move(cells));
  };
  for (std::size_t k = 0; k < draw.nn1.teachers.size(); ++k) add(teachers()[k].name, draw.nn1.teachers[k], draw.nn2.teachers[k]);
  for (std::size_t k = 0; k < draw.nn1.healthy.size(); ++k) add(healthy()[k].name, draw.nn1.healthy[k], draw.nn2.healthy[k]);
  for (std::size_t k = 0; k < draw.nn1.stroke.size(); ++k) add(stroke()[k].name, draw.nn1.stroke[k], draw.nn2.stroke[k]);
  table.print(console);
}

void print_left_out(const Draw& draw, cli::Console& console) {
  const RecommendedResult& result = draw.recommended;
  if (result.names.empty()) return;
  console.out << '\n' << cli::styled(console, cli::Style::Bold, "Recommended model, each left out: without and with own scale") << "\n\n";
  cli::Table table({"VOLUNTEER", "WITHIN REACH", "OWN", "120 %", "OWN", "150 %", "OWN", "MAXIMUM", "OWN"});
  for (std::size_t k = 0; k < result.names.size(); ++k) {
    std::vector<cli::Cell> cells{{result.names[k]}};
    for (const TrunkClass wanted : kWanted) {
      cells.push_back({cell_text(result.general.answers[k], wanted)});
      cells.push_back({cell_text(result.own.answers[k], wanted)});
    }
    table.add(std::move(cells));
  }
  table.print(console);
}

void print_windows(cli::Console& console) {
  console.out << '\n' << cli::styled(console, cli::Style::Bold, "Trunk angle of H1 to H10 (deg)") << "\n\n";
  cli::Table table({"TARGET", ">MEASURED", ">FROM THE TARGET", ">BIAS", ">RMS"});
  const auto text = [](const Window& window) {
    return decimal(window.least_deg, 1) + " .. " + decimal(window.mean_deg, 1) + " .. " + decimal(window.most_deg, 1);
  };
  for (const AngleWindow& window : angle_windows()) {
    table.add({{std::string(window.condition)},
               {text(window.measured)},
               {text(window.geometry)},
               {decimal(window.bias_deg, 1)},
               {decimal(window.rms_deg, 1)}});
  }
  table.print(console);
}

}  // namespace

std::string cell_text(const Confusion& answers, TrunkClass wanted) {
  if (answers.of(wanted) == 0) return "-";
  std::string others;
  for (const TrunkClass answer : kEveryAnswer) {
    const std::size_t count = answers.count(wanted, answer);
    const std::string what = answer == TrunkClass::Rejected ? "no answer" : word(answer);  // no reach found, or unfit
    if (answer != wanted && count > 0) others += (others.empty() ? "" : ", ") + std::to_string(count) + " " + what;
  }
  return std::to_string(answers.correct(wanted)) + (others.empty() ? "" : " (" + others + ")");
}

cli::Json to_json(const std::vector<Draw>& draws) {
  cli::Json json{{"is_synthetic", true},
                 {"middle_seed", middle_draw(draws).seed},
                 {"figures", cli::Json::array()},
                 {"angle_windows", cli::Json::array()}};
  for (const ComparedFigure& figure : compare(draws)) json["figures"].push_back(to_json(figure));
  for (const AngleWindow& window : angle_windows()) {
    json["angle_windows"].push_back({{"condition", std::string(window.condition)},
                                     {"measured", to_json(window.measured)},
                                     {"geometry", to_json(window.geometry)},
                                     {"bias_deg", window.bias_deg},
                                     {"rms_deg", window.rms_deg}});
  }
  json["draws"] = cli::Json::array();
  for (const Draw& draw : draws) json["draws"].push_back(to_json(draw));
  json["notes"] = study_notes();
  return json;
}

void print(const std::vector<Draw>& draws, cli::Console& console) {
  print_comparison(draws, console);
  print_volunteers(middle_draw(draws), console);
  print_left_out(middle_draw(draws), console);
  print_windows(console);
  console.out << '\n';
  for (const std::string& note : study_notes()) console.out << "- " << note << '\n';
}

}  // namespace dts::lab::study
