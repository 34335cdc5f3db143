// SPDX-License-Identifier: Apache-2.0
#include "lab/steadiness/discriminant_evaluation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "lab/steadiness/scores.h"

namespace dts::lab::steadiness {
namespace {

constexpr std::uint64_t kSeed = 29;
constexpr std::size_t kResamples = 2000;
constexpr std::size_t kPermutations = 499;
constexpr std::size_t kRepeats = 10;
constexpr double kWeakAuc = 0.65;  // below it, leave one out is biased: it sets a label that is not told below 0.5
constexpr const char* kAge = "age";

/// The cases that the AUC of people counts: one per person and label, with the mean of its rows.
struct Cases {
  std::vector<std::size_t> of_row;
  std::vector<std::size_t> person;
  std::vector<std::size_t> label;
};

Cases cases_of(const People& people, const std::vector<std::size_t>& classes) {
  Cases cases;
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> known;
  for (std::size_t row = 0; row < classes.size(); ++row) {
    const auto [found, is_new] = known.try_emplace({people.of_row[row], classes[row]}, cases.person.size());
    cases.of_row.push_back(found->second);
    if (!is_new) continue;
    cases.person.push_back(people.of_row[row]);
    cases.label.push_back(classes[row]);
  }
  return cases;
}

/// Returns the probability of class `one` for each row; a row without an answer has that of a guess.
std::vector<double> column_of(const Predictions& predictions, std::size_t one, std::size_t class_count) {
  std::vector<double> column;
  for (const auto& row : predictions) column.push_back(row.empty() ? 1.0 / static_cast<double>(class_count) : row[one]);
  return column;
}

std::vector<double> pooled(const std::vector<double>& rows, const Cases& cases) {
  std::vector<double> sums(cases.person.size(), 0.0);
  std::vector<double> counts(cases.person.size(), 0.0);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    sums[cases.of_row[row]] += rows[row];
    counts[cases.of_row[row]] += 1.0;
  }
  for (std::size_t k = 0; k < sums.size(); ++k) sums[k] /= counts[k];
  return sums;
}

std::vector<bool> is_class(const std::vector<std::size_t>& classes, std::size_t one) {
  std::vector<bool> is;
  for (const std::size_t each : classes) is.push_back(each == one);
  return is;
}

/// Returns the classes of which each is compared with the rest. Of two classes, one is enough.
std::vector<std::size_t> compared_classes(std::size_t class_count) {
  std::vector<std::size_t> classes(class_count == 2 ? 1 : class_count);
  std::iota(classes.begin(), classes.end(), class_count == 2 ? std::size_t{1} : std::size_t{0});
  return classes;
}

/// Rankings of people, of every repetition and every class against the rest; the AUC is the mean over them.
using Rankings = std::vector<Ranking>;

Rankings rank_people(const std::vector<Predictions>& repeats, const Cases& cases, std::size_t class_count) {
  Rankings rankings;
  for (const Predictions& predictions : repeats) {
    for (const std::size_t one : compared_classes(class_count))
      rankings.emplace_back(pooled(column_of(predictions, one, class_count), cases), is_class(cases.label, one));
  }
  return rankings;
}

double mean_auc(const Rankings& rankings, const std::vector<double>& weights) {
  double sum = 0.0;
  for (const Ranking& ranking : rankings) sum += ranking.auc(weights).value_or(0.5);
  return sum / static_cast<double>(rankings.size());
}

/// Sets everything of a contest but its intervals.
Contest contest_of(std::string name, const std::vector<Predictions>& repeats, const std::vector<std::size_t>& classes,
                   std::size_t class_count) {
  Contest contest{.name = std::move(name), .auc = {}, .auc_trials = 0.0, .equal_error_correct = 0.0};
  const auto compared = compared_classes(class_count);
  const double share = 1.0 / static_cast<double>(repeats.size() * compared.size());
  double slopes = 0.0;
  bool has_slopes = class_count == 2;
  for (const Predictions& predictions : repeats) {
    for (const std::size_t one : compared) {
      const auto column = column_of(predictions, one, class_count);
      const auto is_one = is_class(classes, one);
      const Ranking ranking(column, is_one);
      contest.auc_trials += share * ranking.auc().value_or(0.5);
      contest.equal_error_correct += share * ranking.equal_error_correct();
      const auto slope = has_slopes ? calibration_slope(column, is_one) : std::nullopt;
      has_slopes = has_slopes && slope;
      slopes += share * slope.value_or(0.0);
    }
    double squares = 0.0;
    for (std::size_t one = 0; one < class_count; ++one) {
      const auto column = column_of(predictions, one, class_count);
      for (std::size_t row = 0; row < column.size(); ++row) {
        const double error = column[row] - (classes[row] == one ? 1.0 : 0.0);
        squares += 0.5 * error * error;
      }
    }
    contest.brier += squares / static_cast<double>(classes.size() * repeats.size());
  }
  if (has_slopes) contest.slope = slopes;
  return contest;
}

Interval interval_of(double value, std::vector<double> drawn) {
  if (drawn.empty()) return {.value = value, .low = value, .high = value};
  std::ranges::sort(drawn);
  const auto at = [&](double share) { return drawn[static_cast<std::size_t>(share * static_cast<double>(drawn.size() - 1) + 0.5)]; };
  return {.value = value, .low = at(0.025), .high = at(0.975)};
}

/// Sets the AUC of people with its interval, and the gain of the first contest over each other one, by bootstrap over people.
void add_intervals(const std::vector<Contest*>& contests, const std::vector<Rankings>& rankings, const Cases& cases, const People& people) {
  const std::vector<double> once(cases.person.size(), 1.0);
  std::vector<std::vector<double>> aucs(contests.size());
  std::vector<std::vector<double>> gains(contests.size());
  LabRandom random(kSeed);
  for (std::size_t k = 0; k < kResamples; ++k) {
    std::vector<double> drawn(people.count, 0.0);
    for (std::size_t person = 0; person < people.count; ++person) drawn[random.index(people.count)] += 1.0;
    std::vector<double> weights;
    std::set<std::size_t> labels;
    for (std::size_t one = 0; one < cases.person.size(); ++one) {
      weights.push_back(drawn[cases.person[one]]);
      if (weights.back() > 0.0) labels.insert(cases.label[one]);
    }
    if (labels.size() < 2) continue;  // no AUC is defined
    for (std::size_t c = 0; c < contests.size(); ++c) {
      aucs[c].push_back(mean_auc(rankings[c], weights));
      gains[c].push_back(aucs[0].back() - aucs[c].back());
    }
  }
  const double model_auc = mean_auc(rankings[0], once);
  for (std::size_t c = 0; c < contests.size(); ++c) {
    const double auc = mean_auc(rankings[c], once);
    contests[c]->auc = interval_of(auc, std::move(aucs[c]));
    contests[c]->gain = interval_of(model_auc - auc, std::move(gains[c]));
  }
}

std::vector<std::size_t> all_columns(const Inputs& inputs) {
  std::vector<std::size_t> columns(inputs.columns.size());
  std::iota(columns.begin(), columns.end(), std::size_t{0});
  return columns;
}

/// Returns the rivals, and if there are several, all of them together.
std::vector<Rival> with_all_together(const std::vector<Rival>& rivals) {
  std::vector<Rival> all = rivals;
  if (rivals.size() < 2) return all;
  Rival together;
  for (const Rival& rival : rivals) {
    together.name += (together.name.empty() ? "" : " with ") + rival.name;
    together.columns.insert(together.columns.end(), rival.columns.begin(), rival.columns.end());
  }
  all.push_back(std::move(together));
  return all;
}

LeftOutTest test_left_out(const Samples& samples, const Inputs& inputs, const std::vector<Rival>& rivals, const People& people,
                          const std::vector<Folds>& repeats) {
  LeftOutTest test;
  std::vector<Predictions> by_model;
  std::vector<Predictions> by_best;
  std::map<std::size_t, std::size_t> chosen;
  for (const Folds& folds : repeats) {
    by_model.push_back(predict_left_out(inputs, all_columns(inputs), folds));
    BestColumn best = predict_by_best_column(inputs, folds);
    for (const auto& [column, count] : best.chosen) chosen[column] += count;
    by_best.push_back(std::move(best.predictions));
    test.folds += folds.count;
  }
  const Cases cases = cases_of(people, inputs.classes);
  const auto most = std::ranges::max_element(chosen, {}, [](const auto& one) { return one.second; });
  test.best_measure = posturography::info(samples.measures[most->first]).symbol;
  test.best_chosen_by = most->second;
  test.model = contest_of(std::to_string(inputs.columns.size()) + " measures", by_model, inputs.classes, inputs.class_count);
  test.best = contest_of(test.best_measure, by_best, inputs.classes, inputs.class_count);
  std::vector<Rankings> rankings{rank_people(by_model, cases, inputs.class_count), rank_people(by_best, cases, inputs.class_count)};
  for (const Rival& rival : with_all_together(rivals)) {
    const Inputs facts{.columns = rival.columns, .classes = inputs.classes, .class_count = inputs.class_count};
    std::vector<Predictions> by_rival;
    for (const Folds& folds : repeats) by_rival.push_back(predict_left_out(facts, all_columns(facts), folds));
    test.rivals.push_back(contest_of(rival.name, by_rival, inputs.classes, inputs.class_count));
    rankings.push_back(rank_people(by_rival, cases, inputs.class_count));
  }
  std::vector<Contest*> contests{&test.model, &test.best};
  for (Contest& rival : test.rivals) contests.push_back(&rival);
  add_intervals(contests, rankings, cases, people);
  return test;
}

/// Returns the classes of the rows in random order: of whole people, or if a person has several labels, of the rows of each person.
std::vector<std::size_t> permuted(const std::vector<std::size_t>& classes, const People& people, LabRandom& random) {
  std::vector<std::vector<std::size_t>> rows_of(people.count);
  for (std::size_t row = 0; row < classes.size(); ++row) rows_of[people.of_row[row]].push_back(row);
  std::vector<std::size_t> mixed(classes.size());
  if (people.is_label_of_person) {
    const auto order = random.shuffled(people.count);
    for (std::size_t person = 0; person < people.count; ++person) {
      for (const std::size_t row : rows_of[person]) mixed[row] = classes[rows_of[order[person]].front()];
    }
    return mixed;
  }
  for (const auto& rows : rows_of) {
    const auto order = random.shuffled(rows.size());
    for (std::size_t k = 0; k < rows.size(); ++k) mixed[rows[k]] = classes[rows[order[k]]];
  }
  return mixed;
}

/// Returns the share of random labels that are predicted as well as the true ones, in ten folds each.
double permutation_p(const Inputs& inputs, const People& people, const std::function<void(double)>& progress) {
  LabRandom random(kSeed + 1);
  const auto auc_in_ten_folds = [&](const Inputs& tested) {
    const std::vector<Predictions> predictions{predict_left_out(tested, all_columns(tested), ten_folds(people, random))};
    const Cases cases = cases_of(people, tested.classes);
    return mean_auc(rank_people(predictions, cases, tested.class_count), std::vector<double>(cases.person.size(), 1.0));
  };
  double observed = 0.0;
  for (std::size_t k = 0; k < kRepeats; ++k) observed += auc_in_ten_folds(inputs) / static_cast<double>(kRepeats);
  std::size_t as_well = 0;
  Inputs random_labels = inputs;
  for (std::size_t k = 0; k < kPermutations; ++k) {
    progress(static_cast<double>(k) / static_cast<double>(kPermutations));
    random_labels.classes = permuted(inputs.classes, people, random);
    if (auc_in_ten_folds(random_labels) >= observed) ++as_well;
  }
  return static_cast<double>(as_well + 1) / static_cast<double>(kPermutations + 1);
}

/// Returns whether one fact of two classes separates them without error: it defines the label.
bool is_definition(const Rival& rival, const Inputs& inputs) {
  if (rival.columns.size() != 1) return false;
  for (std::size_t one = 0; one < inputs.class_count; ++one) {
    const auto auc = Ranking(rival.columns.front(), is_class(inputs.classes, one)).auc();
    if (!auc || (*auc > 0.0 && *auc < 1.0)) return false;
  }
  return true;
}

void add_shares(const Samples& samples, const Inputs& inputs, const People& people, Evaluation& evaluation) {
  const std::size_t classes = evaluation.classes.size();
  evaluation.confusion.assign(classes, std::vector<std::size_t>(classes + 1));
  const Predictions predictions = predict_left_out(inputs, all_columns(inputs), leave_one_out(people));
  for (std::size_t row = 0; row < predictions.size(); ++row) {
    const auto& answer = predictions[row];
    const auto predicted = answer.empty() ? classes : static_cast<std::size_t>(std::ranges::max_element(answer) - answer.begin());
    ++evaluation.confusion[inputs.classes[row]][predicted];
  }
  std::size_t commonest = 0;
  double squares = 0.0;
  evaluation.rows = predictions.size();
  for (std::size_t k = 0; k < classes; ++k) {
    const auto& predicted = evaluation.confusion[k];
    const std::size_t count = std::accumulate(predicted.begin(), predicted.end(), std::size_t{0});
    evaluation.correct += predicted[k];
    commonest = std::max(commonest, count);
    evaluation.balanced_accuracy += static_cast<double>(predicted[k]) / static_cast<double>(count * classes);
    const double share = static_cast<double>(count) / static_cast<double>(evaluation.rows);
    squares += share * share;
  }
  evaluation.brier_base = 0.5 * (1.0 - squares);
  evaluation.accuracy = static_cast<double>(evaluation.correct) / static_cast<double>(evaluation.rows);
  evaluation.commonest_share = static_cast<double>(commonest) / static_cast<double>(evaluation.rows);
  evaluation.rows_without = static_cast<std::size_t>(std::ranges::count(samples.subjects, std::string()));
}

/// Returns whether age was compared, or defines the label, or is the same in all classes because every person has rows of each class.
bool is_age_excluded(const Evaluation& evaluation, const std::vector<std::size_t>& classes) {
  const auto& rivals = evaluation.left_out.rivals;
  return std::ranges::find(rivals, kAge, &Contest::name) != rivals.end() ||
         std::ranges::find(evaluation.definitions, kAge) != evaluation.definitions.end() ||
         cases_of(evaluation.people, classes).person.size() == evaluation.people.count * evaluation.classes.size();
}

/// The label is distinguished if people left out show it beyond chance, and no other fact of theirs shows it clearly better.
/// Age explains much of what is known about people, so the verdict needs it.
void judge(Evaluation& evaluation) {
  const LeftOutTest& test = evaluation.deciding();
  const auto is_clearly_better = [](const Contest& rival) { return rival.gain.high < 0.0 && rival.auc.low > 0.5; };
  const auto better = std::ranges::find_if(test.rivals, is_clearly_better);
  if (better != test.rivals.end()) {
    evaluation.verdict = Verdict::ToldByOther;
    evaluation.told_by = better->name;
  } else if (test.model.auc.low > 0.5 && evaluation.permutation_p <= Evaluation::kMostP && !evaluation.is_of_too_few() &&
             evaluation.is_age_excluded) {
    evaluation.verdict = Verdict::Told;
  }
}

}  // namespace

core::Result<Evaluation> evaluate_left_out(const Samples& samples, const std::vector<Rival>& rivals,
                                           const std::function<void(double)>& progress) {
  DTS_TRY_ASSIGN(const auto whole, fit_all(samples));
  Evaluation evaluation{.classes = whole.classes, .confusion = {}, .left_out = {}};
  const Inputs inputs = inputs_of(samples, whole.classes);
  evaluation.people = people_of(samples.subjects, samples.labels);
  const People& people = evaluation.people;
  std::vector<Rival> compared;
  for (const Rival& rival : rivals) {
    if (is_definition(rival, inputs)) {
      evaluation.definitions.push_back(rival.name);
    } else {
      compared.push_back(rival);
    }
  }
  add_shares(samples, inputs, people, evaluation);
  evaluation.left_out = test_left_out(samples, inputs, compared, people, {leave_one_out(people)});
  evaluation.left_out.scheme = "leave one out";
  if (evaluation.left_out.model.auc.value < kWeakAuc) {
    LabRandom random(kSeed + 2);
    std::vector<Folds> repeats;
    for (std::size_t k = 0; k < kRepeats; ++k) repeats.push_back(ten_folds(people, random));
    evaluation.ten_fold = test_left_out(samples, inputs, compared, people, repeats);
    evaluation.ten_fold->scheme = "10 x 10-fold";
  }
  evaluation.permutation_p = permutation_p(inputs, people, progress);
  evaluation.is_age_excluded = is_age_excluded(evaluation, inputs.classes);
  judge(evaluation);
  return evaluation;
}

pattern::Figures figures_of(const Evaluation& evaluation) {
  const LeftOutTest& test = evaluation.deciding();
  pattern::Figures figures{.scheme = test.scheme,
                           .auc = test.model.auc,
                           .auc_trials = test.model.auc_trials,
                           .equal_error_correct = test.model.equal_error_correct,
                           .brier = test.model.brier,
                           .brier_base = evaluation.brier_base,
                           .slope = test.model.slope,
                           .accuracy = evaluation.accuracy,
                           .balanced_accuracy = evaluation.balanced_accuracy,
                           .commonest_share = evaluation.commonest_share,
                           .permutation_p = evaluation.permutation_p,
                           .best_measure = test.best_measure,
                           .best_auc = test.best.auc,
                           .gain = test.best.gain,
                           .rival = {},
                           .rival_auc = {},
                           .rival_gain = {}};
  const auto strongest = std::ranges::max_element(test.rivals, {}, [](const Contest& rival) { return rival.auc.value; });
  if (strongest == test.rivals.end()) return figures;
  figures.rival = strongest->name;
  figures.rival_auc = strongest->auc;
  figures.rival_gain = strongest->gain;
  return figures;
}

}  // namespace dts::lab::steadiness
