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

TEST(Network, HugeSums_StayFinite) {
  EXPECT_EQ(activate(OutputKind::Softmax, {1e4, -1e4, 1e4}), (Network::Outputs{0.5, 0.0, 0.5}));
  EXPECT_EQ(activate(OutputKind::Logistic, {1e4, -1e4, 0.0}), (Network::Outputs{1.0, 0.0, 0.5}));
}

TEST(Network, CountsThatDoNotFitAndWeightsThatAreNotFinite_Refused) {
  const auto create = [](std::size_t inputs, std::size_t hidden, std::size_t weights, double weight = 0.1) {
    return Network::create(inputs, hidden, OutputKind::Logistic, std::vector<double>(weights, weight)).has_value();
  };
  EXPECT_TRUE(create(5, 8, 75));  // the thesis's
  EXPECT_TRUE(create(Network::kMaxInputs, Network::kMaxHidden, Network::weight_count(Network::kMaxInputs, Network::kMaxHidden)));
  EXPECT_FALSE(create(0, 8, Network::weight_count(0, 8)));
  EXPECT_FALSE(create(5, 0, Network::weight_count(5, 0)));
  EXPECT_FALSE(create(5, 8, 74));
  EXPECT_FALSE(create(5, Network::kMaxHidden + 1, Network::weight_count(5, Network::kMaxHidden + 1)));
  EXPECT_FALSE(create(Network::kMaxInputs + 1, 1, Network::weight_count(Network::kMaxInputs + 1, 1)));
  EXPECT_FALSE(create(5, 8, 75, std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE(Network::create(1, 1, OutputKind{7}, std::vector<double>(8, 0.1)));
}

}  // namespace
}  // namespace dts::classifier
