// SPDX-License-Identifier: Apache-2.0
#include "session/recorded_sway.h"

#include <gmock/gmock.h>

#include "session/trial_record.h"
#include "unit/record/xdf_fixture.h"

namespace dts::session {
namespace {

using record::RecordedEvent;
using ::testing::HasSubstr;

RecordedEvent step_at(TrialEventKind kind, std::uint32_t trial, std::uint64_t scan) {
  RecordedEvent event = to_record(TrialEvent{.kind = kind, .trial = trial, .condition = "eyes-open"});
  event.scan = {scan};
  return event;
}

TEST(RecordedStanding, TrialWithAnOutageOfDays_HasAProblemOfItsOwn) {
  using namespace record::xdf_test;
  const Folder folder;
  auto writer = record::XdfWriter::create(folder / "a.xdf", to_facts(floor_session())).value();
  const auto cop = writer->add_stream(regular_stream("floor/cop", {"ml_mm", "ap_mm"}, rate_of(100)));
  const auto events = writer->add_stream(events_stream());
  const auto write = [&](std::uint32_t segment, double begin_s, std::vector<RecordedEvent> all) {
    std::vector<std::pair<double, std::string>> texts;
    for (RecordedEvent& event : all) {
      event.segment = segment;
      texts.emplace_back(begin_s + 0.01 * static_cast<double>(event.scan.value), record::to_json(event));
    }
    const record::XdfWriter::Position start{.segment = segment, .first_scan = {0}};
    EXPECT_TRUE(writer->write_texts(events, texts, start));
    EXPECT_TRUE(writer->write_samples(cop, begin_s, std::vector<double>(2000, 1.0), start));
  };
  using enum TrialEventKind;
  write(0, 1000.0, {{.event = "segment"}, step_at(Measure, 1, 100), step_at(Done, 1, 300), step_at(Measure, 2, 400)});
  write(1, 1'000'000.0, {{.event = "segment"}, step_at(Done, 2, 200), step_at(Measure, 3, 500), step_at(Done, 3, 800)});
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
