// SPDX-License-Identifier: Apache-2.0
#include "ctl/json_lines.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "unit/ctl/block_builder.h"

namespace dts::ctl {
namespace {

constexpr float kUndefined = std::numeric_limits<float>::quiet_NaN();

class JsonLinesTest : public ::testing::Test {
 protected:
  std::string line_of(const client::Block& block, std::size_t scans) {
    out_.str({});
    lines_.show(block, scans, {});
    return out_.str();
  }
  std::ostringstream out_;
  JsonLines lines_{out_};
};

TEST_F(JsonLinesTest, Block_HasExactlyTheShapeOfTheContract) {
  RecordProperty("requirement", "PUB-1");
  CopBlock cop({1.5F, -2.25F, 700.0F, kUndefined});
  cop.block.lost_scans = 12;
  cop.block.age_ns = 1'234'567;
  cop.block.host_time_uncertainty_ns = 800'000;
  cop.quality[1] = v1::QUALITY_NO_CONTACT | v1::QUALITY_UNTARED;

  EXPECT_EQ(line_of(cop.block, 2),
            R"({"topic":"floor/cop","rig":"floor","stream":"cop","segment":3,"first_scan":40,"rate_hz":100,"host_time_ns":123456789012,)"
            R"("host_time_uncertainty_ns":800000,"instance_id":18446744073709551615,"sequence":9,"lost_scans":12,"age_ms":1.235,)"
            R"("quality":{"load_n":["no_contact","untared"]},)"
            R"("channels":["ml_mm","load_n"],"units":["mm","N"],"values":[[1.5,700],[-2.25,null]]})"
            "\n");
}

TEST_F(JsonLinesTest, UnknownAgeAndGoodQuality_AreAbsentAndALeastLossIsMarked) {
  CopBlock cop({1.0F, 2.0F, 3.0F, 10.0F, 20.0F, 30.0F});

  const auto json = nlohmann::json::parse(line_of(cop.block, 2));

  for (const char* key : {"age_ms", "quality", "lost_scans_at_least"}) EXPECT_FALSE(json.contains(key)) << key;
  EXPECT_EQ(json.at("lost_scans"), 0);
  EXPECT_EQ(json.at("values"), nlohmann::json::parse("[[1,10],[2,20]]")) << "fewer scans asked for";
  cop.block.is_lost_exact = false;
  EXPECT_EQ(nlohmann::json::parse(line_of(cop.block, 1)).at("lost_scans_at_least"), true);
}

TEST_F(JsonLinesTest, Values_ReadBackAsTheSameFloatInTheFewestDigits) {
  for (const float value : {0.1F, 1.0F / 3.0F, 1e-30F, -3.4e38F, 16777216.0F, std::numeric_limits<float>::denorm_min(), -0.0F}) {
    const CopBlock cop({value, value});
    const auto json = nlohmann::json::parse(line_of(cop.block, 1));
    EXPECT_EQ(json.at("values").at(0).at(0).get<float>(), value);
  }
  EXPECT_NE(line_of(CopBlock({0.1F, 0.2F}).block, 1).find("[[0.1,0.2]]"), std::string::npos);
  EXPECT_NE(line_of(CopBlock({kUndefined, std::numeric_limits<float>::infinity()}).block, 1).find("[[null,null]]"), std::string::npos);
}

TEST_F(JsonLinesTest, AfterForget_NewFormatIsUsed) {
  CopBlock cop({1.0F, 2.0F});
  std::ignore = line_of(cop.block, 1);
  cop.format.channels[0].name = "renamed \"quoted\"";

  lines_.forget();

  EXPECT_EQ(nlohmann::json::parse(line_of(cop.block, 1)).at("channels").at(0), "renamed \"quoted\"");
}

TEST_F(JsonLinesTest, EventOfALaterVersionWithATopicThatIsNotUtf8_StillHasItsKind) {
  const v1::Event later;

  lines_.show(client::Event{.topic = "\xff/reach", .rig = "\xff", .kind = "reach", .body = &later});

  const auto json = nlohmann::json::parse(out_.str());
  EXPECT_EQ(json.at("event"), nlohmann::json::parse(R"({"kind":"reach"})"));
  EXPECT_FALSE(json.contains("host_time_ns"));
}

}  // namespace
}  // namespace dts::ctl
