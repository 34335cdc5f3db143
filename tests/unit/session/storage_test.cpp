// SPDX-License-Identifier: Apache-2.0
#include "session/storage.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace dts::session {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class StorageTest : public testing::Test {
 protected:
  StorageTest() {
    std::string name = (std::filesystem::temp_directory_path() / "dts-storage-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    config_ = {.directory = (folder_ / "state").string(), .refuse_below_min = 10.0, .warn_below_min = 60.0, .stop_below_mib = 0.0};
  }
  ~StorageTest() override { std::filesystem::remove_all(folder_); }

  /// With a rate at which the disk has room for `min` minutes, give or take what others write meanwhile.
  DiskView with_room_for(double min) const {
    const DiskView view = look_at_disk(config_, 1.0);
    return look_at_disk(config_, view.recordable_s / (min * 60.0));
  }

  std::filesystem::path folder_;
  StorageConfig config_;
};

TEST_F(StorageTest, Room_IsJudgedByHowLongOneCanRecord) {
  ASSERT_TRUE(prepare_storage(config_));
  const DiskView fine = with_room_for(70.0);
  EXPECT_EQ(fine.state, DiskState::Fine);
  EXPECT_EQ(fine.problem, "");
  EXPECT_NEAR(fine.recordable_s, 70.0 * 60.0, 60.0);
  EXPECT_EQ(fine.directory, config_.directory + "/sessions");
  const DiskView low = with_room_for(50.0);
  EXPECT_EQ(low.state, DiskState::Low);
  EXPECT_THAT(low.problem, AllOf(HasSubstr(low.directory), testing::ContainsRegex("room for only (49|50|51) min of recording"),
                                 HasSubstr("DTSD_STATE_DIR")));
  EXPECT_EQ(with_room_for(11.0).state, DiskState::Low);
  const DiskView full = with_room_for(8.0);
  EXPECT_EQ(full.state, DiskState::Full);
  EXPECT_THAT(full.problem, AllOf(testing::ContainsRegex("room for [789] min of recording"), HasSubstr("a session needs at least 10 min")));
  EXPECT_EQ(look_at_disk(config_, 0.0).state, DiskState::Fine) << "without a rig nothing is recorded";
}

TEST_F(StorageTest, WhatIsKeptFree_IsNoRoom) {
  ASSERT_TRUE(prepare_storage(config_));
  const double free_mib = static_cast<double>(look_at_disk(config_, 1.0).free_bytes) / (1024.0 * 1024.0);
  config_.stop_below_mib = free_mib / 2.0;
  EXPECT_NEAR(look_at_disk(config_, 1024.0 * 1024.0).recordable_s, free_mib / 2.0, free_mib * 0.05);
  config_.stop_below_mib = free_mib * 2.0;
  EXPECT_EQ(look_at_disk(config_, 1.0).recordable_s, 0.0);
  EXPECT_EQ(look_at_disk(config_, 1.0).state, DiskState::Full);
  config_.refuse_below_min = 0.0;
  EXPECT_EQ(look_at_disk(config_, 1.0).state, DiskState::Low);
  config_.warn_below_min = 0.0;
  EXPECT_EQ(look_at_disk(config_, 1.0).state, DiskState::Fine) << "nobody asked for any room";
}

TEST_F(StorageTest, Folder_IsMadeForTheGroupOrSaysWhyNot) {
  const DiskView none = look_at_disk(config_, 1.0);
  EXPECT_EQ(none.state, DiskState::Unusable);
  EXPECT_THAT(none.problem, AllOf(HasSubstr(none.directory), HasSubstr("No such file")));
  const mode_t before = ::umask(0);
  ASSERT_TRUE(prepare_storage(config_));
  ASSERT_TRUE(prepare_storage(config_)) << "a second time too";
  ::umask(before);
  struct stat facts {};
  ASSERT_EQ(::stat((config_.directory + "/sessions").c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 07777U, 0750U);

  config_.directory = (folder_ / "file").string();
  std::ofstream(config_.directory) << "x";
  const auto refused = prepare_storage(config_);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, AllOf(HasSubstr("the folder for recordings, " + config_.directory + "/sessions, cannot be made"),
                                          HasSubstr("Not a directory")));
  EXPECT_THAT(refused.error().hint, HasSubstr("make room"));
}

}  // namespace
}  // namespace dts::session
