// SPDX-License-Identifier: Apache-2.0
#include "lab/study/comparison.h"

#include <algorithm>
#include <cmath>

namespace dts::lab::study {
namespace {

using Value = double (*)(const Draw&);

struct Line {
  const char* name;
  const char* sentence;
  int of;
  std::optional<double> thesis;
  Value value;
};

double correct(const std::vector<Confusion>& answers) { return static_cast<double>(sum(answers).of_trunk().correct()); }

constexpr std::nullopt_t kNone = std::nullopt;

const std::vector<Line>& lines() {
  static const std::vector<Line> all{
      {"nn1_own_r", "NN1, trained on A to C: R on its own reaches", 0, 1.0, [](const Draw& d) { return d.nn1.own_r; }},
      {"nn1_teachers_correct", "NN1 on A to C", 135, kNone, [](const Draw& d) { return correct(d.nn1.teachers); }},
      {"nn1_healthy_correct", "NN1 on H1 to H10", 450, 424.0, [](const Draw& d) { return correct(d.nn1.healthy); }},
      {"nn1_stroke_correct", "NN1 on S1 to S5, critical boundary", 75, 70.0, [](const Draw& d) { return correct(d.nn1.stroke); }},
      {"nn2_own_r", "NN2, trained on the body model at four paces: R", 0, 1.0, [](const Draw& d) { return d.nn2.own_r; }},
      {"nn2_one_pace_teachers_correct", "NN2 with the single pace of the thesis, on A to C", 135, 134.0,
       [](const Draw& d) { return correct(d.nn2_one_pace.teachers); }},
      {"nn2_teachers_correct", "NN2 trained at four paces, on persons A to C", 135, 134.0,
       [](const Draw& d) { return correct(d.nn2.teachers); }},
      {"nn2_healthy_correct", "NN2 with four paces, on H1 to H10", 450, 438.0, [](const Draw& d) { return correct(d.nn2.healthy); }},
      {"nn2_stroke_correct", "NN2 with four paces, on S1 to S5, critical boundary", 75, 71.0,
       [](const Draw& d) { return correct(d.nn2.stroke); }},
      {"recommended_accuracy", "Recommended model, each of 13 left out: correct", 0, kNone,
       [](const Draw& d) { return sum(d.recommended.general.answers).of_trunk().accuracy(); }},
      {"recommended_kept_share", "... get an answer", 0, kNone,
       [](const Draw& d) { return d.recommended.general.kept.of_trunk().kept_share(); }},
      {"recommended_kept_accuracy", "... correct of these", 0, kNone,
       [](const Draw& d) { return d.recommended.general.kept.of_trunk().kept_accuracy(); }},
      {"recommended_kept_accuracy_by_angle", "... correct of these by the true trunk angle", 0, kNone,
       [](const Draw& d) { return d.recommended.general.kept_by_angle.kept_accuracy(); }},
      {"recommended_calibration_error", "... expected calibration error", 0, kNone,
       [](const Draw& d) { return d.recommended.general.calibration_error; }},
      {"recommended_angle_rms_deg", "... trunk angle, rms error (deg)", 0, kNone,
       [](const Draw& d) { return d.recommended.general.angle_rms_deg; }},
      {"recommended_angle_coverage", "... 90 % intervals that hold the true angle", 0, kNone,
       [](const Draw& d) { return d.recommended.general.angle_coverage; }},
      {"recommended_own_accuracy", "... with their own scale: correct", 0, kNone,
       [](const Draw& d) { return sum(d.recommended.own.answers).of_trunk().accuracy(); }},
      {"recommended_own_kept_share", "... ... get an answer", 0, kNone,
       [](const Draw& d) { return d.recommended.own.kept.of_trunk().kept_share(); }},
      {"recommended_own_kept_accuracy", "... ... correct of these", 0, kNone,
       [](const Draw& d) { return d.recommended.own.kept.of_trunk().kept_accuracy(); }},
      {"recommended_own_kept_accuracy_by_angle", "... ... correct of these by the true trunk angle", 0, kNone,
       [](const Draw& d) { return d.recommended.own.kept_by_angle.kept_accuracy(); }},
      {"recommended_own_angle_rms_deg", "... ... trunk angle, rms error (deg)", 0, kNone,
       [](const Draw& d) { return d.recommended.own.angle_rms_deg; }},
      {"recommended_own_angle_coverage", "... ... 90 % intervals that hold the true angle", 0, kNone,
       [](const Draw& d) { return d.recommended.own.angle_coverage; }},
      {"invented_accuracy", "Model of 160 invented people, as shipped, on the 13: correct", 0, kNone,
       [](const Draw& d) { return sum(d.invented.general.answers).of_trunk().accuracy(); }},
      {"invented_kept_share", "... get an answer", 0, kNone, [](const Draw& d) { return d.invented.general.kept.of_trunk().kept_share(); }},
      {"invented_kept_accuracy", "... correct of these", 0, kNone,
       [](const Draw& d) { return d.invented.general.kept.of_trunk().kept_accuracy(); }},
      {"invented_kept_accuracy_by_angle", "... correct of these by the true trunk angle", 0, kNone,
       [](const Draw& d) { return d.invented.general.kept_by_angle.kept_accuracy(); }},
      {"invented_calibration_error", "... expected calibration error", 0, kNone,
       [](const Draw& d) { return d.invented.general.calibration_error; }},
      {"invented_angle_rms_deg", "... trunk angle, rms error (deg)", 0, kNone,
       [](const Draw& d) { return d.invented.general.angle_rms_deg; }},
      {"invented_angle_coverage", "... 90 % intervals that hold the true angle", 0, kNone,
       [](const Draw& d) { return d.invented.general.angle_coverage; }},
      {"invented_own_accuracy", "... with their own scale: correct", 0, kNone,
       [](const Draw& d) { return sum(d.invented.own.answers).of_trunk().accuracy(); }},
      {"invented_own_kept_share", "... ... get an answer", 0, kNone,
       [](const Draw& d) { return d.invented.own.kept.of_trunk().kept_share(); }},
      {"invented_own_kept_accuracy", "... ... correct of these", 0, kNone,
       [](const Draw& d) { return d.invented.own.kept.of_trunk().kept_accuracy(); }},
      {"invented_own_kept_accuracy_by_angle", "... ... correct of these by the true trunk angle", 0, kNone,
       [](const Draw& d) { return d.invented.own.kept_by_angle.kept_accuracy(); }},
      {"invented_own_angle_rms_deg", "... ... trunk angle, rms error (deg)", 0, kNone,
       [](const Draw& d) { return d.invented.own.angle_rms_deg; }},
      {"invented_own_angle_coverage", "... ... 90 % intervals that hold the true angle", 0, kNone,
       [](const Draw& d) { return d.invented.own.angle_coverage; }},
  };
  return all;
}

std::vector<double> defined(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  std::ranges::sort(values);
  return values;
}

}  // namespace

double ComparedFigure::least() const {
  const auto values = defined(ours);
  return values.empty() ? kUnknown : values.front();
}

double ComparedFigure::median() const {
  const auto values = defined(ours);
  if (values.empty()) return kUnknown;
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2.0;
}

double ComparedFigure::most() const {
  const auto values = defined(ours);
  return values.empty() ? kUnknown : values.back();
}

std::vector<ComparedFigure> compare(const std::vector<Draw>& draws) {
  std::vector<ComparedFigure> figures;
  for (const Line& line : lines()) {
    ComparedFigure figure{.name = line.name, .sentence = line.sentence, .of = line.of, .thesis = line.thesis, .ours = {}};
    for (const Draw& draw : draws) figure.ours.push_back(line.value(draw));
    figures.push_back(std::move(figure));
  }
  return figures;
}

std::vector<std::string> study_notes() {
  return {
      "All reaches are simulated: synthetic, no clinical claim. Each draw has other people with the same body measures: the "
      "spread between draws shows how much a repeated study with other volunteers would vary.",
      "Table 6.2 prints 416 and 439 of 450 as totals; its own rows sum to 424 and 438, which are used here.",
      "R on a network's own reaches does not show how it performs on other people: it is 1 after every successful training.",
      "Errors belong to persons: the bias of one person shifts all fifteen reaches of a block."};
}

}  // namespace dts::lab::study
