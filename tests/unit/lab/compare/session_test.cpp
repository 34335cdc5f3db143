// SPDX-License-Identifier: Apache-2.0
// Recordings of two rigs of one session: found by the session's ID, read, aligned, reported.
#include <cmath>
#include <cstdlib>

#include "dts/wire/event_json.h"
#include "record/session_facts.h"
#include "record/xdf/xdf_writer.h"
#include "support/event_text.h"
#include "unit/lab/compare/made_recordings.h"
#include "unit/lab/run_fixture.h"

namespace dts::lab::compare {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr double kRateHz = 100.0;

/// How a rig records the same movement.
struct Part {
  std::uint32_t number = 1;
  std::string rig = "floor";
  std::uint32_t leading = 1;
  double begins_s = 1000.0;  ///< On the computer's clock, and true time.
  double drift_ppm = 0.0;    ///< The device's clock is so much slow: its time stamps fall behind.
  double delay_s = 0.0;      ///< Of the filters before "cop".
  double gap_from_s = 1e9;   ///< After the beginning; 5 s long. The time stamps jump there by 80 ms.
  std::string boot = "boot-1";
  int lost_pulse = -1;
  std::string session = "s1";
  std::string definition{};  ///< With the channel of the trigger, its level is read from "aux"; without, its events count.
};

class CompareSession : public RunTest {
 protected:
  CompareSession() { ::setenv("DTSD_STATE_DIR", path("").c_str(), 1); }
  ~CompareSession() override { ::unsetenv("DTSD_STATE_DIR"); }

  std::string record(const std::string& name, const Part& part, double length_s = 60.0) const {
    record::SessionFacts facts{.session_id = part.session, .part = part.number, .rig = part.rig, .rigs = {"floor", "plate", "third"}};
    facts.leading_part = part.leading == part.number ? 0 : part.leading;
    facts.kind = "floor";
    facts.protocol = "free";
    facts.boot_id = part.boot;
    facts.device_uri = "sim:floor";
    facts.rig_definition = part.definition;
    auto created = record::XdfWriter::create(path(name), record::to_facts(facts));
    EXPECT_TRUE(created);
    record::XdfWriter& xdf = **created;
    const auto rate = core::Rate::create(100, 1).value();
    const auto raw =
        xdf.add_stream({.name = part.rig + "/raw", .content = "DTS", .rate = rate, .channels = {{.label = "w1_v", .unit = "V"}}});
    const auto cop = xdf.add_stream({.name = part.rig + "/cop",
                                     .content = "DTS",
                                     .rate = rate,
                                     .channels = {{.label = "ml_mm", .unit = "mm"}, {.label = "ap_mm", .unit = "mm"}},
                                     .delay_ns = static_cast<std::int64_t>(part.delay_s * 1e9)});
    const auto aux = xdf.add_stream(
        {.name = part.rig + "/aux",
         .content = "DTS",
         .rate = rate,
         .channels = {{.label = "other", .unit = "V", .device_channel = 1}, {.label = "sync", .unit = "V", .device_channel = 4}}});
    const auto events = xdf.add_stream(
        {.name = part.rig + "/events", .content = "Markers", .value_type = record::ValueType::Text, .channels = {{.label = "event"}}});
    const auto tell = [&](double time_s, const std::string& text) {
      const v1::Event event = test::event_of(text);
      const std::vector<std::pair<double, std::string>> texts{{time_s, wire::to_json(event)}};
      EXPECT_TRUE(xdf.write_texts(events, texts, {.segment = event.segment(), .first_scan = {event.scan()}}));
    };
    const double factor = 1.0 + 1e-6 * part.drift_ppm;
    const auto write = [&](double from_s, double to_s, double stamp_s, std::uint32_t segment) {
      const auto count = static_cast<std::size_t>((to_s - from_s) * kRateHz);
      tell(stamp_s, "segment: " + std::to_string(segment) + " segment_start { reason: GAP_REASON_OVERRUN missing_scans: 1 }");
      std::vector<double> values;
      for (std::size_t k = 0; k < count; ++k) {
        const double true_s = part.begins_s + (from_s + static_cast<double>(k) / kRateHz) * factor - part.delay_s;
        values.push_back(sway(true_s, 0.3));
        values.push_back(sway(true_s, 0.8));
      }
      EXPECT_TRUE(xdf.write_samples(raw, stamp_s, std::vector<double>(count, 1.5), {.segment = segment}));
      EXPECT_TRUE(xdf.write_samples(cop, stamp_s, values, {.segment = segment}));
      std::vector<double> levels;
      for (std::size_t k = 0; k < count; ++k) {  // a pulse needs 40 ms to rise
        const double true_s = part.begins_s + (from_s + static_cast<double>(k) / kRateHz) * factor;
        const double since_s = std::fmod(true_s - 1000.68, 1.013);
        const bool is_lost = static_cast<int>((true_s - 1000.68) / 1.013) == part.lost_pulse;
        levels.push_back(7.0);
        levels.push_back(true_s < 1000.68 || is_lost || since_s > 0.2 ? 0.0 : 5.0 * std::min(1.0, since_s / 0.04));
      }
      EXPECT_TRUE(xdf.write_samples(aux, stamp_s, levels, {.segment = segment}));
      int pulse = 0;
      for (double at_s = 1000.7; at_s < part.begins_s + to_s * factor; at_s += 1.013, ++pulse) {
        const double device_s = (at_s - part.begins_s) / factor;
        if (device_s < from_s || pulse == part.lost_pulse) continue;
        const double scan = std::ceil((device_s - from_s) * kRateHz);
        if (scan >= static_cast<double>(count)) continue;
        tell(stamp_s + scan / kRateHz, "segment: " + std::to_string(segment) + " scan: " + std::to_string(static_cast<int>(scan)) +
                                           " trigger { edge: TRIGGER_EDGE_RISING channel: 'sync' }");
      }
    };
    const double first_to_s = std::min(length_s, part.gap_from_s);
    write(0.0, first_to_s, part.begins_s, 0);
    if (first_to_s < length_s) write(first_to_s + 5.0, length_s, part.begins_s + first_to_s + 5.08, 1);
    EXPECT_TRUE(xdf.close());
    return path(name);
  }
};

TEST_F(CompareSession, BothRigsOfASession_AreAlignedByTheirPulses) {
  record("floor.xdf", {});
  record("plate.xdf", {.number = 2, .rig = "plate", .begins_s = 1000.2, .drift_ppm = 100.0, .delay_s = 0.03, .lost_pulse = 20});
  record("another.xdf", {.session = "s2"});

  ASSERT_EQ(run_with({"compare", "--session", "s1", "--json"}), cli::kOk) << talk();

  const auto aligned = json().at("alignment");
  EXPECT_EQ(aligned.at("by"), "pulse train");
  EXPECT_NEAR(aligned.at("period_s").get<double>(), 1.013, 0.001);
  // The first scan of B is at true time 1000.2 and its time stamp is right; in the middle the stamps are 3 ms behind.
  EXPECT_NEAR(aligned.at("offset_s").get<double>(), 0.003, 0.002);
  EXPECT_NEAR(aligned.at("reference_s").get<double>(), 1030.2, 1.0);
  EXPECT_NEAR(aligned.at("filter_delay_b_s").get<double>(), 0.03, 1e-9);
  EXPECT_GT(aligned.at("end_sd_s").get<double>(), aligned.at("offset_sd_s").get<double>());
  ASSERT_EQ(aligned.at("faults").size(), 1U);
  EXPECT_EQ(aligned.at("faults")[0].at("recording"), "B");
  EXPECT_EQ(aligned.at("faults")[0].at("fault"), "lost");
  EXPECT_NEAR(aligned.at("faults")[0].at("time_s").get<double>(), 1000.7 + 20 * 1.013, 0.011);
  EXPECT_LT(json().at("rmse_total_mm").get<double>(), 0.2) << "the delay of the filters is removed";
  EXPECT_THAT(talk(), HasSubstr("B lost the pulse at 1020.9"));

  ASSERT_EQ(run_with({"compare", "--session", "s1"}), cli::kOk);
  EXPECT_THAT(out(), HasSubstr("aligned by pulse train (58 pulses, one per 1.013 s): add 0.003"));
  EXPECT_THAT(out(), HasSubstr("LIMITS OF AGREEMENT"));
}

TEST_F(CompareSession, ARecordedTriggerChannelThatRisesSlowly_IsBetterThanItsEvents) {
  const std::string definition = "[trigger]\nchannel = 4\n";
  const std::string a = record("floor.xdf", {.definition = definition});
  const std::string b =
      record("plate.xdf", {.number = 2, .rig = "plate", .begins_s = 1000.2, .drift_ppm = 100.0, .definition = definition});

  ASSERT_EQ(run_with({"compare", a, b, "--json"}), cli::kOk) << talk();

  const auto aligned = json().at("alignment");
  EXPECT_EQ(aligned.at("by"), "pulse train");
  EXPECT_NEAR(aligned.at("drift_ppm").get<double>(), 100.0, 10.0);
  EXPECT_LT(aligned.at("end_sd_s").get<double>(), 0.5e-3);
  EXPECT_THAT(aligned.at("faults"), IsEmpty());
}

TEST_F(CompareSession, ASegmentWithAnotherTimeBase_HasItsOwnOffset) {
  const std::string a = record("floor.xdf", {}, 120.0);
  const std::string b = record("plate.xdf", {.number = 2, .rig = "plate", .gap_from_s = 50.0}, 120.0);

  ASSERT_EQ(run_with({"compare", a, b, "--json"}), cli::kOk) << talk();

  const auto pieces = json().at("alignment").at("pieces");
  ASSERT_EQ(pieces.size(), 2U);
  EXPECT_NEAR(pieces[0].at("shift_s").get<double>() - pieces[1].at("shift_s").get<double>(), 0.08, 0.01);
  EXPECT_NEAR(pieces[1].at("from_s").get<double>(), 1055.08, 1e-6);
  EXPECT_LT(json().at("rmse_total_mm").get<double>(), 0.3);
  EXPECT_THAT(talk(), Not(HasSubstr("lost")));

  ASSERT_EQ(run_with({"compare", a, b, "--report", path("pieces.html")}), cli::kOk) << talk();
  EXPECT_THAT(out(), HasSubstr("2 pieces, offsets from "));
  EXPECT_THAT(content("pieces.html"), HasSubstr("2 pieces, offsets from "));
  EXPECT_THAT(content("pieces.html"), Not(HasSubstr("positive to the right"))) << "a CSV file does not say so";
}

TEST_F(CompareSession, ATriggerLevelThatTheSignalDoesNotReach_KeepsTheEventsOfTheRecording) {
  const std::string definition = "[trigger]\nchannel = 4\nlevel = 9.0\n";
  const std::string a = record("floor.xdf", {.definition = definition});
  const std::string b = record("plate.xdf", {.number = 2, .rig = "plate", .begins_s = 1000.2, .definition = definition});

  ASSERT_EQ(run_with({"compare", a, b, "--json"}), cli::kOk) << talk();

  EXPECT_EQ(json().at("alignment").at("by"), "pulse train");
  EXPECT_GT(json().at("alignment").at("events").get<int>(), 50);
}

TEST_F(CompareSession, ASessionThatIsNoPair_IsRefusedWithWhatToDo) {
  record("floor.xdf", {});
  EXPECT_THAT(refusal_of({"compare", "--session", "s1"}), HasSubstr("session 's1' has the recording of one rig only: floor.xdf"));
  record("plate.xdf", {.number = 2, .rig = "plate"});
  record("floor-3.xdf", {.number = 3, .leading = 3, .begins_s = 2000.0});
  record("plate-4.xdf", {.number = 4, .rig = "plate", .leading = 3, .begins_s = 2000.0});
  EXPECT_THAT(refusal_of({"compare", "--session", "s1"}), HasSubstr("its leading rig has the parts 1, 3"));
  EXPECT_THAT(refusal_of({"compare", "--session", "s1", "--part", "2"}), HasSubstr("has no part 2"));
  EXPECT_EQ(run_with({"compare", "--session", "s1", "--part", "3"}), cli::kOk) << talk();
  record("third.xdf", {.number = 5, .rig = "third"});
  EXPECT_THAT(refusal_of({"compare", "--session", "s1", "--part", "1"}), HasSubstr("has 3 rigs: floor (floor.xdf), plate (plate.xdf)"));
  EXPECT_THAT(refusal_of({"compare", "--session", "s9"}), HasSubstr("set DTSD_STATE_DIR"));
  EXPECT_THAT(refusal_of({"compare", "--session", "s1", "a.csv", "b.csv"}), HasSubstr("needs two recordings, or the session"));
  EXPECT_THAT(refusal_of({"compare", "a.csv"}), HasSubstr("needs two recordings, or the session"));
}

TEST_F(CompareSession, ReportAndPictures_HaveValuesAndBothAxes) {
  record("floor.xdf", {});
  record("plate.xdf", {.number = 2, .rig = "plate", .begins_s = 1000.2, .lost_pulse = 20});

  ASSERT_EQ(run_with({"compare", "--session", "s1", "--report", path("pair.html"), "--plot", path("pair.svg")}), cli::kOk) << talk();

  const std::string page = content("pair.html");
  for (const char* text :
       {"floor and plate", "Bias, B - A", "Upper limit of agreement", "RMSE, means removed", "pulse train", "ML (x): both recordings",
        "AP (y): Bland-Altman", "Methods, for a paper", "B lost the pulse at", "No person was measured"}) {
    EXPECT_THAT(page, HasSubstr(text));
  }
  EXPECT_THAT(page, Not(HasSubstr(path("")))) << "no folder names";
  EXPECT_THAT(page, Not(HasSubstr("nan")));
  const std::string pictures = content("pair.svg");
  EXPECT_THAT(pictures, HasSubstr("<svg"));
  EXPECT_THAT(pictures, HasSubstr("AP (y): Bland-Altman"));
  ASSERT_EQ(run_with({"compare", "--session", "s1", "--report", path("again.html")}), cli::kOk);
  EXPECT_EQ(content("again.html"), page);

  EXPECT_THAT(refusal_of({"compare", "--session", "s1", "--report", "pair.txt"}), HasSubstr("use a name that ends in .html"));
  EXPECT_THAT(refusal_of({"compare", "--session", "s1", "--plot", "pair.png"}), HasSubstr("use a name that ends in .svg"));
}

}  // namespace
}  // namespace dts::lab::compare
