// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "files/cop_calibration_file.h"
#include "files/rig_file.h"
#include "unit/files/calibration_of_test.h"
#include "unit/files/files_fixture.h"

namespace dts::files {
namespace {

class Definition : public FilesTest {
 protected:
  Definition() { std::filesystem::copy(kConfig / "sensors", folder_ / "sensors"); }

  /// The shipped floor rig with `head` above it and `tail` below.
  [[nodiscard]] std::string rig_with(const std::string& head, const std::string& tail = "") const {
    return write("rigs/floor.toml", head + shipped_ + tail);
  }
  [[nodiscard]] physics::CopCalibration calibrate(std::size_t points) const {
    auto calibration = calibration_of_test(physics::CopMethod::Poly3);
    while (calibration.points.size() < points) calibration.points.push_back(calibration.points.front());
    EXPECT_TRUE(write_cop_calibration(path("calibration.toml"), calibration));
    return calibration;
  }
  /// The rig with the tables of its files in the places of their names.
  static toml::table whole_table(const std::filesystem::path& file) {
    toml::table table = toml::parse_file(file.string());
    const auto replace = [&file](toml::table& within, std::string_view key) {
      const auto name = within[key].value<std::string>();
      if (name) within.insert_or_assign(key, toml::parse_file((file.parent_path() / *name).string()));
    };
    for (const char* key : {"calibration", "model"}) replace(table, key);
    if (toml::array* const sensors = table["sensor"].as_array()) {  // a force plate has none
      for (toml::node& sensor : *sensors) replace(*sensor.as_table(), "curve");
    }
    return table;
  }

  const std::string shipped_ = edited(content_of(kConfig / "rigs/floor-sim.toml"), "calibration", "");
};

TEST_F(Definition, HoldsTheRigAndAllItsFilesAndReadsBack) {
  (void)calibrate(0);
  std::vector<std::filesystem::path> rigs{
      rig_with("calibration = \"../calibration.toml\"\n", "\n[record]\nstreams = [\"raw\", \"cop\"]\n")};
  for (const auto& entry : std::filesystem::directory_iterator(kConfig / "rigs")) {
    if (entry.path().extension() == ".toml") rigs.push_back(entry.path());
  }
  EXPECT_GE(rigs.size(), 4U);
  for (const auto& rig : rigs) {
    SCOPED_TRACE(rig);
    const auto definition = rig_definition(rig.string());
    ASSERT_TRUE(definition) << core::to_string(definition.error());
    EXPECT_EQ(toml::parse(*definition), whole_table(rig));
    EXPECT_EQ(definition->find(".toml"), std::string::npos);
    Problems problems;
    const auto from_file = read_rig_file(rig.string(), problems);
    const auto from_text = read_rig_text(*definition, "definition", problems);
    EXPECT_EQ(text_of(problems), "");
    EXPECT_EQ(from_text.trunk_model_text, from_file.trunk_model_text);
    EXPECT_EQ(from_text.cop_calibration.has_value(), from_file.cop_calibration.has_value());
    for (std::size_t k = 0; k < from_file.model.sensors.size(); ++k) {
      for (double gap_mm = 4.0; gap_mm < 13.0; gap_mm += 0.37) {
        EXPECT_EQ(from_text.model.sensors[k].curve.volts({gap_mm}), from_file.model.sensors[k].curve.volts({gap_mm}));
      }
    }
  }
}

TEST_F(Definition, LargeCalibration_LeavesOutItsPointsOnly) {
  const auto calibration = calibrate(9'000);

  const auto definition = rig_definition(rig_with("calibration = \"../calibration.toml\"\n"));

  ASSERT_TRUE(definition) << core::to_string(definition.error());
  Problems problems;
  const auto from_text = read_rig_text(*definition, "definition", problems);
  ASSERT_EQ(text_of(problems), "");
  EXPECT_THAT(from_text.cop_calibration->points, testing::IsEmpty());
  EXPECT_EQ(from_text.cop_calibration->estimator.form(), calibration.estimator.form());
}

TEST_F(Definition, TextThatNamesFiles_IsRefusedWithoutReadingThem) {
  Problems problems;
  (void)read_rig_text("calibration = \"/etc/passwd\"\n" + shipped_, "definition", problems);
  EXPECT_EQ(text_of(problems),
            "definition:27:9: [[sensor]] curve names a file, but a recorded definition must contain the table itself\n"
            "definition:35:9: [[sensor]] curve names a file, but a recorded definition must contain the table itself\n"
            "definition:41:9: [[sensor]] curve names a file, but a recorded definition must contain the table itself\n"
            "definition:47:9: [[sensor]] curve names a file, but a recorded definition must contain the table itself\n"
            "definition:1:15: calibration names a file, but a recorded definition must contain the table itself");
}

TEST_F(Definition, RigThatHasNone_SaysWhy) {
  const auto refusal = [this](const std::string& head, const std::string& tail = "") {
    const auto definition = rig_definition(rig_with(head, tail));
    return definition ? std::to_string(definition->size()) : without_folder(definition.error().what);
  };
  const auto streams = [](std::size_t bytes) { return "[record]\nstreams = [\"" + std::string(bytes, 'x') + "\"]\n"; };
  const std::size_t room = (std::size_t{1} << 20U) - std::stoul(refusal("", streams(0)));
  EXPECT_EQ(refusal("", streams(room)), "1048576");
  EXPECT_EQ(refusal("", streams(room + 1)),
            "the rig in rigs/floor.toml is too large to be recorded with a session: 1048577 bytes of at most 1048576");
  EXPECT_EQ(refusal("no_such_key = 1\n"),
            "cannot write the definition of the rig in rigs/floor.toml: rigs/floor.toml:1:1: unknown key 'no_such_key'");
  EXPECT_EQ(refusal("", "[record]\nstreams = []\n"),
            "cannot write the definition of the rig in rigs/floor.toml: rigs/floor.toml:70:11: [record] streams is empty; leave it out to "
            "record all "
            "streams of the rig");
  EXPECT_EQ(rig_definition(path("none.toml")).error().code, core::ErrorCode::InvalidArgument);
}

}  // namespace
}  // namespace dts::files
