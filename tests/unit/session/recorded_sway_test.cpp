// SPDX-License-Identifier: Apache-2.0
#include "session/recorded_sway.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "dts/wire/event_json.h"
#include "session/session_events.h"
#include "support/event_text.h"
#include "unit/record/xdf_fixture.h"

namespace dts::session {
namespace {

using test::event_of;
using ::testing::HasSubstr;

v1::Event step_at(TrialEventKind kind, std::uint32_t trial, std::uint64_t scan) {
  v1::Event event = to_event(TrialEvent{.kind = kind, .trial = trial, .condition = "eyes-open"}, "s1");
  event.set_scan(scan);
  return event;
}

/// "cop" at 100 Hz with its channels in another order, of scans at 1500 Hz. Sample `i` of a segment is (1000 * segment + i, -i, 600).
class Standing {
 public:
  Standing() {
    raw_ = writer_->add_stream(record::xdf_test::regular_stream("floor/raw", {"w1_v"}, record::xdf_test::rate_of(1500)));
    cop_ = writer_->add_stream(record::xdf_test::regular_stream("floor/cop", {"load_n", "ap_mm", "ml_mm"}, record::xdf_test::rate_of(100)));
    events_ = writer_->add_stream(record::xdf_test::events_stream());
  }
  void event(std::uint32_t segment, double time_s, v1::Event event) {
    event.set_segment(segment);
    const std::vector<std::pair<double, std::string>> texts{{time_s, wire::to_json(event)}};
    EXPECT_TRUE(writer_->write_texts(events_, texts, {.segment = segment, .first_scan = {event.scan()}}));
  }
  /// `is_there` says of each sample whether anybody stands.
  void samples(std::uint32_t segment, std::uint64_t first, double time_s, const std::vector<bool>& is_there) {
    const std::vector<double> raw{2.5};
    if (segment == 0 && first < 10) {
      EXPECT_TRUE(writer_->write_samples(raw_, time_s, raw, {.segment = 0, .first_scan = {15 * first}}));
    }
    std::vector<double> values;
    for (std::size_t i = 0; i < is_there.size(); ++i) {
      const double index = static_cast<double>(first + i);
      const double ml = is_there[i] ? 1000.0 * segment + index : std::nan("");
      values.insert(values.end(), {600.0, -index, ml});
    }
    EXPECT_TRUE(writer_->write_samples(cop_, time_s, values, {.segment = segment, .first_scan = {first}}));
  }
  RecordedStanding read() {
    EXPECT_TRUE(writer_->close());
    const auto recording = record::Recording::open(file_).value();
    std::vector<double> progress;
    auto standing = read_recorded_standing(*recording, [&](double part) { progress.push_back(part); });
    EXPECT_TRUE(standing) << standing.error().what;
    EXPECT_TRUE(std::ranges::is_sorted(progress));
    const std::size_t half = progress.size() / 2;  // it is read twice
    for (std::size_t item = 0; item < half; ++item) EXPECT_NEAR(progress[item + half], progress[item] + 0.5, 1e-12);
    EXPECT_GT(progress.front(), 0.0);
    EXPECT_GT(progress.back(), 0.9);
    EXPECT_LE(progress.back(), 1.0);
    EXPECT_EQ(standing->raw_rate_hz, 1500.0);
    return *standing;
  }

 private:
  record::xdf_test::Folder folder_;
  std::string file_ = folder_ / "a.xdf";
  std::unique_ptr<record::XdfWriter> writer_ = record::XdfWriter::create(file_, to_facts(record::xdf_test::floor_session())).value();
  std::uint32_t raw_ = 0;
  std::uint32_t cop_ = 0;
  std::uint32_t events_ = 0;
};

std::vector<double> counted(double first, std::size_t count) {
  std::vector<double> values(count);
  std::iota(values.begin(), values.end(), first);
  return values;
}

TEST(RecordedStanding, UndoneTrial_IsTheSameAsWithoutTheInterruption) {
  using enum TrialEventKind;
  Standing file;
  file.event(0, 1000.0, event_of("segment_start {}"));
  file.event(0, 1001.0, step_at(Measure, 7, 1500));
  file.event(0, 1002.0, step_at(Rejected, 7, 3000));
  file.event(0, 1004.0, step_at(Undone, 7, 6000));
  file.event(0, 1003.0, step_at(Done, 7, 4501));  // was due before the undo
  file.event(0, 1004.1, step_at(Rejected, 7, 6100));
  file.event(0, 1004.2, step_at(Undone, 7, 6200));
  file.samples(0, 0, 1000.0, std::vector<bool>(450, true));

  const RecordedStanding standing = file.read();

  ASSERT_EQ(standing.trials.size(), 1U);
  EXPECT_EQ(standing.trials[0].outcome, "done");
  EXPECT_EQ(standing.trials[0].end_scan.value, 4501U);
  EXPECT_EQ(standing.trials[0].cop.ml_mm, counted(100, 201));
}

TEST(RecordedStanding, TrialsHaveTheirSamplesAndWhatWasToldOfThem) {
  using enum TrialEventKind;
  Standing file;
  file.event(0, 1000.0, event_of("segment_start {}"));
  file.event(0, 1001.002, step_at(Measure, 7, 1500));  // an event's time is that of a raw scan
  file.event(0, 1003.0, step_at(Done, 7, 4501));       // sample 300 is the last
  file.event(0, 1003.5, step_at(Rejected, 7, 5250));   // void later, as long as it was
  file.event(0, 1003.6, step_at(Measure, 9, 5400));    // never ended
  file.event(0, 1003.7, step_at(Done, 0, 5500));
  file.event(0, 1004.0, step_at(Measure, 2, 6000));
  file.samples(0, 5, 1000.05, std::vector<bool>(200, true));
  file.samples(0, 205, 1002.05, std::vector<bool>(295, true));  // up to 500
  file.event(1, 1007.0, event_of("segment_start {}"));
  file.event(1, 1007.5, step_at(Done, 2, 750));
  SwayTrialResult published{.trial = 2, .condition = "eyes-open", .analysis = posturography::Analysis{}};
  published.analysis->rate_hz = published.analysis->duration_s = 100.0;
  published.analysis->samples = 100;
  published.analysis->flags = posturography::sway_flag::kDoubtful | posturography::sway_flag::kCutAtGap;
  file.event(1, 1007.6, to_event(published, "s1", "dtsd"));
  file.event(1, 1007.7, to_event(SessionFigure{.name = "a/RDIST", .value = 2.5, .unit = "mm", .details = "{}"}));
  file.event(1, 1007.8, event_of("figure { name: 'none' value: nan }"));
  file.samples(1, 0, 1007.0, std::vector<bool>(100, true));

  const RecordedStanding standing = file.read();

  ASSERT_EQ(standing.trials.size(), 2U);
  const StandingTrial& first = standing.trials[0];
  EXPECT_EQ(first.trial, 7U);
  EXPECT_EQ(first.outcome, "rejected");
  EXPECT_FALSE(first.counts());
  EXPECT_EQ(first.condition, "eyes-open");
  EXPECT_EQ(first.first_scan.value, 1500U);
  EXPECT_EQ(first.end_scan.value, 4501U);
  EXPECT_NEAR(first.begin_s, 1001.0, 1e-6);
  EXPECT_EQ(first.cop.rate_hz, 100.0);
  EXPECT_EQ(first.cop.ml_mm, counted(100, 201));
  EXPECT_EQ(first.cop.ap_mm[0], -100.0);
  EXPECT_EQ(first.cop.load_n, std::vector<double>(201, 600.0));
  EXPECT_FALSE(first.live);

  const StandingTrial& divided = standing.trials[1];
  EXPECT_EQ(divided.trial, 2U);
  EXPECT_TRUE(divided.counts());
  EXPECT_EQ(divided.segment, 0U);
  EXPECT_EQ(divided.end_segment, 1U);
  EXPECT_EQ(divided.end_scan.value, 750U);
  EXPECT_NEAR(divided.begin_s, 1004.0, 1e-6);
  ASSERT_EQ(divided.cop.ml_mm.size(), 350U) << "1 s, a gap of 2 s, 0.5 s";
  EXPECT_EQ(divided.cop.ml_mm[99], 499.0);
  EXPECT_TRUE(std::isnan(divided.cop.ml_mm[100]));
  EXPECT_TRUE(std::isnan(divided.cop.ml_mm[299]));
  EXPECT_EQ(divided.cop.ml_mm[300], 1000.0);
  EXPECT_EQ(divided.cop.ml_mm.back(), 1049.0);
  EXPECT_EQ(divided.cop.flags, posturography::sway_flag::kDoubtful);
  EXPECT_EQ(divided.live->condition, "eyes-open");

  ASSERT_EQ(standing.live_results.size(), 1U);
  const SessionFigure& figure = standing.live_results[0];
  EXPECT_EQ(figure.name + " " + std::to_string(figure.value) + " " + figure.unit + " " + figure.details, "a/RDIST 2.500000 mm {}");
}

/// As live: the analysis must see that the trial is shorter than it was.
TEST(RecordedStanding, EndThatWasNotRecorded_IsMissing) {
  using enum TrialEventKind;
  Standing file;
  file.event(0, 1000.0, event_of("segment_start {}"));
  file.event(0, 1001.0, step_at(Measure, 1, 1500));
  file.event(0, 1003.0, step_at(Done, 1, 4500));
  file.event(0, 1003.1, step_at(Measure, 2, 4650));
  file.event(0, 1004.0, step_at(Measure, 3, 6000));
  file.event(0, 1009.0, step_at(Done, 2, ~std::uint64_t{0} >> 2U));  // of a damaged file
  file.samples(0, 0, 1000.0, std::vector<bool>(280, true));
  file.samples(0, 300, 1003.0, std::vector<bool>(200, true));
  file.event(1, 1007.0, event_of("segment_start {}"));
  file.event(1, 1008.0, step_at(Done, 3, 1500));
  file.samples(1, 0, 1007.0, std::vector<bool>(60, true));

  const RecordedStanding standing = file.read();

  ASSERT_EQ(standing.trials.size(), 3U);
  const auto& of_one_segment = standing.trials[0].cop.ml_mm;
  ASSERT_EQ(of_one_segment.size(), 200U);
  EXPECT_EQ(of_one_segment[179], 279.0);
  EXPECT_TRUE(std::isnan(of_one_segment[180]));
  EXPECT_TRUE(std::isnan(of_one_segment.back()));
  EXPECT_THAT(standing.trials[1].problem, HasSubstr("samples, gaps included"));
  const auto& divided = standing.trials[2].cop.ml_mm;
  ASSERT_EQ(divided.size(), 400U) << "1 s, a gap of 2 s, 0.6 of 1 s";
  EXPECT_EQ(divided[359], 1059.0);
  EXPECT_TRUE(std::isnan(divided[360]));
  EXPECT_TRUE(std::isnan(divided.back()));
}

/// 1 s of stepping on, 0.5 s of stepping off and 10 s between are a stretch; holes of up to 0.05 s do not divide one.
TEST(RecordedStanding, WithoutTrials_EachStretchOf10SecondsIsOne) {
  std::vector<bool> there(3, false);
  const auto add = [&there](std::size_t count, bool is_there) { there.insert(there.end(), count, is_there); };
  add(600, true);
  add(5, false);
  add(540, true);  // with the hole before and the beginning of the next: exactly 1150
  add(6, false);
  add(1144, true);  // one too few
  add(20, false);
  add(500, true);
  Standing file;
  file.event(0, 1000.0, event_of("segment_start {}"));
  file.samples(0, 7, 1000.07, there);
  const std::uint64_t next = 7 + there.size();
  file.samples(0, next, 1000.0 + 0.01 * static_cast<double>(next), std::vector<bool>(649, true));  // 500 + 649: one too few
  file.event(1, 1200.0, event_of("segment_start {}"));
  file.samples(1, 0, 1200.0, std::vector<bool>(1160, true));

  const RecordedStanding standing = file.read();

  ASSERT_EQ(standing.trials.size(), 2U);
  const StandingTrial& held = standing.trials[0];
  EXPECT_EQ(held.trial, 0U);
  EXPECT_TRUE(held.counts());
  EXPECT_EQ(held.first_scan.value, (10U + 100U) * 15U);
  EXPECT_EQ(held.end_scan.value, (10U + 1100U) * 15U);
  ASSERT_EQ(held.cop.ml_mm.size(), 1000U);
  EXPECT_EQ(held.cop.ml_mm[0], 110.0);
  EXPECT_EQ(held.cop.ap_mm[0], -110.0);
  EXPECT_EQ(held.cop.load_n.size(), 1000U);
  EXPECT_EQ(std::ranges::count_if(held.cop.ml_mm, [](double value) { return std::isnan(value); }), 5);
  const StandingTrial& last = standing.trials[1];
  EXPECT_EQ(last.segment, 1U);
  EXPECT_EQ(last.end_segment, 1U);
  EXPECT_EQ(last.first_scan.value, 1500U);
  EXPECT_EQ(last.cop.ml_mm, counted(1100, 1010));
  EXPECT_EQ(last.cop.rate_hz, 100.0);
}

TEST(RecordedStanding, TrialWithAnOutageOfDays_HasAProblemOfItsOwn) {
  using namespace record::xdf_test;
  const Folder folder;
  auto writer = record::XdfWriter::create(folder / "a.xdf", to_facts(floor_session())).value();
  const auto cop = writer->add_stream(regular_stream("floor/cop", {"ml_mm", "ap_mm"}, rate_of(100)));
  const auto events = writer->add_stream(events_stream());
  const auto write = [&](std::uint32_t segment, double begin_s, std::vector<v1::Event> all) {
    std::vector<std::pair<double, std::string>> texts;
    for (v1::Event& event : all) {
      event.set_segment(segment);
      texts.emplace_back(begin_s + 0.01 * static_cast<double>(event.scan()), wire::to_json(event));
    }
    const record::XdfWriter::Position start{.segment = segment, .first_scan = {0}};
    EXPECT_TRUE(writer->write_texts(events, texts, start));
    EXPECT_TRUE(writer->write_samples(cop, begin_s, std::vector<double>(2000, 1.0), start));
  };
  using enum TrialEventKind;
  write(0, 1000.0, {event_of("segment_start {}"), step_at(Measure, 1, 100), step_at(Done, 1, 300), step_at(Measure, 2, 400)});
  write(1, 1'000'000.0, {event_of("segment_start {}"), step_at(Done, 2, 200), step_at(Measure, 3, 500), step_at(Done, 3, 800)});
  ASSERT_TRUE(writer->close());

  const auto recording = record::Recording::open(folder / "a.xdf").value();
  const auto standing = read_recorded_standing(*recording, [](double) {});

  ASSERT_TRUE(standing) << standing.error().what;
  ASSERT_EQ(standing->trials.size(), 3U);
  EXPECT_EQ(standing->trials[0].cop.ml_mm.size(), 200U);
  EXPECT_EQ(standing->trials[0].problem, "");
  EXPECT_THAT(standing->trials[1].problem, HasSubstr("more than 20000000 samples, gaps included"));
  EXPECT_TRUE(standing->trials[1].cop.ml_mm.empty());
  EXPECT_EQ(standing->trials[2].cop.ml_mm.size(), 300U);
  EXPECT_EQ(standing->trials[2].problem, "");
}

}  // namespace
}  // namespace dts::session
