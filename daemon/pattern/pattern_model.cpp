// SPDX-License-Identifier: Apache-2.0
#include "pattern/pattern_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

namespace dts::pattern {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFormat = 2;
constexpr const char* kKind = "steadiness_discriminant";
constexpr std::size_t kMostClasses = 100;
constexpr std::size_t kLongestText = 4096;
constexpr double kMostWeight = 1e12;
constexpr double kMostCount = 1e9;
constexpr std::array kVerdicts{"not told", "told", "told by other facts"};

/// Reads a model from JSON; keeps only the first error.
class ModelReader {
 public:
  explicit ModelReader(const Json& json) : json_(json) {}

  PatternModel read() {
    PatternModel model;
    if (!json_.is_object()) fail("it is not a JSON object");
    if (text(json_, "kind") != kKind) fail("'kind' is not \"" + std::string(kKind) + "\"");
    if (number(json_, "format", 0.0, 1e6) != kFormat) fail("'format' is not " + std::to_string(kFormat));
    model.label = text(json_, "label");
    model.condition = text(json_, "condition");
    model.about = text(json_, "about");
    model.profile = text(json_, "profile");
    model.rate_hz = number(json_, "rate_hz", 0.0, 1e9);
    model.duration_s = number(json_, "duration_s", 0.0, 1e6);
    model.noise_mm = number(json_, "noise_mm", 0.0, 1e3);
    model.rows = count(json_, "rows");
    model.people = count(json_, "people");
    model.discriminant.shrinkage = number(json_, "shrinkage", 0.0, 1.0);
    if (problem.empty()) read_verdict(model);
    if (problem.empty()) read_classes(model.discriminant);
    if (problem.empty()) read_groups(model);
    if (problem.empty()) read_predictors(model.discriminant);
    if (problem.empty()) read_weights(model.discriminant);
    if (problem.empty()) read_figures(model.figures);
    return model;
  }

  std::string problem;

 private:
  void fail(const std::string& what) {
    if (problem.empty()) problem = what;
  }

  const Json* find(const Json& object, const char* key) {
    const auto found = object.is_object() ? object.find(key) : object.end();
    if (object.is_object() && found != object.end()) return &*found;
    fail("'" + std::string(key) + "' is missing");
    return nullptr;
  }

  std::string text(const Json& object, const char* key) {
    const Json* value = find(object, key);
    if (value == nullptr) return {};
    if (value->is_string() && value->get_ref<const std::string&>().size() <= kLongestText) return value->get<std::string>();
    fail("'" + std::string(key) + "' is not a text");
    return {};
  }

  bool boolean(const Json& object, const char* key) {
    const Json* value = find(object, key);
    if (value != nullptr && !value->is_boolean()) fail("'" + std::string(key) + "' is neither true nor false");
    return value != nullptr && value->is_boolean() && value->get<bool>();
  }

  double number(const Json& object, const char* key, double least, double most) {
    const Json* value = find(object, key);
    return value == nullptr ? 0.0 : checked(*value, key, least, most);
  }

  double checked(const Json& value, const std::string& name, double least, double most) {
    const double read = value.is_number() ? value.get<double>() : NAN;
    if (read >= least && read <= most) return read;
    fail("'" + name + "' is not a number, or out of range");
    return 0.0;
  }

  std::size_t count(const Json& object, const char* key) {
    const double read = number(object, key, 0.0, kMostCount);
    if (read != std::floor(read)) fail("'" + std::string(key) + "' is not a whole number");
    return static_cast<std::size_t>(read);
  }

  Interval interval(const Json& object, const char* key, double least, double most) {
    const Json* value = find(object, key);
    if (value == nullptr) return {};
    if (!value->is_array() || value->size() != 3) {
      fail("'" + std::string(key) + "' is not a list of value, low and high");
      return {};
    }
    return {.value = checked(value->at(0), key, least, most),
            .low = checked(value->at(1), key, least, most),
            .high = checked(value->at(2), key, least, most)};
  }

  const Json* array(const char* key, std::size_t least, std::size_t most) {
    const Json* value = find(json_, key);
    if (value != nullptr && value->is_array() && value->size() >= least && value->size() <= most) return value;
    fail("'" + std::string(key) + "' is not a list of " + std::to_string(least) + " to " + std::to_string(most));
    return nullptr;
  }

  void read_verdict(PatternModel& model) {
    const std::string verdict = text(json_, "verdict");
    const auto found = std::ranges::find(kVerdicts, verdict);
    if (found == kVerdicts.end()) return fail("'verdict' is not known");
    model.verdict = static_cast<Verdict>(found - kVerdicts.begin());
    model.told_by = text(json_, "told_by");
  }

  void read_groups(PatternModel& model) {
    const std::size_t expected = model.discriminant.classes.size();
    const Json* groups = array("groups", expected, expected);
    if (groups == nullptr) return;
    for (const Json& group : *groups) {
      model.groups.push_back({.people = count(group, "people"), .trials = count(group, "trials"), .moved = count(group, "moved")});
    }
  }

  void read_figures(Figures& figures) {
    const Json* found = find(json_, "figures");
    if (found == nullptr) return;
    const Json& json = *found;
    figures.scheme = text(json, "scheme");
    figures.auc = interval(json, "auc_people", 0.0, 1.0);
    figures.auc_trials = number(json, "auc_trials", 0.0, 1.0);
    figures.equal_error_correct = number(json, "equal_error_correct", 0.0, 1.0);
    figures.brier = number(json, "brier", 0.0, 1.0);
    figures.brier_base = number(json, "brier_base", 0.0, 1.0);
    if (json.is_object() && json.contains("slope")) figures.slope = number(json, "slope", -1e6, 1e6);
    figures.accuracy = number(json, "accuracy", 0.0, 1.0);
    figures.balanced_accuracy = number(json, "balanced_accuracy", 0.0, 1.0);
    figures.commonest_share = number(json, "commonest_share", 0.0, 1.0);
    figures.permutation_p = number(json, "permutation_p", 0.0, 1.0);
    figures.best_measure = text(json, "best_measure");
    if (problem.empty() && !posturography::measure_named(figures.best_measure)) fail("'best_measure' is not known");
    figures.best_auc = interval(json, "best_measure_auc_people", 0.0, 1.0);
    figures.gain = interval(json, "gain", -1.0, 1.0);
    if (!json.is_object() || !json.contains("rival")) return;
    figures.rival = text(json, "rival");
    figures.rival_auc = interval(json, "rival_auc_people", 0.0, 1.0);
    figures.rival_gain = interval(json, "rival_gain", -1.0, 1.0);
  }

  void read_classes(Discriminant& form) {
    const Json* classes = array("classes", 2, kMostClasses);
    if (classes == nullptr) return;
    for (const Json& one : *classes) {
      const bool is_text =
          one.is_string() && !one.get_ref<const std::string&>().empty() && one.get_ref<const std::string&>().size() <= kLongestText;
      if (!is_text) return fail("'classes' has an item that is not a text");
      if (!form.classes.empty() && one.get_ref<const std::string&>() <= form.classes.back())
        return fail("'classes' is not in alphabetical order");
      form.classes.push_back(one.get<std::string>());
    }
  }

  void read_predictors(Discriminant& form) {
    const Json* measures = array("measures", 1, posturography::kMeasureCount);
    if (measures == nullptr) return;
    for (const Json& one : *measures) {
      const std::string symbol = text(one, "symbol");
      const auto measure = posturography::measure_named(symbol);
      if (!measure) return fail("unknown measure '" + symbol + "'");
      if (std::ranges::find(form.predictors, *measure, &Predictor::measure) != form.predictors.end()) return fail(symbol + " occurs twice");
      Predictor predictor{.measure = *measure, .is_logarithmic = boolean(one, "is_logarithmic")};
      predictor.mean = number(one, "mean", -1e12, 1e12);
      predictor.sd = number(one, "sd", 1e-15, 1e12);
      predictor.least = number(one, "least", predictor.is_logarithmic ? 1e-300 : -1e12, 1e12);
      predictor.most = number(one, "most", predictor.least, 1e12);
      form.predictors.push_back(predictor);
    }
  }

  void read_weights(Discriminant& form) {
    const Json* weights = array("weights", form.classes.size(), form.classes.size());
    const Json* offsets = array("offsets", form.classes.size(), form.classes.size());
    if (weights == nullptr || offsets == nullptr) return;
    for (const Json& row : *weights) {
      if (!row.is_array() || row.size() != form.predictors.size()) return fail("'weights' and 'measures' have different lengths");
      form.weights.emplace_back();
      for (const Json& weight : row) form.weights.back().push_back(checked(weight, "weights", -kMostWeight, kMostWeight));
    }
    for (const Json& offset : *offsets) form.offsets.push_back(checked(offset, "offsets", -kMostWeight, kMostWeight));
  }

  const Json& json_;
};

Json to_json(const Predictor& predictor) {
  const auto& about = posturography::info(predictor.measure);
  return {{"symbol", about.symbol}, {"unit", about.unit}, {"is_logarithmic", predictor.is_logarithmic},
          {"mean", predictor.mean}, {"sd", predictor.sd}, {"least", predictor.least},
          {"most", predictor.most}};
}

Json to_json(const Interval& interval) { return Json::array({interval.value, interval.low, interval.high}); }

Json to_json(const Figures& figures) {
  Json json{{"scheme", figures.scheme},         {"auc_people", to_json(figures.auc)},
            {"auc_trials", figures.auc_trials}, {"equal_error_correct", figures.equal_error_correct},
            {"brier", figures.brier},           {"brier_base", figures.brier_base}};
  if (figures.slope) json["slope"] = *figures.slope;
  json["accuracy"] = figures.accuracy;
  json["balanced_accuracy"] = figures.balanced_accuracy;
  json["commonest_share"] = figures.commonest_share;
  json["permutation_p"] = figures.permutation_p;
  json["best_measure"] = figures.best_measure;
  json["best_measure_auc_people"] = to_json(figures.best_auc);
  json["gain"] = to_json(figures.gain);
  if (figures.rival.empty()) return json;
  json["rival"] = figures.rival;
  json["rival_auc_people"] = to_json(figures.rival_auc);
  json["rival_gain"] = to_json(figures.rival_gain);
  return json;
}

}  // namespace

std::string verdict_text(const PatternModel& model) {
  if (model.verdict == Verdict::ToldByOther) return "told by " + model.told_by + ", not by sway";
  return kVerdicts.at(static_cast<std::size_t>(model.verdict));
}

std::string model_text(const PatternModel& model) {
  Json json{{"kind", kKind},
            {"format", kFormat},
            {"label", model.label},
            {"condition", model.condition},
            {"about", model.about},
            {"verdict", kVerdicts.at(static_cast<std::size_t>(model.verdict))},
            {"told_by", model.told_by},
            {"profile", model.profile},
            {"rate_hz", model.rate_hz},
            {"duration_s", model.duration_s},
            {"noise_mm", model.noise_mm},
            {"rows", model.rows},
            {"people", model.people},
            {"figures", to_json(model.figures)},
            {"classes", model.discriminant.classes},
            {"groups", Json::array()},
            {"shrinkage", model.discriminant.shrinkage},
            {"measures", Json::array()},
            {"weights", model.discriminant.weights},
            {"offsets", model.discriminant.offsets}};
  for (const Group& group : model.groups)
    json["groups"].push_back({{"people", group.people}, {"trials", group.trials}, {"moved", group.moved}});
  for (const Predictor& predictor : model.discriminant.predictors) json["measures"].push_back(to_json(predictor));
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

core::Result<PatternModel> read_model_text(std::string_view text, const std::string& name) {
  PatternModel model;
  std::string problem = "it is larger than " + std::to_string(kLongestModelText >> 10U) + " KiB";
  if (text.size() <= kLongestModelText) {
    const Json json = Json::parse(text, nullptr, false);
    ModelReader reader(json);
    if (json.is_discarded()) {
      problem = "it is not JSON, or has invalid numbers";
    } else {
      model = reader.read();
      problem = reader.problem;
    }
  }
  if (problem.empty()) return model;
  return core::fail(core::ErrorCode::InvalidArgument, name + " is not a model of dtslab steadiness train: " + problem,
                    "train a new model: dtslab steadiness train");
}

}  // namespace dts::pattern
