// SPDX-License-Identifier: Apache-2.0
#include "fleet/hub/store.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "fleet/hub/durable_file.h"
#include "unit/fleet/hub/hub_fixture.h"

namespace dts::fleet::hub {
namespace {

namespace fs = std::filesystem;

class StoreTest : public testing::Test {
 protected:
  std::string new_file(const std::string& bytes) {
    std::string name = folder_.path() + "/file";
    std::ofstream(name, std::ios::binary) << bytes;
    return name;
  }
  test::TemporaryFolder folder_;
  std::unique_ptr<Store> store_ = open_folder_store(folder_.path() + "/store").value();
  const RecordingName name_{"kent", sum_of("abc")};
};

TEST_F(StoreTest, Put_MovesTheFile) {
  const std::string file = new_file("abc");
  EXPECT_EQ(store_->has(name_), false);
  EXPECT_FALSE(store_->file(name_).value());
  ASSERT_TRUE(store_->put(name_, file));
  EXPECT_FALSE(fs::exists(file));
  ASSERT_EQ(store_->has(name_), true);
  EXPECT_EQ(content_of(store_->file(name_).value()->path()), "abc");
  EXPECT_TRUE(store_->file(name_).value()->path().ends_with("/" + key_of(name_)));
  ASSERT_TRUE(store_->put(name_, new_file("abc")));  // again
  EXPECT_EQ(content_of(store_->file(name_).value()->path()), "abc");
}

TEST_F(StoreTest, Put_WithoutAFile_Fails) { EXPECT_FALSE(store_->put(name_, folder_.path() + "/nothing")); }

TEST_F(StoreTest, Remove_ReturnsWhetherThereWasOne) {
  EXPECT_EQ(store_->remove(name_), false);
  ASSERT_TRUE(store_->put(name_, new_file("abc")));
  EXPECT_EQ(store_->remove(name_), true);
  EXPECT_EQ(store_->has(name_), false);
  EXPECT_FALSE(store_->file(name_).value());
}

TEST_F(StoreTest, List_IgnoresWhatIsNoRecording) {
  ASSERT_TRUE(store_->put(name_, new_file("abc")));
  ASSERT_TRUE(store_->put({"leeds", name_.sha256}, new_file("abc")));
  fs::create_directories(folder_.path() + "/store/objects/Not a clinic");
  const fs::path file = store_->file(name_).value()->path();
  fs::copy_file(file, fs::path(folder_.path()) / "store/objects/Not a clinic" / file.filename());
  std::ofstream(folder_.path() + "/store/objects/kent/notes.txt") << "x";
  auto names = store_->list().value();
  std::ranges::sort(names);
  EXPECT_EQ(names, (std::vector<RecordingName>{name_, {"leeds", name_.sha256}}));
}

TEST_F(StoreTest, Sha256FromDisk_IsThatOfTheFile_AndStops) {
  const std::string file = new_file(std::string(1'000'000, 'x'));
  ASSERT_TRUE(synchronise(file));
  EXPECT_EQ(sha256_from_disk(file, {}), sum_of(std::string(1'000'000, 'x')));
  EXPECT_EQ(sha256_from_disk(file + "x", {}).error().code, core::ErrorCode::NotFound);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(sha256_from_disk(file, stop.get_token()).error().code, core::ErrorCode::Timeout);
}

}  // namespace
}  // namespace dts::fleet::hub
