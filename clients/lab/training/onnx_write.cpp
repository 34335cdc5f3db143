// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "core/join.h"
#include "lab/training/onnx_file.h"
#include "lab/training/onnx_schema.h"

namespace dts::lab::training {
namespace {

using classifier::kClasses;
using classifier::Network;

class Graph {
 public:
  Graph() {
    model_.set_ir_version(8);
    model_.set_producer_name("dtslab");
    model_.set_producer_version(DTS_VERSION);
    auto* const operators = model_.add_opset_import();
    operators->set_domain("");
    operators->set_version(13);
    graph().set_name("trunk_movement");
  }

  /// Adds a constant and returns its name; a scalar has no dimensions.
  std::string constant(const std::string& name, const std::vector<std::int64_t>& dimensions, std::span<const double> values) {
    auto* const tensor = graph().add_initializer();
    tensor->set_name(name);
    tensor->set_data_type(onnx::TensorProto::DOUBLE);
    for (const std::int64_t dimension : dimensions) tensor->add_dims(dimension);
    for (const double value : values) tensor->add_double_data(value);
    return name;
  }

  std::string number(const std::string& name, double value) { return constant(name, {}, std::span(&value, 1)); }

  onnx::NodeProto& node(const std::string& kind, const std::vector<std::string>& inputs, const std::string& output) {
    auto* const added = graph().add_node();
    added->set_op_type(kind);
    added->set_name(output);
    for (const std::string& input : inputs) added->add_input(input);
    added->add_output(output);
    return *added;
  }

  /// Divides each row by its sum.
  void normalise(const std::string& input, const std::string& output) {
    const std::int64_t one = 1;
    auto* const axes = graph().add_initializer();
    axes->set_name(output + "_axes");
    axes->set_data_type(onnx::TensorProto::INT64);
    axes->add_dims(1);
    axes->add_int64_data(one);
    set_integer(node("ReduceSum", {input, output + "_axes"}, output + "_sum"), "keepdims", 1);
    node("Div", {input, output + "_sum"}, output);
  }

  static void set_integer(onnx::NodeProto& node, const std::string& name, std::int64_t value) {
    auto* const attribute = node.add_attribute();
    attribute->set_name(name);
    attribute->set_type(onnx::AttributeProto::INT);
    attribute->set_i(value);
  }

  void ends(const std::string& input, std::size_t inputs, const std::string& output) {
    describe(*graph().add_input(), input, inputs);
    describe(*graph().add_output(), output, kClasses);
  }

  void note(const std::string& key, const std::string& value) {
    auto* const entry = model_.add_metadata_props();
    entry->set_key(key);
    entry->set_value(value);
  }

  [[nodiscard]] std::string text() const { return model_.SerializeAsString(); }

 private:
  onnx::GraphProto& graph() { return *model_.mutable_graph(); }

  static void describe(onnx::ValueInfoProto& value, const std::string& name, std::size_t columns) {
    value.set_name(name);
    auto* const tensor = value.mutable_type()->mutable_tensor_type();
    tensor->set_elem_type(onnx::TensorProto::DOUBLE);
    tensor->mutable_shape()->add_dim()->set_dim_param("n");
    tensor->mutable_shape()->add_dim()->set_dim_value(static_cast<std::int64_t>(columns));
  }

  onnx::ModelProto model_;
};

/// Adds the nodes that compute "scaled" from "features".
void add_scaling(Graph& graph, const classifier::TrunkModelForm& form) {
  std::vector<double> factors;
  std::vector<double> offsets;
  for (const auto& input : form.general.inputs) {
    factors.push_back(2.0 / (input.maximum - input.minimum));
    offsets.push_back(-1.0 - factors.back() * input.minimum);
  }
  graph.note("features", core::join(form.general.inputs, ",", [](const auto& input) { return name_of(input.feature); }));
  const auto count = static_cast<std::int64_t>(factors.size());
  graph.node("Mul", {"features", graph.constant("factor", {count}, factors)}, "multiplied");
  const bool is_clipped = form.kind == classifier::ModelKind::Recommended;
  graph.node("Add", {"multiplied", graph.constant("offset", {count}, offsets)}, is_clipped ? "added" : "scaled");
  if (is_clipped) graph.node("Clip", {"added", graph.number("lowest", -1.0), graph.number("highest", 1.0)}, "scaled");
}

void add_network(Graph& graph, const Network& network, const std::string& name) {
  const auto inputs = static_cast<std::int64_t>(network.input_count());
  const auto hidden = static_cast<std::int64_t>(network.hidden_count());
  const std::span weights(network.weights());
  const std::size_t first = network.input_count() * network.hidden_count();
  const std::size_t second = first + network.hidden_count();
  const std::size_t last = second + kClasses * network.hidden_count();
  const auto layer = [&](const std::string& input, const std::string& w, const std::string& b, const std::string& output) {
    Graph::set_integer(graph.node("Gemm", {input, w, b}, output), "transB", 1);
  };
  layer("scaled", graph.constant(name + "_W1", {hidden, inputs}, weights.first(first)),
        graph.constant(name + "_b1", {hidden}, weights.subspan(first, network.hidden_count())), name + "_sums");
  graph.node("Tanh", {name + "_sums"}, name + "_hidden");
  layer(name + "_hidden",
        graph.constant(name + "_W2", {static_cast<std::int64_t>(kClasses), hidden}, weights.subspan(second, last - second)),
        graph.constant(name + "_b2", {static_cast<std::int64_t>(kClasses)}, weights.subspan(last)), name + "_out_sums");
  if (network.output() == classifier::OutputKind::Softmax) {
    Graph::set_integer(graph.node("Softmax", {name + "_out_sums"}, name + "_outputs"), "axis", 1);
  } else {
    graph.node("Sigmoid", {name + "_out_sums"}, name + "_outputs");
  }
  graph.normalise(name + "_outputs", name);
}

}  // namespace

std::string onnx_text(const classifier::TrunkModel& model) {
  const classifier::TrunkModelForm& form = model.form();
  Graph graph;
  add_scaling(graph, form);
  std::vector<std::string> names;
  for (const Network& network : form.general.networks) {
    names.push_back("network" + std::to_string(names.size() + 1));
    add_network(graph, network, names.back());
  }
  graph.node("Mean", names, "mean");
  graph.node("Pow", {"mean", graph.number("exponent", 1.0 / form.general.temperature)}, "powers");
  graph.normalise("powers", "probability");
  graph.ends("features", form.general.inputs.size(), "probability");
  graph.note("data_sha256", form.facts.data_sha256);
  return graph.text();
}

}  // namespace dts::lab::training
