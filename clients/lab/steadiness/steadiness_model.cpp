// SPDX-License-Identifier: Apache-2.0
#include "lab/steadiness/steadiness_model.h"

#include <algorithm>
#include <cmath>

#include "cli/json.h"
#include "lab/base/small_file.h"

namespace dts::lab::steadiness {
namespace {

using cli::Json;

constexpr int kFormat = 1;
constexpr const char* kKind = "steadiness_discriminant";
constexpr std::size_t kMostClasses = 100;
constexpr std::size_t kLongestText = 4096;
constexpr double kMostWeight = 1e12;

/// Reads a model from JSON; keeps only the first error.
class ModelReader {
 public:
  explicit ModelReader(const Json& json) : json_(json) {}

  SteadinessModel read() {
    SteadinessModel model;
    if (!json_.is_object()) fail("it is not a JSON object");
    if (text(json_, "kind") != kKind) fail("'kind' is not \"" + std::string(kKind) + "\"");
    if (number(json_, "format", 0.0, 1e6) != kFormat) fail("'format' is not " + std::to_string(kFormat));
    model.label = text(json_, "label");
    model.profile = text(json_, "profile");
    if (json_.is_object() && json_.contains("rate_hz")) model.rate_hz = number(json_, "rate_hz", 0.0, 1e9);  // older models have none
    model.rows = static_cast<std::size_t>(number(json_, "rows", 0.0, 1e9));
    model.subjects = static_cast<std::size_t>(number(json_, "subjects", 0.0, 1e9));
    model.left_out_accuracy = number(json_, "left_out_accuracy", 0.0, 1.0);
    model.left_out_balanced_accuracy = number(json_, "left_out_balanced_accuracy", 0.0, 1.0);
    model.is_better_than_chance = boolean(json_, "is_better_than_chance");
    model.discriminant.shrinkage = number(json_, "shrinkage", 0.0, 1.0);
    if (problem.empty()) read_classes(model.discriminant);
    if (problem.empty()) read_predictors(model.discriminant);
    if (problem.empty()) read_weights(model.discriminant);
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

  const Json* array(const char* key, std::size_t least, std::size_t most) {
    const Json* value = find(json_, key);
    if (value != nullptr && value->is_array() && value->size() >= least && value->size() <= most) return value;
    fail("'" + std::string(key) + "' is not a list of " + std::to_string(least) + " to " + std::to_string(most));
    return nullptr;
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

}  // namespace

std::string model_text(const SteadinessModel& model) {
  Json json{{"kind", kKind},
            {"format", kFormat},
            {"label", model.label},
            {"profile", model.profile},
            {"rate_hz", model.rate_hz},
            {"rows", model.rows},
            {"subjects", model.subjects},
            {"left_out_accuracy", model.left_out_accuracy},
            {"left_out_balanced_accuracy", model.left_out_balanced_accuracy},
            {"is_better_than_chance", model.is_better_than_chance},
            {"shrinkage", model.discriminant.shrinkage},
            {"classes", model.discriminant.classes},
            {"measures", Json::array()},
            {"weights", model.discriminant.weights},
            {"offsets", model.discriminant.offsets}};
  for (const Predictor& predictor : model.discriminant.predictors) json["measures"].push_back(to_json(predictor));
  return cli::document(json);
}

core::Result<SteadinessModel> read_model_text(std::string_view text, const std::string& name) {
  const Json json = Json::parse(text, nullptr, false);
  ModelReader reader(json);
  SteadinessModel model;
  if (json.is_discarded()) {
    reader.problem = "it is not JSON, or has invalid numbers";
  } else {
    model = reader.read();
  }
  if (reader.problem.empty()) return model;
  return core::fail(core::ErrorCode::InvalidArgument, name + " is not a model of dtslab steadiness train: " + reader.problem,
                    "train a new model: dtslab steadiness train");
}

core::Result<SteadinessModel> read_model(const std::string& file) {
  DTS_TRY_ASSIGN(const auto text, read_small_file(file));
  return read_model_text(text, file);
}

}  // namespace dts::lab::steadiness
