// SPDX-License-Identifier: Apache-2.0
// What is sent of a recording: the same numbers, without the texts that people typed.
#include "fleet/forward/sent_bytes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "dts/wire/event_json.h"
#include "fleet/wire/messages.h"
#include "record/recording.h"
#include "record/session_facts.h"
#include "record/sha256.h"
#include "record/xdf/recovery.h"
#include "record/xdf/xdf_writer.h"
#include "support/temporary_folder.h"
#include "unit/fleet/canary.h"

namespace dts::fleet::forward {
namespace {

std::string content_of(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

class SentBytesTest : public testing::Test {
 protected:
  /// A recording of two streams; texts have canaries, the label has characters that XML escapes.
  std::string record(const std::string& reason = {}) {
    record::SessionFacts facts{.session_id = "s-1", .rig = "floor", .kind = "floor", .protocol = "free", .subject = "P017"};
    facts.label = "canary-label <&\"'> \r\xC3\xBC";
    facts.fields = {{"weight_kg", "canary-weight"}, {"arm_length_cm", "canary-arm"}};
    facts.rig_definition = "name = \"floor\"\n[plate]\n";
    auto pairs = record::to_facts(facts);
    pairs.emplace_back("a_new_fact", "canary-new");
    const std::string name = folder_.path() + "/s-1.xdf";
    auto writer = record::XdfWriter::create(name, pairs).value();
    const auto raw = writer->add_stream({.name = "floor/raw",
                                         .content = "DTS",
                                         .rate = core::Rate::create(1000, 1).value(),
                                         .channels = {{.label = "w1_v", .unit = "V"}},
                                         .facts = {{"stage_state", "1 2 3"}, {"remark", "canary-remark"}}});
    const auto events = writer->add_stream(
        {.name = "floor/events", .content = "Markers", .value_type = record::ValueType::Text, .channels = {{.label = "event"}}});
    v1::Event marker;
    marker.set_scan(7);
    marker.mutable_marker()->set_text("canary-marker");
    for (int block = 0; block < 50; ++block) {
      std::vector<double> values(200);
      for (std::size_t scan = 0; scan < values.size(); ++scan) values[scan] = block + static_cast<double>(scan) / 1024.0;
      EXPECT_TRUE(writer->write_samples(raw, 1.0 + 0.2 * block, values, {}));
      const std::vector<std::pair<double, std::string>> texts{{1.0 + block, dts::wire::to_json(marker)},
                                                              {1.1 + block, "canary-plain text"}};
      EXPECT_TRUE(writer->write_texts(events, texts, {}));
      EXPECT_TRUE(writer->write_boundary());
      EXPECT_TRUE(writer->write_clock_offset(raw, 1.0 + 0.2 * block, 1e-6));
    }
    return (reason.empty() ? writer->close() : writer->close_incomplete(reason)).value().file;
  }
  [[nodiscard]] std::string sent(const std::string& file, const wire::SendRules& rules = {}) const {
    auto bytes = SentBytes::open(file, rules).value();
    return bytes.read(0, bytes.size()).value();
  }
  /// Writes what was sent to a file, as the centre does.
  [[nodiscard]] std::string at_the_centre(const std::string& bytes) const {
    const std::string file = folder_.path() + "/centre.xdf";
    std::ofstream(file, std::ios::binary) << bytes;
    return file;
  }

  test::TemporaryFolder folder_;
};

TEST_F(SentBytesTest, RecordingWithCanaries_NoneLeaves) {
  RecordProperty("requirement", "FLEET-2");
  const std::string file = record("canary-reason");
  const std::string bytes = sent(file);
  EXPECT_EQ(bytes.size(), content_of(file).size());
  EXPECT_THAT(canaries_in(bytes), testing::IsEmpty());
  EXPECT_THAT(canaries_in(content_of(file)), testing::SizeIs(8));  // so that the line above has something to find
}

TEST_F(SentBytesTest, WhatIsAllowed_Leaves) {
  const std::string bytes = sent(record("canary-reason"), {.labels = true, .fields = {"weight_kg"}});
  EXPECT_THAT(canaries_in(bytes), testing::UnorderedElementsAre("canary-label", "canary-marker", "canary-reason", "canary-weight"));
}

TEST_F(SentBytesTest, SentRecording_IsWholeAndHasTheSameNumbers) {
  const std::string file = record();
  const std::string copy = at_the_centre(sent(file));
  const auto verified = record::verify(copy);
  ASSERT_TRUE(verified) << core::to_string(verified.error());
  EXPECT_TRUE(verified->is_closed);
  const auto original = record::Recording::open(file).value();
  const auto received = record::Recording::open(copy).value();
  ASSERT_EQ(original->streams().size(), received->streams().size());
  for (std::size_t stream = 0; stream < original->streams().size(); ++stream) {
    auto expected = original->streams()[stream];
    for (auto& [name, value] : expected.facts) {
      if (name == "remark") value.assign(value.size(), '#');
    }
    EXPECT_EQ(received->streams()[stream], expected);
  }
  EXPECT_EQ(received->session()->subject, "P017");
  EXPECT_EQ(received->session()->rig_definition, original->session()->rig_definition);
  EXPECT_NE(received->session()->label, original->session()->label);
  std::size_t scans = 0;
  for (auto item = original->next().value(); item; item = original->next().value()) {
    const auto other = received->next().value();
    ASSERT_TRUE(other);
    if (const auto* values = std::get_if<record::RecordedScans>(&*item)) {
      EXPECT_EQ(values->values, std::get<record::RecordedScans>(*other).values);
      EXPECT_EQ(values->first_time_s, std::get<record::RecordedScans>(*other).first_time_s);
      scans += values->count;
    }
  }
  EXPECT_EQ(scans, 10'000U);
}

TEST_F(SentBytesTest, AnyOffsetAndCount_AreTheSameBytes) {
  const std::string file = record();
  const std::string whole = sent(file);
  auto bytes = SentBytes::open(file, {}).value();
  std::string joined;
  while (joined.size() < whole.size()) joined += bytes.read(joined.size(), 777).value();
  EXPECT_EQ(joined, whole);
  for (const std::uint64_t offset : {whole.size() - 10, std::size_t{0}, std::size_t{3}, std::size_t{70'001}, std::size_t{4'096}}) {
    EXPECT_EQ(bytes.read(offset, 5'000).value(), whole.substr(offset, 5'000)) << offset;
  }
  EXPECT_EQ(bytes.read(whole.size(), 10).value(), "");
}

TEST_F(SentBytesTest, Hashes_AreThoseOfTheFileAndOfTheSentBytes) {
  const std::string file = record();
  const auto hashes = hashes_of(file, {}, {}).value();
  EXPECT_EQ(wire::hex_of(hashes.recorded_sha256), record::sha256_of(content_of(file)));
  EXPECT_EQ(wire::hex_of(hashes.sent_sha256), record::sha256_of(sent(file)));
  EXPECT_NE(hashes.sent_sha256, hashes.recorded_sha256);
  EXPECT_EQ(hashes.bytes, content_of(file).size());
}

TEST_F(SentBytesTest, StopWhileReading_Fails) {
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(hashes_of(record(), {}, stop.get_token()).error().code, core::ErrorCode::Failed);
}

TEST_F(SentBytesTest, ChunkThatDtsdDoesNotWrite_IsDamaged) {
  const std::string file = record();
  const std::string whole = content_of(file);
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = whole;
    text.replace(text.find(from), from.size(), to);
    return hashes_of(at_the_centre(text), {}, {});
  };
  EXPECT_EQ(changed("<desc>", "<dexx>").error().code, core::ErrorCode::DataDamaged);
  EXPECT_EQ(changed("<fact name=\"rig\">floor</fact>", "<fact name=\"rig\"><!---></fact>").error().code, core::ErrorCode::DataDamaged);
  EXPECT_EQ(changed("<fact name=\"rig\">", "<fact  name=\"ri\">").error().code, core::ErrorCode::DataDamaged);
  std::string unknown = whole;
  unknown.append("\x01\x07\x63\x00Ann W", 9);  // tag 99
  EXPECT_EQ(hashes_of(at_the_centre(unknown), {}, {}).error().code, core::ErrorCode::DataDamaged);
  EXPECT_EQ(hashes_of(at_the_centre(whole.substr(0, whole.size() - 5)), {}, {}).error().code, core::ErrorCode::DataDamaged);
}

TEST(SentBytes, RecordingsOfVersion01_CanBeSent) {
  for (const auto& entry : std::filesystem::directory_iterator(std::string(DTS_SOURCE_DIR) + "/tests/unit/record/recordings_0_1")) {
    if (entry.path().extension() != ".xdf") continue;
    EXPECT_TRUE(hashes_of(entry.path(), {}, {})) << entry.path();
  }
}

}  // namespace
}  // namespace dts::fleet::forward
