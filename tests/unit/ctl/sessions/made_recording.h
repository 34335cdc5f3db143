// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "record/session_facts.h"
#include "record/xdf/xdf_writer.h"

namespace dts::ctl {

/// How a recording made by a test ends.
enum class Ending { Closed, Incomplete, Killed };

/// 250 scans of two synthetic channels at 100 Hz, a marker and, if wanted, a gap, as dtsd records them. Returns the name of the file that
/// it left.
inline std::string make_recording(const std::string& name, Ending ending = Ending::Closed, std::uint32_t part = 1, bool has_gap = false) {
  record::SessionFacts facts;
  facts.session_id = "20261121T144525Z-floor-1";
  facts.part = part;
  facts.rig = "floor";
  facts.protocol = "free";
  facts.subject = "P017";
  facts.protocol_definition = "name = \"two\"\n[trials]\ntrials_per_block = 2\nduration_s = 1\n[[trials.condition]]\nname = \"a\"\n";
  auto writer = *record::XdfWriter::create(name, record::to_facts(facts));
  const std::uint32_t events = writer->add_stream(
      {.name = "floor/events", .content = "Markers", .value_type = record::ValueType::Text, .channels = {{.label = "event"}}});
  const std::uint32_t raw = writer->add_stream({.name = "floor/raw",
                                                .content = "DTS",
                                                .rate = *core::Rate::create(100, 1),
                                                .channels = {{.label = "w1_v", .unit = "V"}, {.label = "w2_v", .unit = "V"}}});
  const auto tell = [&](double time_s, const std::string& event) {
    const std::vector<std::pair<double, std::string>> texts{{time_s, event}};
    EXPECT_TRUE(writer->write_texts(events, texts, {}).has_value());
  };
  tell(10.0, R"({"host_time_ns":"10000000000","segment_start":{}})");
  for (std::uint64_t block = 0; block < 5; ++block) {
    const std::vector<double> values(100, static_cast<double>(block) + 0.5);
    EXPECT_TRUE(writer->write_samples(raw, 10.0 + 0.5 * static_cast<double>(block), values, {.first_scan = {block * 50}}).has_value());
  }
  for (const std::string step : {"MEASURE", "DONE"}) {
    tell(11.0, R"({"scan":"100","trial":{"step":"TRIAL_EVENT_KIND_)" + step + R"(","trial":1,"attempt":1,"condition":"a"}})");
  }
  tell(12.0, R"({"scan":"200","marker":{"text":"eyes closed"}})");
  if (has_gap) {
    tell(12.2, R"({"segment":1,"segment_start":{"reason":"GAP_REASON_OVERRUN","missing_scans":"7"}})");
  }
  EXPECT_TRUE(writer->synchronise().has_value());
  if (ending == Ending::Killed) {
    writer->abandon();
    return name + ".part";
  }
  const auto closed = ending == Ending::Closed ? writer->close() : writer->close_incomplete("disk full");
  EXPECT_TRUE(closed.has_value());
  return closed->file;
}

}  // namespace dts::ctl
