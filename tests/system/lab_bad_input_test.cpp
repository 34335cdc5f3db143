// SPDX-License-Identifier: Apache-2.0
// What dtslab, as a program, does with input that is wrong: exit status 2, the place, the range; nothing on standard output.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "system/daemon_process.h"

namespace dts::test {
namespace {

using ::testing::HasSubstr;

constexpr auto kPlate = "[plate]\na_mm = 430.0\nb_mm = 430.0\nh_mm = 3.0\ne_pa = 198.7e9\nnu = 0.27\n";
constexpr auto kSupport = "[support]\nkind = \"corner\"\ninset_mm = 10.75\n";
constexpr auto kLoad = "[[load]]\nx_mm = 215.0\ny_mm = 215.0\nforce_n = 196.133\n";
constexpr auto kProbe = "[[probe]]\nx_mm = 215.0\ny_mm = 215.0\n";

class LabProgram : public ::testing::Test {
 protected:
  LabProgram() { std::filesystem::create_directories(directory_); }
  ~LabProgram() override { std::filesystem::remove_all(directory_); }

  [[nodiscard]] std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(directory_ / name) << text;
    return (directory_ / name).string();
  }
  [[nodiscard]] static Finished lab(std::vector<std::string> words) {
    words.insert(words.begin(), DTSLAB_PROGRAM);
    return run_program(words);
  }
  [[nodiscard]] Finished solve(const std::string& text, std::vector<std::string> words = {}) const {
    words.insert(words.begin(), {"plate", "solve", write("case.toml", text)});
    return lab(words);
  }

  std::filesystem::path directory_ = std::filesystem::path(::testing::TempDir()) / ("dtslab_system_" + std::to_string(::getpid()));
};

struct WrongCase {
  std::string text;
  std::string says;
};

TEST_F(LabProgram, WrongPlateCases_AreRefusedWithPlaceAndRange) {
  const std::string plate(kPlate);
  const std::string support(kSupport);
  const std::string load(kLoad);
  const auto replaced = [](std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  };
  const std::vector<WrongCase> cases{
      {replaced(plate, "h_mm = 3.0", "h_mm = -3.0") + support + load,
       "case.toml:4:8: [plate] h_mm = -3 is out of range; allowed: 0.01 .. 86"},
      {replaced(plate, "h_mm = 3.0", "h_mm = 0.0") + support + load, "case.toml:4:8"},
      {replaced(plate, "nu = 0.27", "nu = 0.5") + support + load, "case.toml:6:6: nu = 0.5 is out of range; allowed: -1 .. 0.5"},
      {replaced(plate, "nu = 0.27", "nu = -1") + support + load, "case.toml:6:6"},
      {replaced(plate, "nu = 0.27", "nu = nan") + support + load, "case.toml:6:6"},
      {replaced(plate, "e_pa = 198.7e9", "e_pa = inf") + support + load, "case.toml:5:8"},
      {replaced(plate, "a_mm = 430.0", "a_mm = \"430\"") + support + load, "case.toml:2:8: [plate] a_mm must be a number"},
      {plate + support + replaced(load, "x_mm = 215.0", "x_mm = 500.0"), "allowed: 0 .. 430"},
      {plate + support + replaced(load, "196.133", "0.0"), "force_n of [[load]] is 0"},
      {plate + support + replaced(load, "196.133", "nan"), "force_n"},
      {plate + support, "no [[load]]"},
      {plate + support + load + "[[probe]]\nx_mm = -1.0\ny_mm = 0.0\n", "[[probe]] x_mm = -1 is out of range"},
      {plate + replaced(support, "10.75", "215.0") + load, "inset_mm = 215 is out of range"},
      {plate + replaced(support, "10.75", "9999.0") + load, "inset_mm = 9999 is out of range"},
      {plate + replaced(support, "corner", "corners") + load, "did you mean \"corner\"?"},
      {plate + support + load + "[solver]\ndivisions = 1\n", "divisions = 1 is out of range; allowed: 4 .. 200"},
      {plate + support + load + "[solver]\ndivisions = 5000\n", "allowed: 4 .. 200"},
      {plate + support + load + "[solver]\nmethod = \"bem\"\n", "known: \"fdm\", \"fem\""},
      {plate + support + load + "[slover]\n", "unknown key 'slover'; did you mean 'solver'?"},
      {"[plate\n", "case.toml:1:"},
      {"", "[plate] is missing"},
      {std::string("\x00\xff\xfe", 3), "case.toml:1:"}};
  for (const WrongCase& wrong : cases) {
    const Finished finished = solve(wrong.text);
    EXPECT_EQ(finished.status, 2) << wrong.text;
    EXPECT_THAT(finished.err, HasSubstr(wrong.says)) << wrong.text;
    EXPECT_EQ(finished.out, "") << wrong.text;
  }
}

TEST_F(LabProgram, EveryProblemOfACase_IsShownInOneRun) {
  const Finished finished = solve("[plate]\na_mm = 430.0\nb_mm = 430.0\nh_mm = -3.0\ne_pa = nan\nnu = 2.0\n" + std::string(kSupport));

  EXPECT_EQ(finished.status, 2);
  for (const char* place : {"case.toml:4:8", "case.toml:5:8", "case.toml:6:6", "no [[load]]"}) EXPECT_THAT(finished.err, HasSubstr(place));
}

TEST_F(LabProgram, WrongWords_ExitWithTwo) {
  const std::string file = write("case.toml", std::string(kPlate) + kSupport + kLoad);
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{{},
                                                                                     {"plate", "solve"},
                                                                                     {"plate", "solve", file, "--method", "x"},
                                                                                     {"plate", "solve", file, "--divisions", "1"},
                                                                                     {"plate", "solve", file, "--divisions", "5000"},
                                                                                     {"plate", "solve", file, "--divisions", "nan"},
                                                                                     {"plate", "solve", file, "--plot", "x.bmp"},
                                                                                     {"plate", "solve", "/nonexistent.toml"},
                                                                                     {"plate", "solve", "/"},
                                                                                     {"thesis", "9.9"},
                                                                                     {"cop", "evaluate", "--estimator", "x"},
                                                                                     {"cop", "evaluate", "--rig", "/nonexistent.toml"},
                                                                                     {"compare", "/nonexistent.csv", "/nonexistent.csv"}}) {
    const Finished finished = lab(words);
    EXPECT_EQ(finished.status, 2) << ::testing::PrintToString(words);
    EXPECT_NE(finished.err, "") << ::testing::PrintToString(words);
    EXPECT_EQ(finished.out, "") << ::testing::PrintToString(words);
  }
}

// Thesis Table 3.3 at 20 kgf: 2.466 mm, 0.8 % (plate-model section 4 A).
TEST_F(LabProgram, GoodCase_IsOneJsonDocument) {
  const Finished finished = solve(std::string(kPlate) + kSupport + kLoad + kProbe, {"--json"});

  ASSERT_EQ(finished.status, 0) << finished.err;
  const auto answer = nlohmann::json::parse(finished.out);
  EXPECT_NEAR(answer.at("probes").at(0).at("deflection_mm").get<double>(), 2.466, 0.0197);
  EXPECT_THAT(finished.err, HasSubstr("--nonlinear")) << "2.5 mm of 3, and not among the results";
}

TEST_F(LabProgram, OutputThatCannotBeWritten_IsNeverSilence) {
  const Finished finished = lab({"cop", "fit", write("points.csv", "p_n\n"), "--rig",
                                 std::string(DTS_SOURCE_DIR) + "/config/rigs/floor-sim.toml", "--out", "/nonexistent/cal.toml"});
  EXPECT_EQ(finished.status, 2) << "the points are looked at first";

  const std::string file = write("case.toml", std::string(kPlate) + kSupport + kLoad);
  EXPECT_EQ(run_program({"/bin/sh", "-c", std::string(DTSLAB_PROGRAM) + " plate solve " + file + " > /dev/full"}).status, 1);
  const Finished plotted = lab({"plate", "solve", file, "--plot", "/nonexistent/x.svg"});
  EXPECT_EQ(plotted.status, 2) << "no such folder";
  EXPECT_THAT(plotted.err, HasSubstr("/nonexistent/x.svg"));
}

}  // namespace
}  // namespace dts::test
