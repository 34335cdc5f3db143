// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "c3d/c3d_file.h"
#include "c3d/force_platform.h"
#include "export_fixture.h"

namespace dts::record {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class C3dExportTest : public ExportTest {
 protected:
  FakeRecording recording_ = floor_recording();
  [[nodiscard]] core::Result<Exported> run() { return export_c3d(recording_, folder_.string()); }
  [[nodiscard]] c3d::C3dFile written() const { return c3d::C3dFile::read(text("20261121T144525Z-floor-1.c3d")).value(); }
};

TEST_F(C3dExportTest, Cop_IsAPlateOfType1WithItsGapsAsNaN) {
  RecordProperty("requirement", "REP-6");
  const auto exported = run();
  ASSERT_TRUE(exported.has_value()) << exported.error().what;
  EXPECT_THAT(files(), ElementsAre("20261121T144525Z-floor-1.c3d"));
  EXPECT_EQ(exported->rows, 107U) << "1.07 s at 100 Hz, with the gap";
  EXPECT_EQ(exported->dropped_events, 0U);
  const c3d::C3dFile file = written();
  EXPECT_EQ(file.analogue_rate_hz(), 100.0);
  EXPECT_EQ(file.samples(), 107U);
  EXPECT_THAT(file.warnings(), ElementsAre());
  EXPECT_EQ(force_platforms(file.parameters()).plates.at(0).type, 1);
  EXPECT_TRUE(std::isnan(file.analogue(1, 0))) << "no shear was measured";
  EXPECT_EQ(file.analogue(1, 2), static_cast<double>(0.5F)) << "the load";
  EXPECT_EQ(file.analogue(1, 3), static_cast<double>(0.3F));
  EXPECT_EQ(file.analogue(1, 4), static_cast<double>(0.4F));
  EXPECT_TRUE(std::isnan(file.analogue(50, 3))) << "in the gap";
  EXPECT_EQ(file.analogue(106, 3), static_cast<double>(0.3F));
  ASSERT_EQ(file.events().size(), 1U);
  EXPECT_EQ(file.events()[0].label, "eyes \"closed\", now");
  EXPECT_EQ(file.events()[0].context, "marker");
  EXPECT_NEAR(file.events()[0].time_s, 0.02, 1e-6);
}

TEST_F(C3dExportTest, Force_GivesShearAndFreeMoment) {
  StreamInfo force{.name = "floor/force", .content = "DTS", .rate = recording_.infos.at(1).rate};
  for (const char* label : {"fx_n", "fy_n", "fz_n", "mx_nm", "my_nm", "mz_nm"}) force.channels.push_back({.label = label});
  recording_.infos.push_back(force);
  recording_.items.emplace_back(RecordedScans{.stream = recording_.infos.size() - 1,
                                              .segment = 0,
                                              .first_scan = {0},
                                              .first_time_s = std::get<RecordedScans>(recording_.items.at(3)).first_time_s,
                                              .count = 2,
                                              .values = {1, 2, 700, 3, 4, 5, 10, 20, 710, 3, 4, 5}});
  ASSERT_TRUE(run().has_value());
  const c3d::C3dFile file = written();
  EXPECT_EQ(file.analogue(1, 0), 10.0);
  EXPECT_EQ(file.analogue(1, 2), 710.0);
  EXPECT_NEAR(file.analogue(1, 5), 5000.0 - (0.3 * 20.0 - 0.4 * 10.0), 1e-3) << "N mm";
}

TEST_F(C3dExportTest, EventsThatC3dCannotHold_AreCounted) {
  for (int marker = 0; marker < 300; ++marker) {
    recording_.items.emplace_back(TimedEvent{.time_s = 8123.26, .event = test::event_of("scan: 1 marker { text: 'step' }")});
  }
  EXPECT_EQ(run()->dropped_events, 46U) << "301, of which C3D holds 255";
  EXPECT_EQ(written().events().size(), 255U);
}

TEST_F(C3dExportTest, RecordingWithoutCentreOfPressure_IsRejected) {
  recording_.infos.at(1).name = "floor/other";
  EXPECT_THAT(refusal(run()), HasSubstr("has no centre of pressure and no force"));
  EXPECT_TRUE(files().empty());
}

}  // namespace
}  // namespace dts::record
