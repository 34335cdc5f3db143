// SPDX-License-Identifier: Apache-2.0
#include "files/trunk_model_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <tuple>

#include "unit/classifier/hand_made_model.h"

namespace dts::files {
namespace {

using classifier::TrunkModel;
using testing::HasSubstr;

class TrunkModelFile : public testing::Test {
 protected:
  ~TrunkModelFile() override { std::filesystem::remove(file_); }

  static TrunkModel model() {
    auto form = classifier::hand_made_form();
    form.general.inputs[0].maximum = 0.6 + 1.0 / 3e9;  // no short decimal
    return TrunkModel::create(form).value();
  }

  /// Everything wrong with the model's text in which `from` is replaced by `to`.
  Problems problems_with(const std::string& from, const std::string& to) {
    std::string text = trunk_model_text(model());
    const auto place = text.find(from);
    EXPECT_NE(place, std::string::npos) << from;
    std::ofstream(file_) << text.replace(place, from.size(), to);
    Problems problems;
    EXPECT_FALSE(load_trunk_model(file_, problems)) << from << " -> " << to;
    return problems;
  }

  std::string file_ = (std::filesystem::path(testing::TempDir()) / ("trunk_model_" + std::to_string(::getpid()) + ".toml")).string();
};

TEST_F(TrunkModelFile, SavedAndLoaded_SameFormAndSameText) {
  ASSERT_TRUE(save_trunk_model(file_, model()));
  Problems problems;
  const auto loaded = load_trunk_model(file_, problems);

  ASSERT_TRUE(loaded) << (problems.empty() ? "" : to_string(problems.front()));
  const auto& [read, written] = std::pair(loaded->form(), model().form());
  EXPECT_EQ(read.general, written.general);
  EXPECT_EQ(read.own, written.own);
  EXPECT_EQ(read.angle, written.angle);
  EXPECT_EQ(read.own_angle, written.own_angle);
  EXPECT_EQ(read.arm_alone, written.arm_alone);
  EXPECT_EQ(read.facts, written.facts);
  EXPECT_EQ(trunk_model_text(*loaded), trunk_model_text(model()));
}

TEST_F(TrunkModelFile, LoadedModel_ClassifiesBitForBitAsTheSavedOne) {
  ASSERT_TRUE(save_trunk_model(file_, model()));
  Problems problems;
  const auto loaded = load_trunk_model(file_, problems);
  ASSERT_TRUE(loaded);

  for (double d2 = 0.0; d2 < 0.8; d2 += 0.013) {
    const auto reach = classifier::reach_of(d2);
    EXPECT_EQ(loaded->classify(reach, 0).probability, model().classify(reach, 0).probability);
    EXPECT_EQ(loaded->classify(reach, 0).trunk_deg, model().classify(reach, 0).trunk_deg);
  }
}

TEST_F(TrunkModelFile, WhatDoesNotFit_RefusedWithLineAndReason) {
  for (const auto& [from, to, reason] : {
           std::tuple{"format = 1", "format = 2", "format 2 is not known"},
           {"kind = 'recommended'", "kind = 'deep'", "deep"},
           {"'d2_of_p1'", "'d2_of_p7'", "is not known"},
           {"features = ['d2_of_p1']", "features = []", "features"},
           {"maximum = [1.2]", "maximum = [-1.2]", "the minimum is not below"},
           {"maximum = [1.2]", "maximum = [1.2, 3.0]", "list of 1 numbers"},
           {"maximum = [1.2]", "maximum = [inf]", "not a finite number"},
           {"coefficients = [0.45, ", "coefficients = [nan, ", "not a finite number"},
           {"coefficients = [0.45, 0.45, 0.0]", "coefficients = [0.45, 0.45]", "list of 3 numbers"},
           {"weights = [20.0, ", "weights = [", "list of 13 numbers"},
           {"weights = [20.0, ", "weights = [\"20\", ", "not a finite number"},
           {"hidden = 2", "hidden = 3", "list of 18 numbers"},
           {"hidden = 2", "hidden = 1000000000", "hidden"},
           {"output = 'softmax'", "output = 'relu'", "relu"},
           {"validation_accuracy = 0.97", "validation_accuracy = 0.5", "the training failed"},
           {"validation_accuracy = 0.97", "# none", "validation_accuracy"},
           {"data_sha256 = 'aa", "data_sha256 = 'zz", "hexadecimal"},
           {"residual_deg = [3.0, 6.0, 9.0]", "residual_deg = [3.0, 6.0, -9.0]", "residual"},
           {"none_from = 0.9", "none_from = 0.1", "none_from"},
           {"none_from = 0.9", "none_from = 1.01", "none_from"},
           {"none_from = 0.9", "none_from = 0.9\nnone_to = 1.0", "none_to"},
           {"hidden = 2", "hidden = 2\nhiden = 2", "hiden"},
           {"temperature = ", "temperature = 0.049 # ", "temperature"},
           {"reject_below = 0.9", "reject_below = 0.9\nreject_above = 1.0", "reject_above"},
           {"seed = '18446744073709551615'", "seed = '-1'", "seed"},
           {"p1_minimum_mm = 3.0", "p1_minimum_mm = 5.0", "P1"},
       }) {
    const auto problems = problems_with(from, to);

    ASSERT_FALSE(problems.empty()) << from;
    EXPECT_THAT(to_string(problems.front()), HasSubstr(reason));
    EXPECT_THAT(to_string(problems.front()), HasSubstr(file_ + ":"));
  }
}

TEST_F(TrunkModelFile, OneDigitOfANumberChanged_IsNoticed) {
  for (const auto& [from, to] : {std::tuple{"weights = [20.0, ", "weights = [20.5, "},
                                 {"coefficients = [0.45, 0.45, 0.0]", "coefficients = [0.45, 0.45, 0.1]"},
                                 {"reject_below = 0.9", "reject_below = 0.8"},
                                 {"p1_minimum_mm = 3.0", "p1_minimum_mm = 2.0"},
                                 {"sha256 = '", "sha256 = '0"}}) {
    const auto problems = problems_with(from, to);

    ASSERT_EQ(problems.size(), 1U) << to;
    EXPECT_THAT(to_string(problems.front()), HasSubstr("damaged or was edited"));
  }
}

TEST_F(TrunkModelFile, ChecksumIsOfTheModel_NotOfHowItIsWrittenAndMayBeMissing) {
  for (const auto& [from, to] :
       {std::tuple{"reject_below = 0.9", "# another comment\n\nreject_below = 0.90"}, {"sha256 = '", "# sha256 = '"}}) {
    std::string text = trunk_model_text(model());
    std::ofstream(file_) << text.replace(text.find(from), std::string(from).size(), to);
    Problems problems;
    EXPECT_TRUE(load_trunk_model(file_, problems)) << (problems.empty() ? "" : to_string(problems.front()));
  }
}

TEST_F(TrunkModelFile, EveryPrefixOfAFile_RefusedWithoutACrash) {
  const std::string text = trunk_model_text(model());
  for (std::size_t length = 0; length + 2 < text.size(); length += 97) {
    std::ofstream(file_) << text.substr(0, length);
    Problems problems;
    (void)load_trunk_model(file_, problems);
    EXPECT_FALSE(problems.empty()) << length;
  }
}

}  // namespace
}  // namespace dts::files
