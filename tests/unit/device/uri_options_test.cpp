// SPDX-License-Identifier: Apache-2.0
#include "device/uri_options.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

namespace dts::device {
namespace {

constexpr std::array kTable = {
    UriOption{"load_n", OptionKind::Number, "5.5", 1, 10, "", "A load."},
    UriOption{"count", OptionKind::Integer, "2", 0, 4, "", "A count."},
    UriOption{"end_s", OptionKind::Number, "never", 0, kNever, "", "An end."},
    UriOption{"kind", OptionKind::Word, "feet", 0, 0, "feet|point", "A kind."},
    UriOption{"path", OptionKind::File, "", 0, 0, "", "A file."},
    UriOption{"steps_mm", OptionKind::Numbers, "", 1, 10, "", "Some lengths."},
    UriOption{"label", OptionKind::Text, "", 0, 0, "", "Any text."},
};

core::Result<UriOptions> read(const std::string& text) { return UriOptions::read(*DeviceUri::parse(text), kTable); }

TEST(UriOptions, NothingGiven_Defaults) {
  const auto options = read("a:b");

  ASSERT_TRUE(options.has_value());
  EXPECT_EQ(options->number("load_n"), 5.5);
  EXPECT_EQ(options->number("count"), 2.0);
  EXPECT_TRUE(std::isinf(options->number("end_s")));
  EXPECT_EQ(options->text("kind"), "feet");
  EXPECT_EQ(options->text("path"), "");
  EXPECT_FALSE(options->is_given("load_n"));
}

TEST(UriOptions, Given_Taken) {
  const auto options = read("a:b?load_n=1e0&count=4&end_s=3.25&kind=point&path=x/y.csv");

  ASSERT_TRUE(options.has_value());
  EXPECT_EQ(options->number("load_n"), 1.0);
  EXPECT_EQ(options->number("count"), 4.0);
  EXPECT_EQ(options->number("end_s"), 3.25);
  EXPECT_EQ(options->text("kind"), "point");
  EXPECT_EQ(options->text("path"), "x/y.csv");
  EXPECT_TRUE(options->is_given("load_n"));
}

TEST(UriOptions, NumbersSeparatedByCommasAndAnyTextButNone) {
  EXPECT_EQ(read("a:b?steps_mm=1,2.5,10")->numbers("steps_mm"), (std::vector<double>{1.0, 2.5, 10.0}));
  EXPECT_EQ(read("a:b?steps_mm=7")->numbers("steps_mm"), (std::vector<double>{7.0}));
  EXPECT_FALSE(read("a:b")->is_given("steps_mm"));
  EXPECT_EQ(read("a:b?label=01AB cd|7")->text("label"), "01AB cd|7");
  EXPECT_EQ(read("a:b")->text("label"), "");
  std::string many = "a:b?steps_mm=1";
  for (int i = 1; i < 256; ++i) many += ",1";
  EXPECT_EQ(read(many)->numbers("steps_mm").size(), 256U);
  EXPECT_EQ(read(many + ",1").error().hint, "write numbers separated by commas, at most 256");
}

TEST(UriOptions, Described_OneEntryPerOption) {
  const std::string text = describe_options(kTable);

  EXPECT_EQ(text,
            "  load_n=1..10  [5.5]\n      A load.\n"
            "  count=0..4 (whole number)  [2]\n      A count.\n"
            "  end_s=0.. or never  [never]\n      An end.\n"
            "  kind=feet|point  [feet]\n      A kind.\n"
            "  path=FILE\n      A file.\n"
            "  steps_mm=1..10,...\n      Some lengths.\n"
            "  label=TEXT\n      Any text.\n");
}

}  // namespace
}  // namespace dts::device
