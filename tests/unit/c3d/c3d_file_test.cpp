// SPDX-License-Identifier: Apache-2.0
// Files of every encoding, files that contradict themselves, and files that our writer made.
#include "c3d/c3d_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include "c3d/c3d_writer.h"
#include "c3d/force_platform.h"
#include "support/made_c3d.h"

namespace dts::c3d {
namespace {

using test::MadeC3d;
using test::MadeEncoding;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

C3dFile read(const MadeC3d& made) {
  auto file = C3dFile::read(made.bytes());
  EXPECT_TRUE(file.has_value()) << file.error().what;
  return file.value();
}

/// Two channels, two samples in a frame, one point; 3 frames, a channel counts from 0, the other from 100.
MadeC3d small(MadeEncoding encoding, bool is_real) {
  MadeC3d made(encoding, is_real);
  made.points = 1;
  made.channels = 2;
  made.samples_per_frame = 2;
  made.group("POINT");
  made.words("USED", {}, {1});
  made.reals("RATE", {}, {100.0});
  made.group("ANALOG");
  made.words("USED", {}, {2});
  made.reals("GEN_SCALE", {}, {0.5});
  made.reals("SCALE", {2}, {2.0, -4.0});
  made.words("OFFSET", {2}, {0, 10});
  for (int frame = 0; frame < 3; ++frame) {
    made.frame({9, 9, 9, 9, 2.0 * frame, 100.0 + 2.0 * frame, 2.0 * frame + 1, 101.0 + 2.0 * frame});
  }
  return made;
}

TEST(C3dFile, EveryEncoding_GivesTheSameValues) {
  for (const MadeEncoding encoding : {MadeEncoding::Intel, MadeEncoding::Dec, MadeEncoding::Sgi}) {
    for (const bool is_real : {true, false}) {
      const C3dFile file = read(small(encoding, is_real));
      EXPECT_EQ(file.samples(), 6U);
      EXPECT_EQ(file.channels(), 2U);
      EXPECT_DOUBLE_EQ(file.analogue_rate_hz(), 200.0);
      EXPECT_THAT(file.warnings(), IsEmpty());
      for (std::size_t sample = 0; sample < 6; ++sample) {
        EXPECT_DOUBLE_EQ(file.analogue(sample, 0), static_cast<double>(sample));
        EXPECT_DOUBLE_EQ(file.analogue(sample, 1), (100.0 + static_cast<double>(sample) - 10.0) * -2.0);
      }
    }
  }
}

TEST(C3dFile, RealsOfDec_AreThoseOfVax) {
  EXPECT_EQ(real(Encoding::Dec, std::string("\x80\x40\0\0", 4).data()), 1.0);
  EXPECT_EQ(real(Encoding::Dec, std::string("\x80\xC0\0\0", 4).data()), -1.0);
  EXPECT_EQ(real(Encoding::Dec, std::string("\0\0\0\0", 4).data()), 0.0);
  EXPECT_NEAR(real(Encoding::Dec, std::string("\xFF\x7F\xFF\xFF", 4).data()), 1.70141173e38, 1e31) << "no infinity";
}

TEST(C3dFile, NumbersWithoutSign_ByFormatOrByAnOffsetOfHalfTheRange) {
  for (const bool has_format : {true, false}) {
    MadeC3d made(MadeEncoding::Intel, false);
    made.channels = 1;
    made.group("ANALOG");
    if (has_format) made.text("FORMAT", "unsigned");
    made.reals("SCALE", {1}, {1.0});
    made.words("OFFSET", {1}, {32768});
    made.frame({32768});
    made.frame({65535});
    made.frame({0});
    const C3dFile file = read(made);
    EXPECT_EQ(file.analogue(0, 0), 0.0);
    EXPECT_EQ(file.analogue(1, 0), 32767.0);
    EXPECT_EQ(file.analogue(2, 0), -32768.0);
  }
}

TEST(C3dFile, HeaderAndParametersDiffer_TheHeaderIsUsedAndAWarningNamesBoth) {
  MadeC3d made = small(MadeEncoding::Intel, true);
  made.group("TRIAL");
  made.words("ACTUAL_START_FIELD", {2}, {1, 0});
  made.words("ACTUAL_END_FIELD", {2}, {50, 0});
  made.group("SECOND");
  MadeC3d other = small(MadeEncoding::Intel, true);
  other.points = 0;
  other.channels = 4;
  EXPECT_THAT(read(made).warnings(), Contains(HasSubstr("50 frames, but the header says 3")));
  EXPECT_EQ(read(made).frames(), 3U);
  EXPECT_THAT(read(other).warnings(), Contains(HasSubstr("POINT:USED is 1, but the header says 0")));
  EXPECT_THAT(read(other).warnings(), Contains(HasSubstr("ANALOG:USED is 2, but the header says 4")));
}

TEST(C3dFile, MoreFramesThanAHeaderCounts_AreThoseOfTheParameters) {
  MadeC3d made(MadeEncoding::Intel, false);
  made.channels = 1;
  made.last_frame = 65535;
  made.group("TRIAL");
  made.words("ACTUAL_START_FIELD", {2}, {1, 0});
  made.words("ACTUAL_END_FIELD", {2}, {70000 - 65536, 1});
  for (int frame = 0; frame < 70001; ++frame) made.frame({1.0 * (frame % 100)});
  EXPECT_EQ(read(made).frames(), 70000U);
}

/// A file of 70000 frames whose header is saturated.
MadeC3d saturated() {
  MadeC3d made(MadeEncoding::Intel, false);
  made.channels = 1;
  made.last_frame = 65535;
  for (int frame = 0; frame < 70000; ++frame) made.frame({1.0});
  return made;
}

TEST(C3dFile, FramesThatTheParametersDoNotKnow_AreNotLost) {
  MadeC3d trial = saturated();
  trial.group("TRIAL");
  trial.words("ACTUAL_START_FIELD", {2}, {0, 0});
  trial.words("ACTUAL_END_FIELD", {2}, {0, 0});
  trial.group("POINT");
  trial.reals("LONG_FRAMES", {}, {70000});
  EXPECT_EQ(read(trial).frames(), 70000U);
  MadeC3d shorter = saturated();
  shorter.group("TRIAL");
  shorter.words("ACTUAL_START_FIELD", {2}, {1, 0});
  shorter.words("ACTUAL_END_FIELD", {2}, {100, 0});
  EXPECT_EQ(read(shorter).frames(), 70000U) << "less than the header";
  MadeC3d full = saturated();
  full.group("POINT");
  full.words("FRAMES", {}, {65535});
  EXPECT_EQ(read(full).frames(), 70000U);
  EXPECT_THAT(read(full).warnings(), Contains(HasSubstr("number of frames is not known")));
}

TEST(C3dFile, MoreFramesThanStated_AreWarnedOf) {
  for (const int frames : {300, 500}) {  // two bytes each: 300 fill up the last block
    MadeC3d made(MadeEncoding::Intel, false);
    made.channels = 1;
    made.last_frame = 100;
    made.group("ANALOG");
    made.reals("SCALE", {1}, {1.0});
    for (int frame = 0; frame < frames; ++frame) made.frame({1.0});
    EXPECT_EQ(read(made).frames(), 100U);
    const auto warned = Contains(HasSubstr("holds " + std::to_string(frames) + " frames, but only 100 are stated"));
    if (frames == 500) {
      EXPECT_THAT(read(made).warnings(), warned);
    } else {
      EXPECT_THAT(read(made).warnings(), IsEmpty());
    }
  }
}

TEST(C3dFile, RecordsThatOverlap_AreLeftOut) {
  MadeC3d made = small(MadeEncoding::Intel, true);
  // The head of the next record would be type and dimensions of this one: 255 x 128 numbers, those of all records behind it.
  for (int record = 0; record < 20; ++record) made.raw_record("\xFF\x80", 2, "", 2);
  for (int filler = 0; filler < 3; ++filler) made.texts("FILL", 255, std::vector<std::string>(100));
  made.words("AFTER", {}, {5});
  const C3dFile file = read(made);
  for (const Parameter& parameter : file.parameters().all()) EXPECT_LE(parameter.numbers.size(), 2U) << parameter.name;
  EXPECT_EQ(file.parameters().number("ANALOG", "AFTER"), 5.0);
}

TEST(C3dFile, NumberOfEventsThatIsNone_GivesNoEvents) {
  MadeC3d made = small(MadeEncoding::Intel, true);
  made.group("EVENT");
  made.reals("USED", {}, {kUndefined});
  made.reals("TIMES", {2, 1}, {0, 0.01});
  EXPECT_THAT(read(made).events(), IsEmpty());
}

TEST(C3dFile, FileThatEndsEarly_HasTheFramesBefore) {
  std::string bytes = small(MadeEncoding::Intel, true).bytes();
  bytes.resize(bytes.size() - 1);
  const auto file = C3dFile::read(bytes);
  ASSERT_TRUE(file.has_value());
  EXPECT_EQ(file->frames(), 2U);
  EXPECT_THAT(file->warnings(), Contains(HasSubstr("ends after frame 2 of 3")));
}

TEST(C3dFile, BrokenParameters_LeaveOutTheRecordAndSayWhere) {
  struct Case {
    int type;
    std::vector<int> dimensions;
    std::string says;
  };
  for (const Case& broken : {Case{3, {1}, "unknown type 3"}, Case{4, {255, 255, 255, 255, 255, 255, 255}, "its record has fewer"},
                             Case{2, std::vector<int>(8, 1), "8 dimensions"}}) {
    MadeC3d made = small(MadeEncoding::Intel, true);
    made.parameter("BAD", broken.type, broken.dimensions, "");
    made.words("AFTER", {}, {5});
    const C3dFile file = read(made);
    EXPECT_THAT(file.warnings(), Contains(HasSubstr(broken.says)));
    EXPECT_EQ(file.parameters().number("ANALOG", "AFTER"), 5.0);
  }
  MadeC3d backwards = small(MadeEncoding::Intel, true);
  backwards.raw_record("LOOP", 2, "\4", -20);
  EXPECT_THAT(read(backwards).warnings(), Contains(HasSubstr("would be outside")));
  MadeC3d outside = small(MadeEncoding::Intel, true);
  outside.raw_record("FAR", 2, "\2", 32000);
  EXPECT_THAT(read(outside).warnings(), Contains(HasSubstr("would be outside")));
  MadeC3d orphan = small(MadeEncoding::Intel, true);
  orphan.raw_record("ALONE", 99, std::string("\2\0\1\0\0", 5));
  EXPECT_THAT(read(orphan).warnings(), Contains(HasSubstr("ALONE belongs to group 99")));
}

TEST(C3dFile, NoC3dFile_IsRejectedWithItsPlace) {
  const auto reason = [](const std::string& bytes) { return C3dFile::read(bytes).error().what; };
  EXPECT_THAT(reason("t_s,x_mm"), HasSubstr("byte 2"));
  EXPECT_THAT(reason(std::string("\2\x50", 2)), HasSubstr("within its header"));
  std::string bytes = small(MadeEncoding::Intel, true).bytes();
  std::string far = bytes;
  far[0] = '\xFF';
  EXPECT_THAT(reason(far), HasSubstr("behind the end"));
  std::string processor = bytes;
  processor[512 + 3] = 'x';
  EXPECT_THAT(reason(processor), HasSubstr("byte 516: the processor 120"));
  EXPECT_THAT(reason(bytes.substr(0, 1024)), HasSubstr("byte 1025: the file has no frame"));
  MadeC3d empty;
  empty.frame({});
  EXPECT_THAT(reason(empty.bytes()), HasSubstr("no points and no channels"));
  MadeC3d timeless = small(MadeEncoding::Intel, true);
  timeless.rate_hz = 0.0;
  EXPECT_EQ(read(timeless).point_rate_hz(), 100.0) << "of POINT:RATE";
}

TEST(C3dFile, NumberOfTheProcessor_MayBeThatOfItsKind) {
  for (const MadeEncoding encoding : {MadeEncoding::Intel, MadeEncoding::Dec, MadeEncoding::Sgi}) {
    std::string bytes = small(encoding, true).bytes();
    bytes[512 + 3] = static_cast<char>(static_cast<int>(encoding) - 83);
    const C3dFile file = C3dFile::read(bytes).value();
    EXPECT_THAT(file.warnings(), Contains(HasSubstr("instead of " + std::to_string(static_cast<int>(encoding)))));
    EXPECT_EQ(file.analogue(5, 0), 5.0);
  }
  for (const int unknown : {0, 4, 83, 87}) {
    std::string bytes = small(MadeEncoding::Intel, true).bytes();
    bytes[512 + 3] = static_cast<char>(unknown);
    EXPECT_FALSE(C3dFile::read(bytes)) << unknown;
  }
}

TEST(C3dFile, WhatTheHeaderLacks_IsReplacedWithAWarning) {
  MadeC3d made(MadeEncoding::Intel, false);
  made.channels = 0;
  made.points = 1;
  made.samples_per_frame = 0;
  made.frame({1, 2, 3, 4});
  std::string bytes = made.bytes();
  EXPECT_THAT(C3dFile::read(bytes)->warnings(), IsEmpty()) << "no channels, no samples";
  bytes[2 * 2] = 3;  // three analogue values
  bytes += std::string(6, '\0');
  const C3dFile file = C3dFile::read(bytes).value();
  EXPECT_THAT(file.warnings(), Contains(HasSubstr("0 analogue samples in a frame: 1 is used")));
  EXPECT_THAT(file.warnings(), Contains("ANALOG:SCALE has 0 of 3 channels: the others have 1"));
  EXPECT_EQ(file.channels(), 3U);
  EXPECT_EQ(file.samples(), 1U);
}

TEST(C3dFile, ScaleAndOffset_ContinueInTheirSecondParts) {
  MadeC3d made(MadeEncoding::Intel, true);
  made.channels = 257;
  made.group("ANALOG");
  made.reals("SCALE", {255}, std::vector<double>(255, 2.0));
  made.reals("SCALE2", {1}, {3.0});
  made.words("OFFSET", {255}, std::vector<int>(255, 1));
  made.words("OFFSET2", {2}, {10, 20});
  made.frame(std::vector<double>(257, 100.0));
  const C3dFile file = read(made);
  EXPECT_EQ(file.analogue(0, 254), 198.0);
  EXPECT_EQ(file.analogue(0, 255), 270.0);
  EXPECT_EQ(file.analogue(0, 256), 80.0);
  EXPECT_THAT(file.warnings(), Contains(HasSubstr("has 256 of 257 channels")));
}

TEST(C3dFile, Events_CountFromTheFirstFrame) {
  MadeC3d made(MadeEncoding::Intel, true);
  made.channels = 1;
  made.first_frame = 11;  // 0.1 s
  made.group("EVENT");
  made.words("USED", {}, {2});
  made.texts("LABELS", 4, {"one"});
  made.reals("TIMES", {2, 2}, {0, 0.5, 1, 0.1});
  made.frame({1});
  const C3dFile file = read(made);
  ASSERT_EQ(file.events().size(), 2U);
  EXPECT_NEAR(file.events()[0].time_s, 0.4, 1e-6);
  EXPECT_NEAR(file.events()[1].time_s, 60.0, 1e-6);
  EXPECT_EQ(file.events()[1].label, "") << "the file has one label";
}

TEST(C3dFile, ManyBrokenParameters_GiveTwentyWarnings) {
  MadeC3d made = small(MadeEncoding::Intel, true);
  for (int k = 0; k < 25; ++k) made.parameter("BAD", 3, {1}, "");
  EXPECT_EQ(read(made).warnings().size(), 20U);
}

TEST(ForcePlatforms, MatrixAndPolynomial_BelongToTheirPlate) {
  const auto counted = [](double from, int count) {
    std::vector<double> numbers;
    for (int k = 0; k < count; ++k) numbers.push_back(from + k);
    return numbers;
  };
  MadeC3d made = small(MadeEncoding::Intel, true);
  made.plates({{.type = 4, .channels = {1, 2}, .matrix = counted(0.0, 36)}, {.type = 3, .channels = {2, 0}, .matrix = counted(100.0, 36)}});
  made.reals("FPCOPPOLY", {6, 2, 2}, counted(1000.0, 24));
  const ForcePlatforms platforms = force_platforms(read(made).parameters());
  ASSERT_EQ(platforms.plates.size(), 2U);
  EXPECT_EQ(platforms.plates[1].type, 3);
  EXPECT_EQ(platforms.plates[1].matrix, counted(100.0, 36));
  ASSERT_TRUE(platforms.plates[1].polynomial);
  EXPECT_EQ(platforms.plates[1].polynomial->front(), 1012.0);
  EXPECT_EQ(platforms.plates[0].channels, (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(platforms.plates[1].channels, (std::vector<std::size_t>{2, 0}));

  MadeC3d wrong = small(MadeEncoding::Intel, true);
  wrong.plates({{.type = 2, .channels = {1}}});
  wrong.reals("CAL_MATRIX", {4, 9, 1}, counted(0.0, 36));
  const ForcePlatforms without = force_platforms(read(wrong).parameters());
  EXPECT_FALSE(without.plates.at(0).matrix) << "36 numbers, but not 6 x 6";
  EXPECT_FALSE(without.plates.at(0).polynomial);
}

TEST(C3dFile, EventsOfTheHeader_AreReadIfThereAreNoOthers) {
  std::string bytes = small(MadeEncoding::Intel, true).bytes();
  std::string words;
  test::put_word(words, MadeEncoding::Intel, 12345);
  test::put_word(words, MadeEncoding::Intel, 1);
  test::put_word(words, MadeEncoding::Intel, 0);
  test::put_real(words, MadeEncoding::Intel, 0.25);
  bytes.replace(298, words.size(), words);
  bytes.replace(396, 4, "RHS ");
  const auto file = C3dFile::read(bytes);
  ASSERT_EQ(file->events().size(), 1U);
  EXPECT_EQ(file->events().front().label, "RHS");
  EXPECT_EQ(file->events().front().time_s, 0.25);
}

Corners corners_of(double x) { return {{{x + 200, 300, 0}, {x - 200, 300, 0}, {x - 200, -300, 0}, {x + 200, -300, 0}}}; }

TEST(C3dWriter, WhatIsWritten_IsReadTheSame) {
  const Outline outline{
      .rate_hz = 1000.0,
      .samples = 3,
      .plates = {corners_of(0), corners_of(500)},
      .events = {{.context = "Left", .label = "Foot Strike", .time_s = 61.5}, {.context = "", .label = "marker", .time_s = 0.0}},
      .software = "test 1"};
  std::string bytes = file_beginning(outline).value();
  EXPECT_EQ(bytes.size() % kBlockBytes, 0U);
  for (int sample = 0; sample < 3; ++sample) {
    std::array<double, 12> values{};
    for (std::size_t k = 0; k < values.size(); ++k) values.at(k) = 100.0 * sample + static_cast<double>(k) + 0.1;
    values[3] = sample == 1 ? kUndefined : values[3];
    append_sample(bytes, values);
  }
  const C3dFile file = C3dFile::read(bytes).value();
  EXPECT_THAT(file.warnings(), IsEmpty());
  EXPECT_EQ(file.samples(), 3U);
  EXPECT_EQ(file.analogue_rate_hz(), 1000.0);
  EXPECT_EQ(file.analogue(2, 11), static_cast<double>(211.1F));
  EXPECT_TRUE(std::isnan(file.analogue(1, 3)));
  ASSERT_EQ(file.events().size(), 2U);
  EXPECT_EQ(file.events()[0].label, "Foot Strike");
  EXPECT_EQ(file.events()[0].context, "Left");
  EXPECT_EQ(file.events()[0].time_s, 61.5);
  const ForcePlatforms platforms = force_platforms(file.parameters());
  ASSERT_EQ(platforms.plates.size(), 2U);
  EXPECT_EQ(platforms.plates[1].type, 1);
  EXPECT_EQ(platforms.plates[1].corners, corners_of(500));
  EXPECT_EQ(platforms.plates[1].channels, (std::vector<std::size_t>{7, 8, 9, 10, 11, 12}));
  EXPECT_EQ(platforms.zero_frames, (std::array<int, 2>{1, 0}));
}

/// "GROUP:NAME dimensions = values", a line each.
std::string listed(const Parameters& parameters) {
  std::ostringstream text;
  for (const Parameter& parameter : parameters.all()) {
    text << parameter.group << ':' << parameter.name << ' ';
    for (const std::size_t dimension : parameter.dimensions) text << dimension << ' ';
    text << '=';
    for (const double number : parameter.numbers) text << ' ' << number;
    for (const std::string& one : parameter.texts) text << ' ' << one;
    text << '\n';
  }
  return text.str();
}

TEST(C3dWriter, EveryParameter_IsWritten) {
  const Outline outline{.rate_hz = 1500.0,
                        .samples = 2,
                        .plates = {corners_of(500)},
                        .events = {{.context = "Left", .label = "Foot Strike", .time_s = 61.5}},
                        .software = "test 1"};
  std::string bytes = file_beginning(outline).value();
  for (int sample = 0; sample < 2; ++sample) append_sample(bytes, std::array<double, 6>{});
  EXPECT_EQ(listed(C3dFile::read(bytes)->parameters()),
            "POINT:USED = 0\n"
            "POINT:SCALE = -1\n"
            "POINT:RATE = 1500\n"
            "POINT:DATA_START = 4\n"
            "POINT:FRAMES = 2\n"
            "POINT:UNITS 2 = mm\n"
            "TRIAL:ACTUAL_START_FIELD 2 = 1 0\n"
            "TRIAL:ACTUAL_END_FIELD 2 = 2 0\n"
            "ANALOG:USED = 6\n"
            "ANALOG:LABELS 3 6 = Fx1 Fy1 Fz1 Px1 Py1 Mz1\n"
            "ANALOG:DESCRIPTIONS 3 6 = Fx1 Fy1 Fz1 Px1 Py1 Mz1\n"
            "ANALOG:UNITS 3 6 = N N N mm mm Nmm\n"
            "ANALOG:GEN_SCALE = 1\n"
            "ANALOG:SCALE 6 = 1 1 1 1 1 1\n"
            "ANALOG:OFFSET 6 = 0 0 0 0 0 0\n"
            "ANALOG:RATE = 1500\n"
            "FORCE_PLATFORM:USED = 1\n"
            "FORCE_PLATFORM:TYPE 1 = 1\n"
            "FORCE_PLATFORM:ZERO 2 = 1 0\n"
            "FORCE_PLATFORM:CORNERS 3 4 1 = 700 300 0 300 300 0 300 -300 0 700 -300 0\n"
            "FORCE_PLATFORM:ORIGIN 3 1 = 0 0 0\n"
            "FORCE_PLATFORM:CHANNEL 6 1 = 1 2 3 4 5 6\n"
            "EVENT:USED = 1\n"
            "EVENT:CONTEXTS 4 1 = Left\n"
            "EVENT:LABELS 11 1 = Foot Strike\n"
            "EVENT:TIMES 2 1 = 1 1.5\n"
            "MANUFACTURER:SOFTWARE 6 = test 1\n");
}

TEST(C3dWriter, ManySamples_AreDividedSoThatTheHeaderCountsThem) {
  for (const std::size_t samples : {std::size_t{70000}, std::size_t{65537}}) {  // the second is a prime
    std::string bytes = file_beginning({.rate_hz = 1000.0, .samples = samples, .plates = {corners_of(0)}}).value();
    for (std::size_t sample = 0; sample < samples; ++sample) append_sample(bytes, std::array<double, 6>{static_cast<double>(sample)});
    const C3dFile file = C3dFile::read(bytes).value();
    EXPECT_THAT(file.warnings(), IsEmpty());
    EXPECT_EQ(file.samples(), samples);
    EXPECT_EQ(file.analogue_rate_hz(), 1000.0);
    EXPECT_EQ(file.analogue(samples - 1, 0), static_cast<double>(samples - 1));
  }
}

TEST(C3dWriter, MostSamplesOfAFrame_AreAHundred) {
  const auto samples_per_frame = [](std::size_t samples) {
    const std::string bytes = file_beginning({.rate_hz = 1000.0, .samples = samples, .plates = {corners_of(0)}}).value();
    return static_cast<int>(bytes[18]);  // word 10 of the header
  };
  EXPECT_EQ(samples_per_frame(65535), 1);
  EXPECT_EQ(samples_per_frame(65535 * 100), 100);
  EXPECT_EQ(samples_per_frame(std::size_t{65535} * 101), 1) << "the parameters count them";
}

TEST(C3dWriter, NothingToWrite_IsRejected) {
  const auto reason = [](const Outline& outline) { return file_beginning(outline).error().what; };
  const std::vector<Corners> one{corners_of(0)};
  EXPECT_THAT(reason({.rate_hz = 0.0, .samples = 1, .plates = one}), HasSubstr("rate"));
  EXPECT_THAT(reason({.rate_hz = 1e39, .samples = 1, .plates = one}), HasSubstr("32-bit"));
  EXPECT_THAT(reason({.rate_hz = 1e-39, .samples = 1, .plates = one}), HasSubstr("32-bit"));
  EXPECT_THAT(reason({.rate_hz = kUndefined, .samples = 1, .plates = one}), HasSubstr("rate"));
  EXPECT_THAT(reason({.rate_hz = 1.0, .samples = 0, .plates = one}), HasSubstr("one sample"));
  EXPECT_THAT(reason({.rate_hz = 1.0, .samples = 1}), HasSubstr("1 to 42 plates"));
  EXPECT_THAT(reason({.rate_hz = 1.0, .samples = 1, .plates = one, .events = std::vector<Event>(256)}), HasSubstr("255 events"));
}

}  // namespace
}  // namespace dts::c3d
