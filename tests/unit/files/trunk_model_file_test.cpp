// SPDX-License-Identifier: Apache-2.0
#include "files/trunk_model_file.h"

#include <gtest/gtest.h>

#include <tuple>

#include "unit/classifier/hand_made_model.h"
#include "unit/files/files_fixture.h"

namespace dts::files {
namespace {

using classifier::TrunkModel;

class TrunkModelFile : public FilesTest {
 protected:
  static TrunkModel model() {
    auto form = classifier::hand_made_form();
    form.general.inputs[0].maximum = 0.6 + 1.0 / 3e9;  // no short decimal
    form.facts.simulated_subjects = 3;
    form.facts.created_utc = "2026-01-31T12:00:00Z";
    form.figures = {0.97, 0.9, 0.91, 0.92, 0.93, 4.0, 0.94, 0.05};
    return TrunkModel::create(form).value();
  }
  static void read(const std::string& text, Problems& problems) {
    const auto table = parse_toml_text(text, "model", problems);
    if (!table) return;
    TomlReader reader(&*table, "", "model", problems);
    const bool is_read = read_trunk_model(reader, problems).has_value();
    EXPECT_EQ(is_read, problems.empty());
  }
};

auto values_of(const classifier::ModelFigures& figures) {
  const auto& [validation, left_out, left_out_own, kept, kept_accuracy, angle_rms, angle_coverage, calibration_error] = figures;
  return std::tuple(validation, left_out, left_out_own, kept, kept_accuracy, angle_rms, angle_coverage, calibration_error);
}

TEST_F(TrunkModelFile, SavedAndLoaded_SameFormAndSameText) {
  ASSERT_TRUE(save_trunk_model(path("model.toml"), model()));
  Problems problems;
  const auto loaded = load_trunk_model(path("model.toml"), problems);

  ASSERT_TRUE(loaded) << text_of(problems);
  const auto& [read, written] = std::pair(loaded->form(), model().form());
  EXPECT_EQ(read.general, written.general);
  EXPECT_EQ(read.own, written.own);
  EXPECT_EQ(read.angle, written.angle);
  EXPECT_EQ(read.own_angle, written.own_angle);
  EXPECT_EQ(read.arm_alone, written.arm_alone);
  EXPECT_EQ(read.facts, written.facts);
  EXPECT_EQ(read.kind, written.kind);
  EXPECT_EQ(std::tuple(read.reject_below, read.p1_minimum_mm, read.p1_maximum_mm),
            std::tuple(written.reject_below, written.p1_minimum_mm, written.p1_maximum_mm));
  EXPECT_EQ(values_of(read.figures), values_of(written.figures));
  EXPECT_EQ(trunk_model_text(*loaded), trunk_model_text(model()));
}

TEST_F(TrunkModelFile, Limits_AreReportedWithPlaceAndRange) {
  const std::string network = "[[general.network]]\nhidden = 2\noutput = \"softmax\"\nweights = [" + [] {
    std::string zeros = "0";
    for (int count = 1; count < 13; ++count) zeros += ", 0";
    return zeros;
  }() + "]\n";
  std::string most;
  for (std::size_t count = 1; count < classifier::Ensemble::kMaxNetworks; ++count) most += network;
  std::string subjects = "\"s\"";
  for (int count = 1; count < 1000; ++count) subjects += ", \"s\"";
  // Without the checksum, which any change breaks.
  expect_problems(
      edited(trunk_model_text(model()), "sha256", ""),
      {
          {"format", "format = 2", "model:9:10: format 2 is not known; this program reads format 1"},
          {"format", "", "model:1:1: format is missing"},
          {"kind", "kind = 'deep'", "model:11:8: kind = \"deep\" is not known; known: \"raw5\", \"recommended\""},
          {"kind", "", "model:1:1: kind is missing"},
          {"reject_below", "reject_below = 1.1\nreject_above = 1.0",
           "model:12:16: reject_below = 1.1 is out of range; allowed: 0 .. 1\n"
           "model:13:1: unknown key 'reject_above'"},
          {"reject_below", "", "model:1:1: reject_below is missing"},
          {"p1_minimum_mm", "p1_minimum_mm = 0.0", "model:13:17: p1_minimum_mm = 0 is out of range; allowed: 0.001 .. 1000"},
          {"p1_minimum_mm", "p1_minimum_mm = 5.0",
           "model:11:8: trunk model: the range of P1 is empty (use an unchanged model file that dtslab reach train wrote)"},
          {"p1_maximum_mm", "p1_maximum_mm = 1000", ""},
          {"p1_maximum_mm", "p1_maximum_mm = 1000.5", "model:14:17: p1_maximum_mm = 1000.5 is out of range; allowed: 0.001 .. 1000"},
          {"[training]", "[trainin]",
           "model:1:1: training is missing\n"
           "model: [training] is missing\n"
           "model: data_sha256 must be 64 hexadecimal digits\n"
           "model: seed must be a whole number in quotes\n"
           "model:16:2: unknown key 'trainin'; did you mean 'training'?"},
          {"data_sha256", "data_sha256 = '" + std::string(63, 'a') + "'", "model:17:15: data_sha256 must be 64 hexadecimal digits"},
          {"data_sha256", "data_sha256 = '" + std::string(65, 'a') + "'", "model:17:15: data_sha256 must be 64 hexadecimal digits"},
          {"data_sha256", "data_sha256 = '" + std::string(63, 'a') + "g'", "model:17:15: data_sha256 must be 64 hexadecimal digits"},
          {"data_sha256", "data_sha256 = '" + std::string(32, '0') + std::string(32, 'f') + "'", ""},
          {"subjects", "subjects = [" + subjects + "]", ""},
          {"subjects", "subjects = [" + subjects + ", \"s\"]", "model:18:12: there are more than 1000 subjects"},
          {"seed", "seed = '-1'", "model:21:8: seed must be a whole number in quotes"},
          {"seed", "seed = '18446744073709551616'", "model:21:8: seed must be a whole number in quotes"},
          {"seed", "seed = '1x'", "model:21:8: seed must be a whole number in quotes"},
          {"seed", "",
           "model:16:1: [training] seed is missing\n"
           "model:16:1: seed must be a whole number in quotes"},
          {"software", "software = 1\nhardware = 1",
           "model:22:12: [training] software must be a text in quotes\n"
           "model:23:1: unknown key 'hardware' in [training]"},
          {"created_utc", "created_utc = 1", "model:23:15: [training] created_utc must be a text in quotes"},
          {"validation_accuracy", "validation_accuracy = 0.89",
           "model:27:23: validation_accuracy is below 0.9: the training failed, do not use this model"},
          {"validation_accuracy", "validation_accuracy = 0.9", ""},
          {"validation_accuracy", "", "model:26:1: [figures] validation_accuracy is missing"},
          {"expected_calibration_error", "expected_calibration_error = 1.1\nerror = 1",
           "model:34:30: [figures] expected_calibration_error = 1.1 is out of range; allowed: 0 .. 1\n"
           "model:35:1: unknown key 'error' in [figures]"},
          {"features", "features = ['d2_of_p7']",
           "model:37:12: feature \"d2_of_p7\" is not known\n"
           "model:40:1: unknown key 'coefficients' in [angle]"},
          {"features", "features = []",
           "model:37:12: features must be a list of 1 to 12 names\n"
           "model:40:1: unknown key 'coefficients' in [angle]\n"
           "model:39:1: unknown key 'maximum' in [angle]\n"
           "model:38:1: unknown key 'minimum' in [angle]"},
          {"features", "",
           "model:36:1: [angle] features is missing\n"
           "model:36:1: features must be a list of 1 to 12 names\n"
           "model:40:1: unknown key 'coefficients' in [angle]\n"
           "model:39:1: unknown key 'maximum' in [angle]\n"
           "model:38:1: unknown key 'minimum' in [angle]"},
          {"minimum", "minimum = [1.2]", "model:38:11: d2_of_p1: the minimum is not below the maximum"},
          {"maximum", "maximum = [1.2, 3.0]",
           "model:39:11: maximum must be a list of 1 numbers\n"
           "model:40:1: unknown key 'coefficients' in [angle]"},
          {"maximum", "maximum = [inf]",
           "model:39:11: maximum: number 1 of the list is not a finite number of at most 1e+30 in size\n"
           "model:40:1: unknown key 'coefficients' in [angle]"},
          {"maximum", "maximum = [1e30]", ""},
          {"maximum", "maximum = [1.1e30]",
           "model:39:11: maximum: number 1 of the list is not a finite number of at most 1e+30 in size\n"
           "model:40:1: unknown key 'coefficients' in [angle]"},
          {"coefficients", "coefficients = [nan, 0, 0]",
           "model:40:16: coefficients: number 1 of the list is not a finite number of at most 1e+30 in size"},
          {"coefficients", "coefficients = [0, 0]", "model:40:16: coefficients must be a list of 3 numbers"},
          {"residual_deg", "residual_deg = [3.0, 6.0, -9.0]",
           "model:11:8: trunk model: angle: a residual is outside 0 to 90 degrees (use an unchanged model file that dtslab reach train "
           "wrote)"},
          {"residual_deg", "residual_deg = [3.0, 6.0]\nresidual = 1",
           "model:41:16: residual_deg must be a list of 3 numbers\n"
           "model:42:1: unknown key 'residual' in [angle]"},
          {"none_from", "none_from = 0.49", "model:56:13: [arm_alone] none_from = 0.49 is out of range; allowed: 0.5 .. 1"},
          {"none_from", "none_from = 0.5", ""},
          {"none_from", "none_from = 1.1\nnone_to = 1.0",
           "model:56:13: [arm_alone] none_from = 1.1 is out of range; allowed: 0.5 .. 1\n"
           "model:57:1: unknown key 'none_to' in [arm_alone]"},
          {"none_from", "", "model:51:1: [arm_alone] none_from is missing"},
          {"[general]", "[genera]",
           "model:63:1: [general] features is missing\n"
           "model:63:1: features must be a list of 1 to 12 names\n"
           "model:58:2: unknown key 'genera'; did you mean 'general'?"},
          {"temperature", "temperature = 20.1\ntemperatur = 1",
           "model:62:15: [general] temperature = 20.1 is out of range; allowed: 0.05 .. 20\n"
           "model:63:1: unknown key 'temperatur' in [general]; did you mean 'temperature'?"},
          {"[[general.network]]", most + "[[general.network]]", ""},
          {"[[general.network]]", most + network + "[[general.network]]", "model:63:1: there must be 1 to 64 networks, not 65"},
          {"[[general.network]]", "[[general.networ]]",
           "model:58:1: there must be 1 to 64 networks, not 0\n"
           "model:63:11: unknown key 'networ' in [general]; did you mean 'network'?"},
          {"hidden", "hidden = 3\nhiden = 2",
           "model:67:11: weights must be a list of 18 numbers\n"
           "model:65:1: unknown key 'hiden' in [[network]]; did you mean 'hidden'?"},
          {"hidden", "hidden = 0",
           "model:64:10: [[network]] hidden = 0 is out of range; allowed: 1 .. 32\n"
           "model:66:11: weights must be a list of 8 numbers"},
          {"hidden", "hidden = 1000000000",
           "model:64:10: [[network]] hidden = 1000000000 is out of range; allowed: 1 .. 32\n"
           "model:66:11: weights must be a list of 8 numbers"},
          {"hidden", "",
           "model:63:1: [[network]] hidden is missing\n"
           "model:66:11: weights must be a list of 8 numbers"},
          {"output", "output = 'relu'", "model:65:10: [[network]] output = \"relu\" is not known; known: \"logistic\", \"softmax\""},
          {"weights", "weights = [1.0]", "model:66:11: weights must be a list of 13 numbers"},
          {"weights", "weights = [\"20\", 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]",
           "model:66:11: weights: number 1 of the list is not a finite number of at most 1e+30 in size"},
      },
      read);
  expect_ranges(edited(trunk_model_text(model()), "sha256", ""),
                {
                    {"reject_below", "", "0", "1", "-0.1", "1.1"},
                    {"p1_minimum_mm", "", "0.001", "1000", "-0.1", "1001"},
                    {"p1_maximum_mm", "", "0.001", "1000", "-1", "1001"},
                    {"simulated_subjects", "[training]", "0", "2147483647", "-1", "2147483648"},
                    {"trials", "[training]", "1", "100000000", "0", "100000001"},
                    {"validation_accuracy", "[figures]", "0", "1", "-0.1", "1.1"},
                    {"left_out_accuracy", "[figures]", "0", "1", "-0.1", "1.1"},
                    {"left_out_own_accuracy", "[figures]", "0", "1", "-0.1", "1.1"},
                    {"left_out_kept", "[figures]", "0", "1", "-0.1", "1.1"},
                    {"left_out_kept_accuracy", "[figures]", "0", "1", "-0.1", "1.1"},
                    {"left_out_angle_rms_deg", "[figures]", "0", "180", "-1", "181"},
                    {"left_out_angle_coverage", "[figures]", "0", "1", "-0.1", "1.1"},
                    {"none_from", "[arm_alone]", "0.5", "1", "0.49", "1.1"},
                    {"temperature", "[general]", "0.05", "20", "0.049", "22"},
                },
                read);
}

TEST_F(TrunkModelFile, Checksum_IsOfTheValuesAndMayBeMissing) {
  expect_problems(
      trunk_model_text(model()),
      {{"weights", "weights = [20.5, 20.0, 6.7, -6.7, -9.0, 0.0, 6.0, -6.0, 0.0, 9.0, 0.0, -6.0, 0.0]",
        "model:10:10: the model is damaged or was edited: its sha256 is 673fffe590623ad3b3cce9667e01216a2352cbdbdb77e636385594aad4d2b94f; "
        "copy it again, or train it again with dtslab reach train"},
       {"reject_below", "reject_below = 0.8",
        "model:10:10: the model is damaged or was edited: its sha256 is 6da029a324ddc81248da4f8269b15eeb55721b6ab52b473bea05a962356f23fc; "
        "copy it again, or train it again with dtslab reach train"},
       {"sha256", "sha256 = '0'",
        "model:10:10: the model is damaged or was edited: its sha256 is 1e0c59376a86253fe400d66c854fa2fd5eaa7c0c2425a89b296f071775a54e97; "
        "copy it again, or train it again with dtslab reach train"},
       {"sha256", "sha256 = 0", "model:10:10: sha256 must be a text in quotes"},
       {"reject_below", "# another comment\n\nreject_below = 0.90", ""},
       {"sha256", "", ""}},
      read);
}

TEST_F(TrunkModelFile, EveryPrefixOfAFile_RefusedWithoutACrash) {
  RecordProperty("requirement", "CLS-7");
  const std::string text = trunk_model_text(model());
  for (std::size_t length = 0; length + 2 < text.size(); length += 97) {
    Problems problems;
    read(text.substr(0, length), problems);
    EXPECT_FALSE(problems.empty()) << length;
  }
}

}  // namespace
}  // namespace dts::files
