// SPDX-License-Identifier: Apache-2.0
#include "lab/training/onnx_file.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "files/trunk_model_file.h"
#include "unit/classifier/hand_made_model.h"
#include "unit/lab/run_fixture.h"

namespace dts::lab::training {
namespace {

class OnnxFile : public RunTest {
 protected:
  static classifier::TrunkModel model() {
    auto form = classifier::hand_made_form();
    form.general.networks.push_back(classifier::Network::create(1, 2, classifier::OutputKind::Logistic,
                                                                {0.3, -0.7, 0.1, 0.2, 1.0, -1.0, 0.5, 0.5, -2.0, 1.5, 0.1, 0.2, 0.3})
                                        .value());
    form.general.temperature = 1.7;
    return classifier::TrunkModel::create(form).value();
  }

  std::string write_bytes(const std::string& name, const std::string& bytes) const {
    std::ofstream(directory_ / name, std::ios::binary) << bytes;
    return path(name);
  }
};

TEST_F(OnnxFile, WrittenAndRead_SameNetworks) {
  const auto read = read_onnx(write_bytes("model.onnx", onnx_text(model())));

  ASSERT_TRUE(read) << core::to_string(read.error());
  EXPECT_EQ(read->networks, model().form().general.networks);
}

TEST_F(OnnxFile, NoModelAtAll_Refused) {
  EXPECT_FALSE(read_onnx(path("missing.onnx")));
  EXPECT_FALSE(read_onnx(write_bytes("text.onnx", "not a model")));
  EXPECT_FALSE(read_onnx(write_bytes("empty.onnx", "")));
}

// Every node may hold a copy of a tensor: a small file of many nodes would fill the memory.
TEST_F(OnnxFile, FarMoreNodesThanNetworksHave_Refused) {
  const std::string whole = onnx_text(model());
  std::string many;
  for (int k = 0; k < 500; ++k) many += whole;  // messages written one after the other are one message with the nodes of all

  const auto read = read_onnx(write_bytes("many.onnx", many));

  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().what, testing::HasSubstr("nodes"));
}

TEST_F(OnnxFile, DamagedAnywhere_RefusedOrReadWithoutACrash) {
  RecordProperty("requirement", "CLS-7");
  const std::string whole = onnx_text(model());
  for (std::size_t place = 0; place < whole.size(); place += 7) {
    std::string damaged = whole;
    damaged[place] = static_cast<char>(damaged[place] ^ 0x55);
    const auto read = read_onnx(write_bytes("damaged.onnx", damaged));
    EXPECT_TRUE(!read || !read->networks.empty());
    EXPECT_TRUE(!read_onnx(write_bytes("cut.onnx", whole.substr(0, place))) || place > 0);
  }
}

TEST_F(OnnxFile, ImportOfAnotherShape_RefusedWithBothShapes) {
  ASSERT_TRUE(files::save_trunk_model(path("model.toml"), model()));
  const std::string json = write("net.json",
                                 R"({"layers": [2, 1, 3], "hidden": "tanh", "output": "logistic", "W1": [[1, 2]], "b1": [0],
                                     "W2": [[1], [2], [3]], "b2": [0, 0, 0]})");

  EXPECT_THAT(refusal_of({"reach", "import", json, "--like", path("model.toml"), "--out", path("new.toml")}), testing::HasSubstr("2-1-3"));
  EXPECT_FALSE(std::filesystem::exists(path("new.toml")));
}

TEST_F(OnnxFile, ExportedAndImported_SameAnswers) {
  ASSERT_TRUE(files::save_trunk_model(path("model.toml"), model()));
  ASSERT_EQ(run_with({"reach", "export", path("model.toml"), "--onnx", path("model.onnx")}), cli::kOk) << talk();
  ASSERT_EQ(run_with({"reach", "import", path("model.onnx"), "--like", path("model.toml"), "--out", path("again.toml")}), cli::kOk)
      << talk();

  files::Problems problems;
  const auto again = files::load_trunk_model(path("again.toml"), problems);

  ASSERT_TRUE(again);
  for (double d2 = 0.0; d2 < 0.7; d2 += 0.05) {
    EXPECT_EQ(again->classify(classifier::reach_of(d2), 0).probability, model().classify(classifier::reach_of(d2), 0).probability);
  }
}

TEST_F(OnnxFile, JsonThatLies_Refused) {
  for (const char* text :
       {"", "[]", "{}", R"({"layers": [1e9, 1e9, 3], "hidden": "tanh", "output": "logistic"})",
        R"({"layers": [5, 8, 3], "hidden": "relu", "output": "logistic"})",
        R"({"layers": [1, 1, 3], "hidden": "tanh", "output": "logistic", "W1": [["x"]], "b1": [0], "W2": [[1],[1],[1]], "b2": [0,0,0]})",
        R"({"layers": [1, 1, 2], "hidden": "tanh", "output": "logistic", "W1": [[1]], "b1": [0], "W2": [[1],[1]], "b2": [0,0]})"}) {
    EXPECT_FALSE(read_network_json(write("net.json", text))) << text;
  }
}

// An evaluator of its own for the operators used, after the standard's text; python3-onnx's checker says whether the file is one.
constexpr const char* kEvaluate = R"(
import sys
try:
    import numpy as np, onnx
    from onnx import numpy_helper
except ImportError:
    sys.exit(77)
model = onnx.load(sys.argv[1])
onnx.checker.check_model(model, full_check=True)
values = {t.name: numpy_helper.to_array(t) for t in model.graph.initializer}
values["features"] = np.array([[float(x)] for x in sys.argv[2:]])
softmax = lambda x: np.exp(x) / np.exp(x).sum(1, keepdims=True)
run = {"Mul": lambda a, b: a * b, "Add": lambda a, b: a + b, "Div": lambda a, b: a / b, "Clip": np.clip, "Tanh": np.tanh,
       "Gemm": lambda x, w, b: x @ w.T + b, "Sigmoid": lambda x: 1 / (1 + np.exp(-x)), "Softmax": softmax, "Pow": np.power,
       "ReduceSum": lambda x, a: x.sum(tuple(a), keepdims=True), "Mean": lambda *x: sum(x) / len(x)}
for node in model.graph.node:
    values[node.output[0]] = run[node.op_type](*[values[name] for name in node.input])
for row in values["probability"]:
    print(*[repr(float(x)) for x in row])
)";

TEST_F(OnnxFile, CheckedAndEvaluatedByOthers_SameProbabilities) {
  const std::array relative_d2 = {0.05, 0.21, 0.33, 0.39, 0.7};
  const std::string script = write("evaluate.py", kEvaluate);
  std::string call = " " + script + " " + write_bytes("model.onnx", onnx_text(model()));
  for (const double d2 : relative_d2) call += " " + std::to_string(d2);
  call += " >" + path("out.txt");
  int status = 77;
  for (const char* python : {"python3", "/usr/bin/python3"}) {  // the second has Debian's packages wherever the first comes from
    status = WEXITSTATUS(std::system((python + call).c_str()));
    if (status != 77) break;
  }
  if (status == 77) GTEST_SKIP() << "python3-onnx is not here";
  ASSERT_EQ(status, 0);

  std::ifstream out(path("out.txt"));
  for (const double d2 : relative_d2) {
    const auto wanted = model().classify(classifier::reach_of(d2), 0).probability;
    for (const double probability : wanted) {
      double found = -1.0;
      out >> found;
      EXPECT_NEAR(found, probability, 1e-6) << d2;
    }
  }
}

}  // namespace
}  // namespace dts::lab::training
