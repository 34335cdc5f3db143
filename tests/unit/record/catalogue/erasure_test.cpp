// SPDX-License-Identifier: Apache-2.0
#include "record/catalogue/erasure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "record/xdf/xdf_writer.h"
#include "unit/record/catalogue/catalogue_fixture.h"

namespace dts::record {
namespace {

using catalogue_test::code;
using catalogue_test::facts;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class ErasureTest : public catalogue_test::CatalogueFixture {
 protected:
  ErasureTest() { std::filesystem::create_directories(path("sessions/inner")); }
  void put(const std::string& name) const { std::ofstream(path(name)) << "12345"; }
  void put_recording(const std::string& name, const std::string& id) const {
    auto writer = XdfWriter::create(path(name), to_facts(facts(id)));
    ASSERT_TRUE(writer);
    ASSERT_TRUE((*writer)->close());
  }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_)) {
      if (!entry.is_directory()) names.push_back(entry.path().lexically_relative(folder_).string());
    }
    std::ranges::sort(names);
    return names;
  }
  Erased remove(const std::vector<std::string>& ids) {
    const auto removed = remove_session_files(path("sessions"), ids, [] { return true; });
    EXPECT_TRUE(removed) << removed.error().what;
    return removed.value_or(Erased{});
  }
};

TEST_F(ErasureTest, AllFilesOfASessionAreRemoved_AndNoOthers) {
  for (const char* name : {"s-1.xdf", "s-1.xdf.idx", "s-1.2.xdf.part", "s-1.recovered.xdf", "s-1.corrections.json", "inner/s-1.3.xdf",
                           "s-10.xdf", "s-1", "xs-1.xdf", "s-2.xdf"}) {
    put("sessions/" + std::string(name));
  }
  const Erased erased = remove({"s-1"});
  EXPECT_EQ(erased.files, 6U);
  EXPECT_EQ(erased.bytes, 30U);
  EXPECT_THAT(erased.left, IsEmpty());
  EXPECT_THAT(files(), ElementsAre("sessions/s-1", "sessions/s-10.xdf", "sessions/s-2.xdf", "sessions/xs-1.xdf"));
  EXPECT_EQ(remove({"s-1"}).files, 0U) << "again";
}

TEST_F(ErasureTest, ARecordingWithAnotherNameIsFoundByItsHeader) {
  put_recording("sessions/inner/copy.xdf", "s-1");
  put_recording("sessions/other.xdf", "s-2");
  EXPECT_EQ(remove({"s-1"}).files, 2U);
  EXPECT_THAT(files(), ElementsAre("sessions/other.xdf", "sessions/other.xdf.idx"));
}

TEST_F(ErasureTest, NothingBehindALinkIsRemoved) {
  std::filesystem::create_directory(path("outside"));
  put("outside/s-1.xdf");
  put("outside/target");
  put_recording("outside/header.xdf", "s-1");
  std::filesystem::create_directory_symlink(path("outside"), path("sessions/folder"));
  std::filesystem::create_symlink(path("outside/target"), path("sessions/s-1.xdf"));
  std::filesystem::create_symlink(path("outside/header.xdf"), path("sessions/link.xdf"));
  const Erased erased = remove({"s-1"});
  EXPECT_EQ(erased.files, 1U) << "the link itself";
  ASSERT_EQ(erased.left.size(), 1U);
  EXPECT_THAT(erased.left[0], HasSubstr("was a link"));
  for (const char* name : {"outside/s-1.xdf", "outside/target", "outside/header.xdf"})
    EXPECT_TRUE(std::filesystem::exists(path(name))) << name;
}

TEST_F(ErasureTest, AFileWithASecondNameIsReported) {
  put("elsewhere");
  std::filesystem::create_hard_link(path("elsewhere"), path("sessions/s-1.xdf"));
  const Erased erased = remove({"s-1"});
  EXPECT_EQ(erased.files, 1U);
  ASSERT_EQ(erased.left.size(), 1U);
  EXPECT_THAT(erased.left[0], HasSubstr("has another name"));
}

TEST_F(ErasureTest, StopsWhenItIsNotWanted) {
  put("sessions/s-1.xdf");
  EXPECT_EQ(code(remove_session_files(path("sessions"), {"s-1"}, [] { return false; })), core::ErrorCode::Failed);
  EXPECT_TRUE(std::filesystem::exists(path("sessions/s-1.xdf")));
  EXPECT_FALSE(remove_session_files(path("none"), {"s-1"}, [] { return true; }));
}

TEST_F(ErasureTest, TheJournalIsReadBack) {
  const Erasure erasure{.subject = "P017", .who = "local", .utc_ns = 7, .sessions = {"s1", "s2"}};
  EXPECT_FALSE(read_erasure(folder_)->has_value());
  ASSERT_TRUE(write_erasure(folder_, erasure));
  EXPECT_EQ(read_erasure(folder_).value(), erasure);
  ASSERT_TRUE(remove_erasure(folder_));
  EXPECT_FALSE(read_erasure(folder_)->has_value());
  ASSERT_TRUE(remove_erasure(folder_)) << "again";
  std::filesystem::create_symlink("erasure.json", path("erasure.json"));
  EXPECT_EQ(code(read_erasure(folder_)), core::ErrorCode::Failed) << "it cannot be looked at";
  ASSERT_TRUE(remove_erasure(folder_));
  for (const std::string text : {"", "{}", "[1]", "{\"subject\":\"\",\"who\":\"w\",\"utc_ns\":1,\"sessions\":[]}",
                                 "{\"subject\":\"P\",\"who\":\"w\",\"utc_ns\":1,\"sessions\":[3]}"}) {
    std::ofstream(path("erasure.json")) << text;
    EXPECT_EQ(code(read_erasure(folder_)), core::ErrorCode::DataDamaged) << text;
  }
}

TEST_F(ErasureTest, AMentionStandsAlone) {
  EXPECT_EQ(without_mention("see P017.", "P017"), "see [erased].");
  EXPECT_EQ(without_mention("P017,P017", "P017"), "[erased],[erased]");
  EXPECT_EQ(without_mention("P017-P018, see P017-", "P017"), "P017-P018, see [erased]-");
  EXPECT_EQ(without_mention("-P017-.", "P017"), "-[erased]-.");
  for (const std::string text : {"P0170", "xP017", "", "p017", "P017-2", "P017.b", "A-P017", "a.P017"})
    EXPECT_EQ(without_mention(text, "P017"), std::nullopt) << text;
  EXPECT_EQ(without_mention("text", ""), std::nullopt);
}

}  // namespace
}  // namespace dts::record
