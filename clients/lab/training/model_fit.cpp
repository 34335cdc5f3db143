// SPDX-License-Identifier: Apache-2.0
#include "lab/training/model_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "classifier/trunk_model_parts.h"
#include "lab/training/fits.h"
#include "lab/training/network_training.h"

namespace dts::lab::training {
namespace {

using classifier::FeatureRange;
using classifier::ReachFeature;
using classifier::SubjectCalibration;
using core::TrunkClass;

// Weight-free: features that change least between bodies. The place on the seat and the dip explain part of the difference between people.
constexpr std::array kGeneralFeatures = {ReachFeature::RelativeD1, ReachFeature::RelativeD2, ReachFeature::RelativeHold,
                                         ReachFeature::RestRatio, ReachFeature::RatioChange};
constexpr std::array kOwnFeatures = {ReachFeature::OwnD2, ReachFeature::OwnHold, ReachFeature::OwnRatioChange};
constexpr std::array kAngleFeatures = {ReachFeature::RelativeD2, ReachFeature::RelativeHold, ReachFeature::RatioChange};
constexpr std::array kArmAloneFeatures = {ReachFeature::RelativeD1, ReachFeature::RelativeD2, ReachFeature::RatioChange};
constexpr std::array kRawFeatures = {ReachFeature::D1, ReachFeature::D2, ReachFeature::P1, ReachFeature::P2, ReachFeature::P3};

constexpr double kTail = 0.005;  ///< Fraction of the reaches at each end that does not widen a range: one failed extraction would compress
                                 ///< all others.
constexpr double kQuadraticRidge = 1e-3;
constexpr double kLogisticRidge = 1e-4;
constexpr double kDecay = 1e-2;
constexpr double kWideResidualDeg = 30.0;

/// A reach with the subject's own scale that is applied to it.
struct Row {
  const TrainingReach* reach = nullptr;
  const SubjectCalibration* subject = nullptr;
  double weight = 1.0;
};

double sine_of(double deg) { return std::sin(deg * std::numbers::pi / 180.0); }

template <std::size_t Count>
core::Result<std::vector<FeatureRange>> ranges_of(const std::array<ReachFeature, Count>& features, const std::vector<Row>& rows,
                                                  double tail) {
  std::vector<FeatureRange> ranges;
  for (const ReachFeature feature : features) {
    std::vector<double> values;
    for (const auto& [reach, subject, weight] : rows) {
      const double value = value_of(feature, reach->features, subject);
      if (std::isfinite(value)) values.push_back(value);
    }
    std::sort(values.begin(), values.end());
    const auto skipped = static_cast<std::size_t>(tail * static_cast<double>(values.size()));
    if (values.empty() || !(values[skipped] < values[values.size() - 1 - skipped])) {
      return core::fail(core::ErrorCode::InvalidArgument, "training: " + std::string(name_of(feature)) + " is the same in all reaches",
                        "use reaches of several people to several targets");
    }
    ranges.push_back({feature, values[skipped], values[values.size() - 1 - skipped]});
  }
  return ranges;
}

bool is_of_trunk(const TrainingReach& reach) { return reach.wanted >= TrunkClass::Minor; }

/// Returns the weight of a recorded reach. Where labels are certain, recorded people weigh as much as all simulated ones together: they are
/// few, but used this chair. For angles they do not, because geometry is wrong by about 5 degrees for a person, and the angle of a
/// simulated person is known.
double recorded_weight(const TrainingSet& set) {
  const auto is_simulated = [&](const TrainingReach& reach) { return set.subjects[reach.subject].is_simulated; };
  const auto simulated = static_cast<double>(std::count_if(set.reaches.begin(), set.reaches.end(), is_simulated));
  const double recorded = static_cast<double>(set.reaches.size()) - simulated;
  return recorded > 0.0 ? std::max(1.0, simulated / recorded) : 1.0;
}

std::vector<Row> general_rows(const TrainingSet& set) {
  std::vector<Row> rows;
  const double weight = recorded_weight(set);
  for (const TrainingReach& reach : set.reaches) {
    if (is_usable(reach)) rows.push_back({&reach, nullptr, set.subjects[reach.subject].is_simulated ? 1.0 : weight});
  }
  return rows;
}

/// Scales each reach by another triple of its subject's maximum reaches, so that the model tolerates their differences.
std::vector<Row> own_rows(const TrainingSet& set, const std::vector<std::vector<SubjectCalibration>>& calibrations) {
  std::vector<Row> rows;
  const double weight = recorded_weight(set);
  std::vector<std::size_t> taken(set.subjects.size());
  for (const TrainingReach& reach : set.reaches) {
    const auto& own = calibrations[reach.subject];
    if (is_usable(reach) && !own.empty()) {
      rows.push_back({&reach, &own[taken[reach.subject]++ % own.size()], set.subjects[reach.subject].is_simulated ? 1.0 : weight});
    }
  }
  return rows;
}

std::vector<Row> of_trunk(const std::vector<Row>& rows) {
  std::vector<Row> result;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(result), [](const Row& row) { return is_of_trunk(*row.reach); });
  return result;
}

struct FittedEnsemble {
  classifier::Ensemble ensemble;
  double validation_accuracy = 0.0;
};

core::Result<FittedEnsemble> fit_ensemble(std::vector<FeatureRange> inputs, const std::vector<Row>& rows, const NetworkOptions& network,
                                          bool is_clipped, std::size_t count, std::uint64_t seed) {
  Batch batch{.input_count = inputs.size(), .inputs = {}, .classes = {}};
  for (const auto& [reach, subject, weight] : rows) {
    const auto scaled = scale(inputs, reach->features, subject, is_clipped);
    if (!scaled.is_known) continue;
    batch.inputs.insert(batch.inputs.end(), scaled.values.begin(), scaled.values.begin() + static_cast<std::ptrdiff_t>(inputs.size()));
    batch.classes.push_back(static_cast<std::size_t>(reach->wanted) - 1);
  }
  DTS_TRY_ASSIGN(auto trained, train_networks(batch, network, seed, count, classifier::TrunkModelForm::kLowestValidationAccuracy));
  FittedEnsemble result{.ensemble = {.inputs = std::move(inputs), .networks = {}}};
  for (TrainedNetwork& one : trained) {
    result.validation_accuracy += one.validation_accuracy;
    result.ensemble.networks.push_back(std::move(one.network));
  }
  result.validation_accuracy /= static_cast<double>(trained.size());
  return result;
}

template <typename Target>
Samples samples_of(const std::vector<FeatureRange>& inputs, const std::vector<Row>& rows, bool is_weighted, Target target) {
  Samples samples{.input_count = inputs.size(), .inputs = {}, .targets = {}};
  for (const auto& row : rows) {
    const auto scaled = scale(inputs, row.reach->features, row.subject, true);
    if (scaled.is_known) samples.add(std::span(scaled.values).first(inputs.size()), target(row), is_weighted ? row.weight : 1.0);
  }
  return samples;
}

template <typename Target>
core::Result<classifier::AngleModel> fit_angle(core::Result<std::vector<FeatureRange>> inputs, const std::vector<Row>& rows,
                                               Target target) {
  if (!inputs) return tl::make_unexpected(inputs.error());
  classifier::AngleModel model;
  model.sine.coefficients = fit_quadratic(samples_of(*inputs, rows, false, target), kQuadraticRidge);
  model.sine.inputs = std::move(*inputs);
  model.residual_deg.fill(kWideResidualDeg);
  return model;
}

core::Status fit_own_scale(classifier::TrunkModelForm& form, const TrainingSet& set, const NetworkOptions& network,
                           const ModelOptions& options) {
  std::vector<std::vector<SubjectCalibration>> calibrations;
  for (std::size_t subject = 0; subject < set.subjects.size(); ++subject) calibrations.push_back(calibrations_of(set, subject));
  const auto rows = own_rows(set, calibrations);
  if (rows.empty()) return {};  // no maximum reaches: the model has no own scale
  DTS_TRY_ASSIGN(auto inputs, ranges_of(kOwnFeatures, of_trunk(rows), kTail));
  DTS_TRY_ASSIGN(auto fitted,
                 fit_ensemble(std::move(inputs), of_trunk(rows), network, true, options.networks, derived_seed(options.seed, 1)));
  form.own = std::move(fitted.ensemble);
  std::vector<double> largest_deg(set.subjects.size());  // average of the maximum reaches
  std::vector<double> count(set.subjects.size());
  for (const TrainingReach& reach : set.reaches) {
    if (reach.wanted != TrunkClass::Maximum) continue;
    largest_deg[reach.subject] += reach.flexion_deg;
    ++count[reach.subject];
  }
  auto angle = fit_angle(ranges_of(kOwnFeatures, rows, kTail), rows, [&](const Row& row) {
    const std::size_t subject = row.reach->subject;
    return sine_of(row.reach->flexion_deg) / sine_of(largest_deg[subject] / count[subject]);
  });
  if (!angle) return tl::make_unexpected(angle.error());
  form.own_angle = std::move(*angle);
  return {};
}

/// Fits class 0 against class 1; without a reach of either class there is no rule.
core::Status fit_arm_alone(classifier::TrunkModelForm& form, const std::vector<Row>& rows) {
  std::vector<Row> near;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(near), [](const Row& row) { return row.reach->wanted <= TrunkClass::Minor; });
  const auto is_alone = [](const Row& row) { return row.reach->wanted == TrunkClass::None; };
  const auto alone = std::count_if(near.begin(), near.end(), is_alone);
  if (alone == 0 || alone == static_cast<std::ptrdiff_t>(near.size())) return {};
  DTS_TRY_ASSIGN(auto inputs, ranges_of(kArmAloneFeatures, near, kTail));
  const auto samples = samples_of(inputs, near, true, [&](const Row& row) { return is_alone(row) ? 1.0 : 0.0; });
  form.arm_alone = classifier::ArmAloneRule{.logit = {.inputs = std::move(inputs), .coefficients = fit_logistic(samples, kLogisticRidge)}};
  return {};
}

core::Status fit_raw5(classifier::TrunkModelForm& form, const std::vector<Row>& rows, const ModelOptions& options) {
  DTS_TRY_ASSIGN(auto inputs, ranges_of(kRawFeatures, of_trunk(rows), 0.0));
  DTS_TRY_ASSIGN(auto fitted, fit_ensemble(std::move(inputs), of_trunk(rows), {}, false, 1, options.seed));
  form.general = std::move(fitted.ensemble);
  form.figures.validation_accuracy = fitted.validation_accuracy;
  return {};
}

core::Status fit_recommended(classifier::TrunkModelForm& form, const TrainingSet& set, const std::vector<Row>& rows,
                             const ModelOptions& options) {
  const NetworkOptions network{.output = classifier::OutputKind::Softmax, .decay = kDecay};
  DTS_TRY_ASSIGN(auto inputs, ranges_of(kGeneralFeatures, of_trunk(rows), kTail));
  DTS_TRY_ASSIGN(auto fitted, fit_ensemble(std::move(inputs), of_trunk(rows), network, true, options.networks, options.seed));
  form.general = std::move(fitted.ensemble);
  form.figures.validation_accuracy = fitted.validation_accuracy;
  DTS_TRY_ASSIGN(form.angle,
                 fit_angle(ranges_of(kAngleFeatures, rows, kTail), rows, [](const Row& row) { return sine_of(row.reach->flexion_deg); }));
  DTS_TRY(fit_own_scale(form, set, network, options));
  return fit_arm_alone(form, rows);
}

}  // namespace

core::Result<classifier::TrunkModelForm> fit_model(const TrainingSet& set, const ModelOptions& options) {
  classifier::TrunkModelForm form{.kind = options.kind, .general = {}, .facts = {}, .figures = {}};
  const auto rows = general_rows(set);
  DTS_TRY_ASSIGN(const auto levels, ranges_of(std::array{ReachFeature::P1}, rows, 0.0));
  form.p1_minimum_mm = levels.front().minimum;
  form.p1_maximum_mm = levels.front().maximum;
  DTS_TRY(options.kind == classifier::ModelKind::Raw5 ? fit_raw5(form, rows, options) : fit_recommended(form, set, rows, options));
  return form;
}

}  // namespace dts::lab::training
