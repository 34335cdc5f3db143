// SPDX-License-Identifier: Apache-2.0
#include "lab/training/network_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "cli/json.h"
#include "lab/base/small_file.h"

namespace dts::lab::training {
namespace {

using classifier::FeatureRange;
using classifier::Network;
using classifier::ReachFeature;

core::Error wrong(const std::string& file, const std::string& what) {
  return {core::ErrorCode::InvalidArgument, file + ": " + what, "use a network of layers n-h-3 with W1, b1, W2, b2"};
}

/// Returns the numbers of a list; nothing if it is not a list of `count` finite numbers.
std::optional<std::vector<double>> numbers_of(const cli::Json& json, std::string_view key, std::size_t count) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_array() || found->size() != count) return std::nullopt;
  std::vector<double> values;
  for (const cli::Json& value : *found) {
    if (!value.is_number() || !std::isfinite(value.get<double>())) return std::nullopt;
    values.push_back(value.get<double>());
  }
  return values;
}

std::optional<Layer> layer_of(const cli::Json& json, const std::string& number, std::size_t inputs, std::size_t outputs) {
  Layer layer{.outputs = outputs, .inputs = inputs, .weights = {}, .biases = {}};
  const auto rows = json.find("W" + number);
  if (rows == json.end() || !rows->is_array() || rows->size() != outputs) return std::nullopt;
  for (const cli::Json& row : *rows) {
    const auto values = numbers_of(cli::Json{{"row", row}}, "row", inputs);
    if (!values) return std::nullopt;
    layer.weights.insert(layer.weights.end(), values->begin(), values->end());
  }
  auto biases = numbers_of(json, "b" + number, outputs);
  if (!biases) return std::nullopt;
  layer.biases = std::move(*biases);
  return layer;
}

/// Accepts our names and the short names of the thesis.
std::optional<ReachFeature> feature_of(const std::string& name) {
  constexpr std::array<std::pair<std::string_view, ReachFeature>, 5> kThesis = {
      {{"d1", ReachFeature::D1}, {"d2", ReachFeature::D2}, {"P1", ReachFeature::P1}, {"P2", ReachFeature::P2}, {"P3", ReachFeature::P3}}};
  for (const auto& [known, feature] : kThesis) {
    if (known == name) return feature;
  }
  return classifier::parse_reach_feature(name);
}

core::Result<std::vector<FeatureRange>> inputs_of(const cli::Json& json, const std::string& file, std::size_t count) {
  std::vector<FeatureRange> inputs;
  if (!json.contains("lo") && !json.contains("hi")) return inputs;
  const auto lowest = numbers_of(json, "lo", count);
  const auto highest = numbers_of(json, "hi", count);
  const auto names = json.find("input");
  if (!lowest || !highest || names == json.end() || !names->is_array() || names->size() != count) {
    return tl::make_unexpected(wrong(file, "input, lo and hi must be lists of " + std::to_string(count)));
  }
  for (std::size_t k = 0; k < count; ++k) {
    const auto feature = (*names)[k].is_string() ? feature_of((*names)[k].get<std::string>()) : std::nullopt;
    if (!feature) return tl::make_unexpected(wrong(file, "input " + std::to_string(k + 1) + " is not a known feature"));
    inputs.push_back({*feature, (*lowest)[k], (*highest)[k]});
  }
  return inputs;
}

std::string text_of(const cli::Json& json, std::string_view key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}

}  // namespace

core::Result<Network> network_of(const Layer& hidden, const Layer& output, classifier::OutputKind kind) {
  if (hidden.outputs != output.inputs || output.outputs != classifier::kClasses) {
    return core::fail(core::ErrorCode::InvalidArgument, "network: its layers do not match, or it does not have three outputs",
                      "use a network of layers n-h-3");
  }
  std::vector<double> weights;
  for (const auto* values : {&hidden.weights, &hidden.biases, &output.weights, &output.biases}) {
    weights.insert(weights.end(), values->begin(), values->end());
  }
  return Network::create(hidden.inputs, hidden.outputs, kind, std::move(weights));
}

core::Result<ForeignNetworks> read_network_json(const std::string& file) {
  DTS_TRY_ASSIGN(const auto text, read_small_file(file));
  const cli::Json json = cli::Json::parse(text, nullptr, false);
  if (!json.is_object()) return tl::make_unexpected(wrong(file, "is not a JSON object"));
  const auto layers = numbers_of(json, "layers", 3);
  const auto is_count = [](double value) { return value >= 1.0 && value <= 100.0 && std::floor(value) == value; };
  if (!layers || !std::all_of(layers->begin(), layers->end(), is_count))
    return tl::make_unexpected(wrong(file, "layers must be three counts"));
  const std::string output = text_of(json, "output");
  if (text_of(json, "hidden") != "tanh") return tl::make_unexpected(wrong(file, "hidden must be \"tanh\""));
  if (output != "logistic" && output != "softmax") return tl::make_unexpected(wrong(file, "output must be \"logistic\" or \"softmax\""));
  const auto inputs = static_cast<std::size_t>((*layers)[0]);
  const auto hidden = static_cast<std::size_t>((*layers)[1]);
  const auto first = layer_of(json, "1", inputs, hidden);
  const auto second = layer_of(json, "2", hidden, static_cast<std::size_t>((*layers)[2]));
  if (!first) return tl::make_unexpected(wrong(file, "W1 or b1 does not match layers, or is not finite"));
  if (!second) return tl::make_unexpected(wrong(file, "W2 or b2 does not match layers, or is not finite"));
  auto network = network_of(*first, *second, output == "softmax" ? classifier::OutputKind::Softmax : classifier::OutputKind::Logistic);
  if (!network) return tl::make_unexpected(wrong(file, network.error().what));
  DTS_TRY_ASSIGN(auto ranges, inputs_of(json, file, inputs));
  ForeignNetworks result{.networks = {}, .inputs = std::move(ranges)};
  result.networks.push_back(std::move(*network));
  return result;
}

}  // namespace dts::lab::training
