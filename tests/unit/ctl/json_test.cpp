// SPDX-License-Identifier: Apache-2.0
#include "ctl/json.h"

#include <gtest/gtest.h>

#include "ctl/reading.h"
#include "ctl/recording_view.h"

namespace dts::ctl {
namespace {

TEST(EnumeratorWord, KnownAndUnknownNumbers) {
  EXPECT_EQ(enumerator_word(*v1::DeviceState_descriptor(), v1::DEVICE_STATE_STREAMING), "streaming");
  EXPECT_EQ(enumerator_word(*v1::GapReason_descriptor(), v1::GAP_REASON_RING_FULL), "ring_full");
  EXPECT_EQ(enumerator_word(*v1::ErrorCode_descriptor(), v1::ERROR_CODE_NOT_FOUND), "not_found");
  EXPECT_EQ(enumerator_word(*v1::DeviceState_descriptor(), 99), "unknown");
}

TEST(BitWords, OfALaterVersion_AreUnknown) {
  EXPECT_EQ(bit_words(*v1::ReachFlag_descriptor(), 1U | 1U << 31U), (std::vector<std::string>{"minor", "unknown"}));
}

TEST(QualityWords, EachBitIsAWord) {
  RecordProperty("requirement", "SIG-5");
  EXPECT_EQ(quality_words(0xff), (std::vector<std::string>{"rail", "stuck", "out_of_range", "rotation", "no_contact", "uncalibrated",
                                                           "untared", "substituted"}));
}

TEST(EventLine, OfALaterVersion_SaysSo) {
  const v1::Event unknown;
  const std::string line = event_line({.topic = "chair/new", .rig = "chair", .kind = "new", .body = &unknown});
  EXPECT_NE(line.find("(of a later version of dtsd)"), std::string::npos) << line;
}

TEST(BytesText, UnitsChangeAtThousands) {
  const std::vector<std::pair<std::uint64_t, std::string>> cases{
      {0, "0 B"}, {999, "999 B"}, {1000, "1.0 kB"}, {999'949, "999.9 kB"}, {999'950, "1.0 MB"}, {~std::uint64_t{0}, "18446744.1 TB"}};
  for (const auto& [bytes, text] : cases) EXPECT_EQ(bytes_text(bytes), text);
}

}  // namespace
}  // namespace dts::ctl
