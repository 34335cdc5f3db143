// SPDX-License-Identifier: Apache-2.0
// Exactly what is said of a movement without noise, and when: reach-model section 5.
#include <gtest/gtest.h>

#include <sstream>

#include "core/special_numbers.h"
#include "unit/pipeline/chair_chain.h"

namespace dts::pipeline {
namespace {

using core::kNaN;
using core::ReachStep;
using core::quality::kSubstituted;
using core::quality::kUncalibrated;
using core::quality::kUntared;

/// Moves evenly to `mm` within `seconds`; NaN: the sensors are silent.
struct Move {
  double seconds;
  double mm;
  std::uint8_t bits = 0;
};

/// At 100 Hz. Rest is at 3.7 mm: its threshold is 0.0444 mm.
Signal transient_of_moves(const std::vector<Move>& moves) {
  std::vector<std::vector<double>> columns(3);
  std::vector<std::uint8_t> bits;
  double from_mm = moves.front().mm;
  for (const Move& move : moves) {
    const auto scans = static_cast<std::size_t>(move.seconds * 100.0 + 0.5);
    for (std::size_t i = 1; i <= scans; ++i) {
      columns[0].push_back(from_mm + (move.mm - from_mm) * static_cast<double>(i) / static_cast<double>(scans));
      columns[1].push_back(-0.2 + 0.07 * std::max(0.0, columns[0].back() - 3.7));
      columns[2].push_back(0.01);
      bits.push_back(move.bits);
    }
    if (std::isfinite(move.mm)) from_mm = move.mm;
  }
  Signal signal = make_signal(100.0, "mm", columns);
  signal.format.channels = {{.name = "transient_mm", .unit = "mm"}, {.name = "ratio", .unit = "1"}, {.name = "twist", .unit = "1"}};
  signal.bits = {bits, bits, bits};
  return signal;
}

/// Each event as "step@scan", then the scan of its point; of a Final those of P1, P2, P3, how often it was resumed, and its flags.
std::string text_of(const std::vector<core::ReachEvent>& events) {
  std::ostringstream text;
  for (const core::ReachEvent& event : events) {
    switch (event.step) {
      case ReachStep::P1: text << "P1@" << event.scan.value << ' ' << event.p1.scan.value; break;
      case ReachStep::P2: text << "P2@" << event.scan.value << ' ' << event.p2.scan.value; break;
      case ReachStep::P3: text << "P3@" << event.scan.value << ' ' << event.p3.scan.value; break;
      case ReachStep::Final:
        text << "Final@" << event.scan.value << ' ' << event.p1.scan.value << ' ' << event.p2.scan.value << ' ' << event.p3.scan.value
             << (event.resumed > 0 ? " resumed " + std::to_string(event.resumed) : "");
        break;
      case ReachStep::Cancelled: text << "Cancelled@" << event.scan.value; break;
    }
    const bool has_ended = event.step == ReachStep::Final || event.step == ReachStep::Cancelled;
    text << (has_ended && event.flags != 0 ? " flags " + std::to_string(event.flags) : "") << "; ";
  }
  return text.str();
}

struct Story {
  const char* name;
  std::vector<Move> moves;
  const char* expected;
};

const Move kRest{1.0, 3.7};
const Move kDip{0.2, 3.4};
const Move kRise{0.5, 5.2};
const Move kBack{0.5, 3.7};

void expect_told(const std::vector<Story>& stories) {
  for (const Story& story : stories) EXPECT_EQ(text_of(reaches_of(transient_of_moves(story.moves))), story.expected) << story.name;
}

TEST(ReachStory, DipAndRise_AreToldInTime) {
  expect_told({
      {"dip, rise, back", {kRest, kDip, kRise, {0.2, 5.2}, kBack, kRest}, "P1@109 98; P2@123 118; P3@176 171; Final@206 99 118 171; "},
      {"rise alone", {kRest, kRise, {0.2, 5.2}, kBack, kRest}, "P1@108 98; P2@108 98; P3@156 151; Final@184 98 98 151 flags 1024; "},
      {"rise to twice a minor one",
       {kRest, {0.3, 4.0}, {0.3, 3.7}, kRest},
       "P1@111 99; P2@111 99; P3@134 129; Final@140 99 99 129 flags 1024; "},
      {"dip that stops, goes on by less and by more than 0.3 thresholds",
       {kRest, kDip, {0.2, 3.4}, {0.1, 3.388}, {0.2, 3.388}, {0.1, 3.37}, {0.2, 3.37}, kRise, kBack, kRest},
       "P1@109 98; P2@126 121; P2@186 181; P3@254 249; Final@268 99 181 249; "},
      {"rise that stops, goes on by less and by more than half a percent",
       {kRest, kRise, {0.2, 5.2}, {0.1, 5.205}, {0.2, 5.205}, {0.1, 5.22}, {0.3, 5.22}, kBack, kRest},
       "P1@108 98; P2@108 98; P3@156 151; P3@216 211; Final@254 98 98 211 flags 1024; "},
      {"rest for 0.2 s at the beginning",
       {{0.28, 3.7}, kDip, kRise, kBack, kRest},
       "P1@47 26; P2@51 46; P3@102 97; Final@115 27 46 97 flags 2; "},
      {"rest for less", {{0.14, 3.7}, kDip, kRise, kBack, kRest}, ""},
  });
}

TEST(ReachStory, Features_AreThoseOfTheSmoothedMovement) {
  const auto finals = finals_of(reaches_of(transient_of_moves({kRest, kDip, kRise, {0.2, 5.2}, kBack, kRest})));

  ASSERT_EQ(finals.size(), 1U);
  const core::ReachFeatures& of = finals[0].features;
  EXPECT_NEAR(of.p1_mm, 3.7, 1e-12);
  EXPECT_NEAR(of.p2_mm, 3.4 + (0.045 + 0.03 + 0.015 + 0.036) / 5.0, 1e-9);
  EXPECT_NEAR(of.p3_mm, 5.2, 1e-12);
  EXPECT_NEAR(of.hold_mm, 1.41058536585, 1e-9);
  EXPECT_NEAR(of.rise_s, 0.53, 1e-12);
  EXPECT_NEAR(of.rest_ratio, -0.2, 1e-12);
  EXPECT_NEAR(of.ratio_change, 0.07 * 1.5, 1e-12);
  EXPECT_NEAR(of.twist, 0.01, 1e-12);
  EXPECT_NEAR(of.smoothness, -1.97332738498, 1e-9);
}

TEST(ReachStory, Wobbles_AreCancelledOrBeginAnew) {
  expect_told({
      {"rise just beyond the threshold",
       {kRest, {0.1, 3.747}, {0.1, 3.747}, {0.02, 3.742}, {0.5, 3.742}, kRest},
       "P1@117 100; P2@117 100; P3@120 115; Cancelled@147 flags 1024; "},
      {"small rise that drops at once",
       {kRest, {0.1, 3.79}, {0.05, 3.79}, {0.01, 2.9}, {0.2, 2.9}, kRise, kBack, kRest},
       "P1@111 99; P2@111 99; P1@115 99; P2@122 117; P3@191 186; Final@208 103 117 186; "},
      {"shallow dip", {kRest, {0.1, 3.63}, {0.1, 3.7}, kRest}, "P1@113 99; P2@116 111; Cancelled@139; "},
      {"deep dip", {kRest, {0.1, 3.55}, {0.1, 3.7}, kRest}, "P1@109 98; P2@114 109; Final@215 98 109 213 flags 5; "},
      {"small rise", {kRest, {0.1, 3.77}, {0.1, 3.7}, kRest}, "P1@113 99; P2@113 99; P3@116 111; Final@118 99 99 111 flags 1025; "},
      {"larger rise",
       {kRest, {0.1, 3.8}, {0.1, 3.7}, kRest, kRise, kBack, kRest},
       "P1@111 99; P2@111 99; P3@114 109; Final@116 99 99 109 flags 1025; P1@229 219; P2@229 219; P3@274 269; Final@285 219 219 269 flags "
       "1024; "},
      {"small rise before a dip",
       {kRest, {0.1, 3.8}, {0.2, 3.4}, kRise, {0.2, 5.2}, kBack, kRest},
       "P1@111 99; P2@111 99; Final@114 99 99 109 flags 1025; P1@124 114; P2@133 128; P3@186 181; Final@216 114 128 181; "},
      {"minor reach, then a dip",
       {kRest, {0.1, 3.82}, {0.1, 3.75}, {0.2, 3.4}, kRise, {0.2, 5.2}, kBack, kRest},
       "P1@110 98; P2@110 98; P3@115 110; Final@117 98 98 110 flags 1025; P1@132 122; P2@143 138; P3@196 191; Final@226 122 138 191; "},
  });
}

TEST(ReachStory, LaterHump_ResumesOrIsTheSame) {
  expect_told({
      {"after a loss of a third, a little higher",
       {kRest, kRise, {0.2, 4.7}, {0.2, 5.28}, kBack, kRest},
       "P1@108 98; P2@108 98; P3@154 149; Final@167 98 98 149 flags 1024; P3@194 189; Final@205 98 98 189 flags 1024; "},
      {"after a loss of a third, hardly higher",
       {kRest, kRise, {0.2, 4.7}, {0.2, 5.22}, kBack, kRest},
       "P1@108 98; P2@108 98; P3@154 149; Final@167 98 98 149 flags 1024; "},
      {"after a loss of 60 %",
       {kRest, kRise, {0.2, 4.3}, {0.2, 5.28}, kBack, kRest},
       "P1@108 98; P2@108 98; P3@153 148; Final@161 98 98 148 flags 1024; P3@195 190; Final@205 98 98 190 resumed 1 flags 1040; "},
      {"with a jump by less than a tenth",
       {kRest, kRise, {0.2, 4.7}, {0.2, 5.15}, {0.1, 5.15}, {0.01, 5.75}, kBack, kRest},
       "P1@108 98; P2@108 98; P3@154 149; Final@167 98 98 149 flags 1024; P3@207 202; Final@217 98 98 202 flags 1024; "},
      {"with a jump",
       {kRest, kRise, {0.2, 4.7}, {0.2, 5.15}, {0.1, 5.15}, {0.01, 6.05}, kBack, kRest},
       "P1@108 98; P2@108 98; P3@154 149; Final@167 98 98 149 flags 1024; P3@207 202; Final@217 98 98 202 resumed 1 flags 1040; "},
      {"after a hold",
       {kRest, kRise, {0.8, 5.2}, {0.2, 5.5}, {0.8, 5.5}, {0.2, 5.9}, kBack, kRest},
       "P1@108 98; P2@108 98; P3@156 151; Final@213 98 98 151 flags 1024; P3@256 251; Final@313 98 98 251 resumed 1 flags 1040; P3@353 "
       "348; Final@365 98 98 348 resumed 2 flags 1040; "},
  });
}

TEST(ReachStory, MovementWithoutAnEnd_TimesOutOrIsANewPosture) {
  expect_told({
      {"rises for 6 s",
       {kRest, {8.0, 6.0}, kBack, kRest},
       "P1@122 101; P2@122 101; Final@723 101 101 721 flags 1032; P1@916 905; P2@956 951; Final@1049 905 951 1047 flags 133; "},
      {"never comes back",
       {kRest, kRise, {8.0, 4.5}, {1.0, 4.5}},
       "P1@108 98; P2@108 98; P3@156 151; Final@213 98 98 151 flags 1024; Final@754 98 98 151 flags 1032; "},
      {"small rise that stays",
       {kRest, {0.3, 4.0}, {3.0, 4.0}, kDip, kRise, {0.5, 4.0}, {1.0, 4.0}},
       "P1@111 99; P2@111 99; P3@136 131; Final@193 99 99 131 flags 1024; P1@438 428; P2@454 449; P3@504 499; Final@521 429 449 499; "},
      {"dip that stays",
       {kRest, kDip, {2.0, 3.4}, {0.2, 3.0}, kRise, {0.5, 3.4}, kRest},
       "P1@109 98; P2@126 121; Final@215 99 121 213 flags 5; P1@329 318; P2@343 338; P3@394 389; Final@408 319 338 389; "},
      {"dip that slides on", {kRest, kDip, {4.0, 2.0}}, "P1@109 98; Final@410 308 408 408 flags 5; P1@468 455; "},
      {"dip that stays, after a short rest", {{0.3, 3.7}, kDip, {2.0, 3.4}}, "P1@48 28; P2@56 51; Cancelled@149 flags 2; "},
  });
}

TEST(ReachStory, SeatLeft_EndsTheReach) {
  expect_told({
      {"in the dip", {kRest, kDip, {0.05, 0.2}, {0.5, 0.2}}, "P1@109 98; P2@132 127; Cancelled@136 flags 256; "},
      {"in the rise",
       {kRest, kRise, {0.01, 0.2}, {0.5, 0.2}},
       "P1@108 98; P2@108 98; Final@150 98 98 147 flags 1024; Final@163 98 98 147 flags 1280; "},
      {"after the highest point",
       {kRest, kRise, {0.8, 5.2}, {0.01, 0.2}, {0.5, 0.2}},
       "P1@108 98; P2@108 98; P3@156 151; Final@213 98 98 151 flags 1024; Final@243 98 98 151 flags 1280; "},
      {"nearly empty for a tenth of a second less one sample",
       {kRest, {0.01, 0.3}, {0.14, 0.3}, {0.01, 3.7}, kRest},
       "P1@105 97; P2@108 103; "},
      {"nearly empty for a tenth of a second",
       {kRest, {0.01, 0.3}, {0.15, 0.3}, {0.01, 3.7}, kRest},
       "P1@105 97; P2@108 103; Cancelled@115 flags 256; "},
      {"sensors silent for 250 ms",
       {kRest, kDip, kRise, {0.25, kNaN}, {0.2, 5.2}, kBack, kRest},
       "P1@109 98; P2@123 118; P3@176 171; Final@231 99 118 171; "},
      {"sensors silent for 260 ms",
       {kRest, kDip, kRise, {0.26, kNaN}, {0.2, 5.2}, kBack, kRest},
       "P1@109 98; P2@123 118; P3@176 171; Cancelled@195; P1@232 214; P2@272 267; Cancelled@363 flags 2; "},
      {"sits down elsewhere after three reaches",
       {kRest,
        kRise,
        kBack,
        kRest,
        kRise,
        kBack,
        kRest,
        kRise,
        kBack,
        kRest,
        {0.05, 0.0},
        {0.5, 0.0},
        {0.05, 4.0},
        {2.0, 4.0},
        kRise,
        {0.5, 4.0},
        kRest},
       "P1@108 98; P2@108 98; P3@154 149; Final@165 98 98 149 flags 1024; P1@308 298; P2@308 298; P3@354 349; Final@365 298 298 349 flags "
       "1024; P1@508 498; P2@508 498; P3@554 549; Final@565 498 498 549 flags 1024; P1@705 697; P2@711 706; Cancelled@715 flags 256; "
       "P1@877 825; P2@877 825; P3@880 875; Final@937 825 825 875 flags 1026; P3@1014 1009; Final@1028 825 825 1009 resumed 1 flags "
       "1042; "},
  });
}

TEST(ReachStory, NextReachWithoutARest_IsFoundFromTheRestBefore) {
  expect_told({
      {"with a dip",
       {kRest, kDip, kRise, kBack, {0.32, 3.7}, kDip, kRise, kBack, kRest},
       "P1@109 98; P2@123 118; P3@174 169; Final@187 99 118 169; P1@297 250; P2@297 270; P3@326 321; Final@339 251 270 321 flags 2; "},
      {"without a dip",
       {kRest, kDip, kRise, kBack, {0.32, 3.7}, kRise, kBack, kRest},
       "P1@109 98; P2@123 118; P3@174 169; Final@187 99 118 169; P1@272 252; P2@272 252; P3@306 301; Final@317 252 252 301 flags 1026; "},
      {"too small",
       {kRest, kDip, kRise, kBack, {0.32, 3.7}, {0.3, 4.05}, {0.3, 3.7}, kRest},
       "P1@109 98; P2@123 118; P3@174 169; Final@187 99 118 169; "},
      {"after a pause",
       {kRest, kDip, kRise, kBack, {0.2, 3.6}, {0.2, 3.7}, {0.2, 3.7}, kRise, kBack, kRest},
       "P1@109 98; P2@123 118; P3@174 169; Final@187 99 118 169; P1@300 280; P2@300 280; P3@334 329; Final@345 280 280 329 flags 1026; "},
  });
}

TEST(ReachStory, DoubtsOfSensors_AreFlagsFor50MsAndFadeAtRest) {
  const auto reach_after = [](const Move& doubt, double seconds) {
    return std::vector<Move>{kRest, {doubt.seconds, 3.7, doubt.bits}, {seconds, 3.7}, kRise, kBack, kRest};
  };
  const auto reach_with = [](std::uint8_t bits) {
    return std::vector<Move>{kRest, {0.3, 4.5}, {0.01, 4.53, bits}, {0.3, 5.2}, kBack, kRest};
  };
  expect_told({
      {"0.1 s at rest, just before", reach_after({0.1, 0.0, kSubstituted}, 0.04),
       "P1@122 112; P2@122 112; P3@168 163; Final@179 112 112 163 flags 1056; "},
      {"0.1 s at rest, long enough before", reach_after({0.1, 0.0, kSubstituted}, 0.05),
       "P1@123 113; P2@123 113; P3@169 164; Final@180 113 113 164 flags 1024; "},
      {"2 s at rest, too short before", reach_after({2.0, 0.0, kUncalibrated}, 0.50),
       "P1@358 348; P2@358 348; P3@404 399; Final@415 348 348 399 flags 1088; "},
      {"2 s at rest, long enough before", reach_after({2.0, 0.0, kUncalibrated}, 0.51),
       "P1@359 349; P2@359 349; P3@405 400; Final@416 349 349 400 flags 1024; "},
      {"not tared before", reach_after({1.0, 0.0, kUntared}, 0.05),
       "P1@213 203; P2@213 203; P3@259 254; Final@270 203 203 254 flags 1024; "},
      {"one sample of the reach substituted", reach_with(kSubstituted),
       "P1@108 98; P2@108 98; P3@165 160; Final@176 98 98 160 flags 1056; "},
      {"one sample of the reach at the end", reach_with(kUncalibrated),
       "P1@108 98; P2@108 98; P3@165 160; Final@176 98 98 160 flags 1088; "},
      {"one sample of the reach not tared", reach_with(kUntared), "P1@108 98; P2@108 98; P3@165 160; Final@176 98 98 160 flags 1536; "},
  });
}

}  // namespace
}  // namespace dts::pipeline
