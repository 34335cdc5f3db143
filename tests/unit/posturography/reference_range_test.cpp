// SPDX-License-Identifier: Apache-2.0
#include "posturography/reference_range.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace dts::posturography {
namespace {

TEST(ReferenceRange, EachSaysWhoWasMeasuredHowAndByWhom) {
  RecordProperty("requirement", "SWAY-7");
  std::set<std::string_view> ids;
  for (const ReferenceProtocol& protocol : reference_protocols()) {
    EXPECT_TRUE(ids.insert(protocol.id).second) << protocol.id;
    EXPECT_NE(protocol.people.find("people"), std::string_view::npos);
    EXPECT_NE(protocol.protocol.find("profile asis"), std::string_view::npos);
    EXPECT_NE(protocol.source.find("Santos & Duarte 2016"), std::string_view::npos);
    EXPECT_NE(protocol.source.find("CC BY 4.0"), std::string_view::npos);
    EXPECT_EQ(protocol.duration_s, 60.0);
    EXPECT_NE(protocol.protocol.find("eyes " + std::string(protocol.eyes)), std::string_view::npos);
    EXPECT_NE(protocol.protocol.find(protocol.surface), std::string_view::npos);
    if (protocol.id.find("60plus") == std::string_view::npos) continue;
    EXPECT_NE(protocol.people.find("aged 60 or more, illness allowed"), std::string_view::npos);
    EXPECT_NE(protocol.people.find("not a norm of healthy elderly"), std::string_view::npos);
  }
  EXPECT_EQ(ids.size(), 5U);
}

TEST(ReferenceRange, MedianLiesWithin) {
  std::size_t ranges = 0;
  for (const ReferenceProtocol& protocol : reference_protocols()) {
    for (std::size_t index = 0; index < kMeasureCount; ++index) {
      const auto range = reference_range(protocol, static_cast<Measure>(index));
      if (!range) continue;
      ++ranges;
      EXPECT_GT(range->low, 0.0) << protocol.id << ' ' << info(static_cast<Measure>(index)).symbol;
      EXPECT_LT(range->low, range->median) << protocol.id << ' ' << info(static_cast<Measure>(index)).symbol;
      EXPECT_LT(range->median, range->high) << protocol.id << ' ' << info(static_cast<Measure>(index)).symbol;
    }
  }
  EXPECT_EQ(ranges, 5U * 16U);
}

TEST(ReferenceRange, ValuesOfTheSheet) {
  const auto protocols = reference_protocols();
  const auto young = reference_range(protocols[0], Measure::Mvelo);
  const auto foam = reference_range(protocols[2], Measure::AreaSw);
  const auto old = reference_range(protocols[4], Measure::SdaHsAp);

  ASSERT_TRUE(young && foam && old);
  EXPECT_EQ(young->median, 8.64);
  EXPECT_EQ(young->low, 5.76);
  EXPECT_EQ(young->high, 14.9);
  EXPECT_EQ(foam->median, 110.0);
  EXPECT_EQ(old->high, 0.90);
  EXPECT_FALSE(reference_range(protocols[0], Measure::HcSd));
  EXPECT_FALSE(reference_range(ReferenceProtocol{.id = "somebody else"}, Measure::Mvelo));
}

}  // namespace
}  // namespace dts::posturography
