// SPDX-License-Identifier: Apache-2.0
// forward.toml and its enrolment file.
#include "fleet/forward/settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "support/temporary_folder.h"

namespace dts::fleet::forward {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class SettingsTest : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() + "/" + name) << text;
    return folder_.path() + "/" + name;
  }
  Settings load(const std::string& text, bool is_enrolled = true) {
    problems_.clear();
    return load_settings(write("forward.toml", text), is_enrolled, problems_);
  }
  /// The only problem, as a person sees it.
  std::string problem(const std::string& text) {
    (void)load(text);
    if (problems_.size() != 1) return std::to_string(problems_.size()) + " problems";
    return files::to_string(problems_.front()).substr(folder_.path().size());
  }

  test::TemporaryFolder folder_;
  std::string enrolment_ = write("kent.toml", "clinic = \"kent\"\nservers = [\"tls://127.0.0.1:4222\"]\nca = \"\"\"PEM\"\"\"\n");
  files::Problems problems_;
  std::string base_ = "enrolment = \"kent.toml\"\nkey = \"kent.nk\"\n";
};

TEST_F(SettingsTest, AllKeys_AreRead) {
  const Settings settings = load(base_ +
                                 "state = \"/var/lib/x\"\n[daemon]\ncontrol = \"ipc:///c.sock\"\ndata = \"ipc:///d.sock\"\n"
                                 "[upload]\nmax_rate = \"4 Mbit/s\"\nmax_rate_in_session = \"500 kbit/s\"\nonly_between = \"20:00-06:00\"\n"
                                 "[privacy]\nsend_labels = true\nsend_fields = [\"weight_kg\"]\n[live]\nallowed = false\n");
  EXPECT_THAT(problems_, testing::IsEmpty());
  EXPECT_EQ(settings.clinic, "kent");
  EXPECT_THAT(settings.servers, ElementsAre("tls://127.0.0.1:4222"));
  EXPECT_EQ(settings.ca_pem, "PEM");
  EXPECT_EQ(settings.key_file, folder_.path() + "/kent.nk");
  EXPECT_EQ(settings.state_folder, "/var/lib/x");
  EXPECT_EQ(settings.daemon.control, "ipc:///c.sock");
  EXPECT_EQ(settings.daemon.data, "ipc:///d.sock");
  EXPECT_EQ(settings.upload.rate, 500'000.0);
  EXPECT_EQ(settings.upload.rate_in_session, 62'500.0);
  EXPECT_TRUE(settings.upload.hours);
  EXPECT_TRUE(settings.rules.labels);
  EXPECT_THAT(settings.rules.fields, ElementsAre("weight_kg"));
  EXPECT_FALSE(settings.is_live_allowed);
}

TEST_F(SettingsTest, WithoutFurtherKeys_NothingThatAPersonTypedLeaves) {
  const Settings settings = load(base_);
  EXPECT_THAT(problems_, testing::IsEmpty());
  EXPECT_FALSE(settings.rules.labels);
  EXPECT_THAT(settings.rules.fields, testing::IsEmpty());
  EXPECT_FALSE(settings.upload.rate);
  EXPECT_FALSE(settings.upload.hours);
  EXPECT_TRUE(settings.is_live_allowed);
  EXPECT_EQ(settings.state_folder, "/var/lib/dts-forward");
}

TEST_F(SettingsTest, Problems_HaveTheirPlace) {
  EXPECT_EQ(problem(base_ + "[upload]\nmax_rate = \"4 MB\"\n"),
            "/forward.toml:4:12: max_rate must be a rate of at least 8 kbit/s, such as \"4 Mbit/s\" or \"500 kbit/s\"");
  EXPECT_THAT(problem(base_ + "[upload]\nonly_between = \"20-6\"\n"), HasSubstr("only_between must be two different times of the day"));
  EXPECT_THAT(problem(base_ + "[privacy]\nsend_label = true\n"), HasSubstr("send_labels"));
  EXPECT_THAT(problem("key = \"kent.nk\"\n"), HasSubstr("enrolment is missing"));
  EXPECT_THAT(problem("enrolment = \"kent.toml\"\n"), HasSubstr("key is missing"));
  EXPECT_THAT(problem("enrolment = \"lund.toml\"\nkey = \"x\"\n"),
              HasSubstr("lund.toml does not exist: the centre makes it with dts-fleet clinic add"));
}

TEST_F(SettingsTest, EnrolmentOfAnotherForm_IsAProblem) {
  write("kent.toml", "clinic = \"Kent!\"\nservers = []\n");
  (void)load(base_);
  ASSERT_EQ(problems_.size(), 2U);
  EXPECT_THAT(problems_[0].text, HasSubstr("1 to 32 of a-z, 0-9 and -"));
  EXPECT_THAT(problems_[1].text, HasSubstr("1 to 16 addresses"));
}

TEST_F(SettingsTest, BeforeTheEnrolment_KeyIsKnown) {
  const Settings settings = load("enrolment = \"not-there-yet.toml\"\nkey = \"kent.nk\"\n", false);
  EXPECT_THAT(problems_, testing::IsEmpty());
  EXPECT_EQ(settings.key_file, folder_.path() + "/kent.nk");
}

TEST(RateOfText, Rates) {
  EXPECT_EQ(rate_of_text("8 kbit/s"), 1000.0);
  EXPECT_EQ(rate_of_text("1.5 Mbit/s"), 187'500.0);
  EXPECT_EQ(rate_of_text("1 Gbit/s"), 125e6);
  for (const char* wrong :
       {"", "4", "4Mbit/s", " Mbit/s", "-4 Mbit/s", "nan Mbit/s", "inf Mbit/s", "1e400 Mbit/s", "7 kbit/s", "4 mbit/s", "99999 Gbit/s"}) {
    EXPECT_FALSE(rate_of_text(wrong)) << wrong;
  }
}

TEST(HoursOfText, HoursOverMidnight_ContainBothSides) {
  const auto hours = hours_of_text("20:00-06:30");
  ASSERT_TRUE(hours);
  const auto contains = [&hours](int hour, int minute) { return hours->contains(std::chrono::hours(hour) + std::chrono::minutes(minute)); };
  EXPECT_TRUE(contains(20, 0));
  EXPECT_TRUE(contains(0, 0));
  EXPECT_TRUE(contains(6, 29));
  EXPECT_FALSE(contains(6, 30));
  EXPECT_FALSE(contains(19, 59));
  EXPECT_TRUE(hours_of_text("06:00-20:00")->contains(std::chrono::hours(12)));
  EXPECT_FALSE(hours_of_text("06:00-20:00")->contains(std::chrono::hours(20)));
  for (const char* wrong : {"", "20:00", "20:00-20:00", "24:00-06:00", "20:60-06:00", "2:00-06:00x", "20:00 06:00", "aa:00-06:00"}) {
    EXPECT_FALSE(hours_of_text(wrong)) << wrong;
  }
}

}  // namespace
}  // namespace dts::fleet::forward
