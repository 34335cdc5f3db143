// SPDX-License-Identifier: Apache-2.0
#include "device/uri_options.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>

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

std::string option_refusal(const std::string& text) {
  const auto options = read(text);
  return options ? "" : core::to_string(options.error());
}

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
  EXPECT_NE(option_refusal("a:b?label=").find("TEXT"), std::string::npos);
}

TEST(UriOptions, WrongValueOrName_RefusedWithWhatIsAllowed) {
  std::string many = "1";
  for (int i = 0; i < 256; ++i) many += ",1";
  for (const std::string& value :
       {std::string("1,11"), std::string("1,,2"), std::string("1,"), std::string(""), std::string("1,nan"), many}) {
    EXPECT_NE(option_refusal("a:b?steps_mm=" + value).find("1..10,..."), std::string::npos) << value;
  }
  for (const char* value : {"0.999", "10.001", "-5", "", "abc", "5N", " 5", "nan", "inf", "1e999", "never", "0x5"}) {
    const std::string what = option_refusal(std::string("a:b?load_n=") + value);
    EXPECT_NE(what.find("load_n = \"" + std::string(value) + "\""), std::string::npos) << what;
    EXPECT_NE(what.find("1..10"), std::string::npos) << what;
  }
  for (const auto& [option, reason] : {std::pair{"count=1.5", "whole number"},
                                       {"kind=foot", "feet|point"},
                                       {"kind=pont", "did you mean \"point\"?"},
                                       {"kind=feet|point", "feet|point"},
                                       {"path=", "path"},
                                       {"laod_n=3", "did you mean \"load_n\"?"},
                                       {"laod_n=3", "load_n, count, end_s, kind, path"}}) {
    EXPECT_NE(option_refusal(std::string("a:b?") + option).find(reason), std::string::npos) << option;
  }
}

TEST(UriOptions, SeveralMistakes_AllToldAtOnce) {
  const std::string what = option_refusal("a:b?laod_n=3&knd=feet&count=1.5&kind=pont");

  for (const char* const part :
       {"unknown option \"laod_n\"", "unknown option \"knd\"", "did you mean \"load_n\"?", "whole number", "did you mean \"point\"?"}) {
    EXPECT_NE(what.find(part), std::string::npos) << part << " in " << what;
  }
  EXPECT_EQ(what.find("Known: "), what.rfind("Known: ")) << what;
  EXPECT_EQ(what.find("device \"a:b"), what.rfind("device \"a:b")) << what;
}

TEST(UriOptions, Described_OneEntryPerOption) {
  const std::string text = describe_options(kTable);

  EXPECT_NE(text.find("load_n=1..10  [5.5]"), std::string::npos);
  EXPECT_NE(text.find("count=0..4 (whole number)  [2]"), std::string::npos);
  EXPECT_NE(text.find("end_s=0.. or never  [never]"), std::string::npos);
  EXPECT_NE(text.find("path=FILE\n      A file."), std::string::npos);
}

}  // namespace
}  // namespace dts::device
