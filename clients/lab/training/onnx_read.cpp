// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <utility>

#include "lab/base/small_file.h"
#include "lab/training/onnx_file.h"
#include "lab/training/onnx_schema.h"

namespace dts::lab::training {
namespace {

using classifier::Network;
using classifier::OutputKind;

constexpr std::int64_t kMostNumbers = 4096;  // per tensor; the largest network has 32 x 12 weights
constexpr int kMostNodes = 2000;             // each node may contain a copy of a tensor; 64 networks have about 400

struct Tensor {
  std::vector<std::size_t> dimensions;
  std::vector<double> values;
};

template <typename Number>
void take_raw(const std::string& bytes, std::vector<double>& values) {
  for (std::size_t place = 0; place + sizeof(Number) <= bytes.size(); place += sizeof(Number)) {
    Number number{};
    std::memcpy(&number, bytes.data() + place, sizeof(Number));
    values.push_back(static_cast<double>(number));
  }
}

/// Returns a tensor of float or double; nothing for another type or wrong counts.
std::optional<Tensor> tensor_of(const onnx::TensorProto& proto) {
  Tensor tensor;
  std::int64_t count = 1;
  for (const std::int64_t dimension : proto.dims()) {
    if (dimension < 1 || dimension > kMostNumbers || (count *= dimension) > kMostNumbers) return std::nullopt;
    tensor.dimensions.push_back(static_cast<std::size_t>(dimension));
  }
  const bool is_double = proto.data_type() == onnx::TensorProto::DOUBLE;
  if (!is_double && proto.data_type() != onnx::TensorProto::FLOAT) return std::nullopt;
  if (proto.has_raw_data()) {
    is_double ? take_raw<double>(proto.raw_data(), tensor.values) : take_raw<float>(proto.raw_data(), tensor.values);
  } else if (is_double) {
    tensor.values.assign(proto.double_data().begin(), proto.double_data().end());
  } else {
    tensor.values.assign(proto.float_data().begin(), proto.float_data().end());
  }
  if (tensor.values.size() != static_cast<std::size_t>(count)) return std::nullopt;
  return tensor;
}

/// Finds the layers of a graph in order.
class Reader {
 public:
  explicit Reader(const onnx::GraphProto& graph) : graph_(graph) {
    for (const auto& initializer : graph.initializer()) {
      if (auto tensor = tensor_of(initializer)) constants_.emplace(initializer.name(), std::move(*tensor));
    }
    for (const auto& node : graph.node()) {
      if (node.op_type() != "Constant" || node.output_size() != 1 || node.attribute_size() != 1) continue;
      if (auto tensor = tensor_of(node.attribute(0).t())) constants_.emplace(node.output(0), std::move(*tensor));
    }
  }

  /// Fills `networks`; returns the reason of a failure, or nothing on success.
  std::optional<std::string> read(std::vector<Network>& networks) {
    std::map<std::string, Layer> hidden;  // by the name of the layer's output: first of the sums, then of their tanh
    std::map<std::string, std::pair<Layer, Layer>> whole;
    for (const auto& node : graph_.node()) {
      if (node.input_size() < 1 || node.output_size() < 1) continue;
      const std::string& from = node.input(0);
      const std::string& to = node.output(0);
      const std::string& kind = node.op_type();
      if (kind == "Gemm" || kind == "MatMul") {
        auto layer = layer_of(node);
        if (!layer) return kind + " " + to + " has no constant weights of a size that fits";
        const auto known = behind_tanh_.find(from);
        if (known == behind_tanh_.end()) {
          hidden.emplace(to, std::move(*layer));
        } else {
          whole.emplace(to, std::pair(known->second, std::move(*layer)));
        }
      } else if (kind == "Add") {
        add_biases(node, hidden, whole);
      } else if (kind == "Tanh" && hidden.count(from) > 0) {
        behind_tanh_.emplace(to, hidden.at(from));
      } else if ((kind == "Sigmoid" || kind == "Softmax") && whole.count(from) > 0) {
        auto network =
            network_of(whole.at(from).first, whole.at(from).second, kind == "Softmax" ? OutputKind::Softmax : OutputKind::Logistic);
        if (!network) return network.error().what;
        networks.push_back(std::move(*network));
      }
    }
    return networks.empty() ? std::optional<std::string>("holds no network of a tanh layer and a Sigmoid or Softmax layer") : std::nullopt;
  }

 private:
  static bool is_set(const onnx::NodeProto& node, const char* name) {
    for (const auto& attribute : node.attribute()) {
      if (attribute.name() == name) return attribute.i() != 0;
    }
    return false;
  }

  static bool is_scaled(const onnx::NodeProto& node) {
    for (const auto& attribute : node.attribute()) {
      if ((attribute.name() == "alpha" || attribute.name() == "beta") && attribute.f() != 1.0F) return true;
    }
    return false;
  }

  std::optional<Layer> layer_of(const onnx::NodeProto& node) const {
    if (node.input_size() < 2 || is_set(node, "transA") || is_scaled(node)) return std::nullopt;
    const auto found = constants_.find(node.input(1));
    if (found == constants_.end() || found->second.dimensions.size() != 2) return std::nullopt;
    const bool has_output_rows = is_set(node, "transB");
    const Tensor& weights = found->second;
    Layer layer{.outputs = weights.dimensions[has_output_rows ? 0 : 1],
                .inputs = weights.dimensions[has_output_rows ? 1 : 0],
                .weights = weights.values,
                .biases = {}};
    for (std::size_t out = 0; out < layer.outputs && !has_output_rows; ++out) {
      for (std::size_t in = 0; in < layer.inputs; ++in) layer.weights[out * layer.inputs + in] = weights.values[in * layer.outputs + out];
    }
    layer.biases.assign(layer.outputs, 0.0);
    if (node.input_size() < 3) return layer;
    const auto biases = constants_.find(node.input(2));
    if (biases == constants_.end() || biases->second.values.size() != layer.outputs) return std::nullopt;
    layer.biases = biases->second.values;
    return layer;
  }

  /// Adds the biases of a MatMul.
  void add_biases(const onnx::NodeProto& node, std::map<std::string, Layer>& hidden,
                  std::map<std::string, std::pair<Layer, Layer>>& whole) const {
    if (node.input_size() != 2) return;
    for (const auto& [sums, constant] : {std::pair(node.input(0), node.input(1)), std::pair(node.input(1), node.input(0))}) {
      const auto biases = constants_.find(constant);
      if (biases == constants_.end()) continue;
      if (const auto found = hidden.find(sums); found != hidden.end() && found->second.outputs == biases->second.values.size()) {
        hidden.emplace(node.output(0), found->second).first->second.biases = biases->second.values;
      }
      if (const auto found = whole.find(sums); found != whole.end() && found->second.second.outputs == biases->second.values.size()) {
        whole.emplace(node.output(0), found->second).first->second.second.biases = biases->second.values;
      }
    }
  }

  const onnx::GraphProto& graph_;
  std::map<std::string, Tensor> constants_;
  std::map<std::string, Layer> behind_tanh_;
};

}  // namespace

core::Result<ForeignNetworks> read_onnx(const std::string& file) {
  const auto refused = [&](const std::string& what) {
    return core::fail(core::ErrorCode::InvalidArgument, file + ": " + what,
                      "use a network of layers n-h-3, as dtslab reach export writes it");
  };
  DTS_TRY_ASSIGN(const auto text, read_small_file(file));
  onnx::ModelProto model;
  if (!model.ParseFromString(text) || !model.has_graph()) return refused("is not an ONNX model");
  ForeignNetworks result;
  if (model.graph().node_size() > kMostNodes) return refused("has " + std::to_string(model.graph().node_size()) + " nodes");
  if (const auto why = Reader(model.graph()).read(result.networks)) return refused(*why);
  return result;
}

}  // namespace dts::lab::training
