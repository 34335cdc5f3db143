// SPDX-License-Identifier: Apache-2.0
#include "classifier/network.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace dts::classifier {
namespace {

TEST(Network, OneHiddenNode_OutputsAsByHand) {
  const auto network = Network::create(2, 1, OutputKind::Logistic, {0.5, -1.0, 0.25, 2.0, 0.0, -3.0, 0.1, 0.0, 1.0}).value();

  const auto outputs = network.outputs(std::array{0.8, -0.2});

  const double hidden = std::tanh(0.5 * 0.8 + 0.2 + 0.25);
  EXPECT_NEAR(outputs[0], 1.0 / (1.0 + std::exp(-(2.0 * hidden + 0.1))), 1e-12);
  EXPECT_NEAR(outputs[1], 0.5, 1e-12);
  EXPECT_NEAR(outputs[2], 1.0 / (1.0 + std::exp(-(-3.0 * hidden + 1.0))), 1e-12);
}

TEST(Network, ThesisShape_Has75Weights) { EXPECT_EQ(Network::weight_count(5, 8), 75U); }

TEST(Network, SoftmaxOfHugeSums_StaysFiniteAndSumsToOne) {
  const auto outputs = activate(OutputKind::Softmax, {1e4, -1e4, 1e4});

  EXPECT_NEAR(outputs[0], 0.5, 1e-12);
  EXPECT_NEAR(outputs[1], 0.0, 1e-12);
  EXPECT_NEAR(outputs[0] + outputs[1] + outputs[2], 1.0, 1e-12);
}

TEST(Network, LogisticOfHugeSums_StaysFinite) {
  const auto outputs = activate(OutputKind::Logistic, {1e4, -1e4, 0.0});

  EXPECT_EQ(outputs[0], 1.0);
  EXPECT_EQ(outputs[1], 0.0);
  EXPECT_EQ(outputs[2], 0.5);
}

TEST(Network, CountsThatDoNotFit_Refused) {
  EXPECT_FALSE(Network::create(0, 8, OutputKind::Logistic, {}));
  EXPECT_FALSE(Network::create(5, 0, OutputKind::Logistic, {}));
  EXPECT_FALSE(Network::create(5, 8, OutputKind::Logistic, std::vector<double>(74)));
  EXPECT_FALSE(Network::create(5, Network::kMaxHidden + 1, OutputKind::Logistic, std::vector<double>(Network::weight_count(5, 33))));
  EXPECT_FALSE(Network::create(Network::kMaxInputs + 1, 1, OutputKind::Logistic, std::vector<double>(Network::weight_count(13, 1))));
}

TEST(Network, WeightThatIsNotFinite_Refused) {
  std::vector<double> weights(75, 0.1);
  weights[40] = std::numeric_limits<double>::quiet_NaN();

  EXPECT_FALSE(Network::create(5, 8, OutputKind::Logistic, weights));
}

}  // namespace
}  // namespace dts::classifier
