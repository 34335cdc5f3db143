// SPDX-License-Identifier: Apache-2.0
#include "ipc/encode_sway.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "ipc/encode_session.h"
#include "record/event.h"
#include "session/sway_record.h"

namespace dts::ipc {
namespace {

std::map<std::string, double> values(const dts::v1::Sway& sway) {
  std::map<std::string, double> all;
  for (const dts::v1::SwayMeasure& measure : sway.measures()) all[measure.symbol()] = measure.value();
  return all;
}

session::SwayTrialResult standing() {
  session::SwayTrialResult result{.trial = 4,
                                  .attempt = 2,
                                  .condition = "eyes-open",
                                  .labels = {{"eyes", "open"}},
                                  .segment = 1,
                                  .first_scan = {100},
                                  .end_scan = {2100},
                                  .analysis = posturography::Analysis{}};
  result.analysis->rate_hz = 100.0;
  result.analysis->samples = 2000;
  result.analysis->duration_s = 20.0;
  result.analysis->flags = posturography::sway_flag::kShortForDiffusion;
  result.analysis->measures.set(posturography::Measure::MveloAp, 5.25);
  return result;
}

TEST(EncodeSway, RunningValuesArePreliminaryAndComplete) {
  core::SwayEvent event{.segment = 1, .scan = {1099}, .host_time_ns = 77, .first_scan = {100}, .trial = 3};
  event.values = {.samples = 1000, .rate_hz = 100.0, .rdist_mm = 5.0, .totex_mm = 82.0, .totex_ap_mm = 60.0, .pea95_f_mm2 = 223.0};
  const dts::v1::Event out = sway_event(42, event);
  EXPECT_EQ(out.scan(), 1099U);
  ASSERT_TRUE(out.has_sway());
  EXPECT_TRUE(out.sway().is_preliminary());
  EXPECT_EQ(out.sway().trial(), 3U);
  EXPECT_EQ(out.sway().end_scan(), 1100U);
  EXPECT_EQ(out.sway().duration_s(), 10.0);
  const auto told = values(out.sway());
  EXPECT_EQ(told.at("RDIST"), 5.0);
  EXPECT_EQ(told.at("MVELO"), 8.2);
  EXPECT_EQ(told.at("MVELO_AP"), 6.0);
  EXPECT_EQ(told.at("PEA95_F"), 223.0);
}

TEST(EncodeSway, OfNoSamplesThereAreNoValues) {
  const dts::v1::Event out = sway_event(42, {});
  EXPECT_EQ(out.sway().measures_size(), 0);
  EXPECT_EQ(out.sway().duration_s(), 0.0);
  core::SwayEvent odd{.values = {.samples = 5, .rate_hz = 100.0, .rdist_mm = std::nan("")}};
  for (const auto& [symbol, value] : values(sway_event(42, odd).sway())) EXPECT_TRUE(std::isfinite(value)) << symbol;
  EXPECT_FALSE(values(sway_event(42, odd).sway()).contains("RDIST"));
}

TEST(EncodeSway, FinalValuesSayWhereTheyAreFrom) {
  const dts::v1::Sway out = sway(standing(), "s1", "dtsd 1.0");
  EXPECT_FALSE(out.is_preliminary());
  EXPECT_EQ(out.session_id(), "s1");
  EXPECT_EQ(out.attempt(), 2U);
  EXPECT_EQ(out.labels().at("eyes"), "open");
  EXPECT_EQ(out.profile(), "lp10");
  EXPECT_EQ(out.samples(), 2000U);
  EXPECT_EQ(out.flags(), static_cast<std::uint32_t>(dts::v1::SWAY_FLAG_SHORT_FOR_DIFFUSION));
  EXPECT_TRUE(out.is_valid());
  EXPECT_EQ(out.software(), "dtsd 1.0");
  ASSERT_EQ(out.measures_size(), 1);
  EXPECT_EQ(out.measures(0).unit(), "mm/s");
}

TEST(EncodeSway, AProblemHasNoValues) {
  session::SwayTrialResult result = standing();
  result.analysis.reset();
  result.problem = "a gap";
  const dts::v1::Sway out = sway(result, "s1", "");
  EXPECT_EQ(out.problem(), "a gap");
  EXPECT_EQ(out.measures_size(), 0);
  EXPECT_FALSE(out.is_valid());
}

TEST(EncodeSway, TheCatalogueGivesTheSameBack) {
  record::SessionRow row{.id = "s1", .rig = "floor"};
  row.trials.push_back({.session_id = "s1", .trial = 4, .attempt = 2, .condition = "eyes-open", .outcome = "done"});
  row.trials[0].result = record::to_json(session::to_record(standing(), "dtsd 1.0"));
  const dts::v1::SessionRecord out = session_record(row);
  ASSERT_TRUE(out.trials(0).has_sway());
  EXPECT_FALSE(out.trials(0).has_result());
  EXPECT_EQ(out.trials(0).sway().SerializeAsString(), sway(standing(), "s1", "dtsd 1.0").SerializeAsString());
  row.trials[0].result = R"({"event":"sway","segment":0,"scan":0,"trial":4})";  // damaged
  EXPECT_FALSE(session_record(row).trials(0).has_sway());
}

}  // namespace
}  // namespace dts::ipc
