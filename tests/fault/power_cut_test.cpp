// SPDX-License-Identifier: Apache-2.0
#include "fault/power_cut.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

#include "fault/child_process.h"
#include "fault/durable_model.h"
#include "fault/logged_disk.h"
#include "fault/rigs.h"

namespace dts::fault {
namespace {

/// The model has to be able to find something: of this only the first half was made durable.
TEST(DurableModel, WrittenAfterTheLastSynchronisation_IsGone) {
  const TemporaryFolder folder;
  DurableModel model(folder.path());
  FaultyDisk disk(folder.path());
  disk.on_synchronise = [&](int descriptor, const std::string& path) { return model.synchronising(descriptor, path); };
  const int parent = ::open(folder.path().c_str(), O_RDONLY | O_DIRECTORY);
  const int file = ::open((folder.path() + "/kept").c_str(), O_WRONLY | O_CREAT, 0600);
  const int unnamed = ::open((folder.path() + "/unnamed").c_str(), O_WRONLY | O_CREAT, 0600);

  ASSERT_EQ(::write(file, "durable", 7), 7);
  ASSERT_EQ(::fdatasync(file), 0);
  ::unlink((folder.path() + "/unnamed").c_str());
  ASSERT_EQ(::fsync(parent), 0);
  ASSERT_EQ(::write(file, " and not", 8), 8);
  ASSERT_EQ(::rename((folder.path() + "/kept").c_str(), (folder.path() + "/renamed").c_str()), 0);
  const DurableModel::Survivors survivors = model.cut();
  for (const int descriptor : {parent, file, unnamed}) ::close(descriptor);

  ASSERT_EQ(survivors.size(), 1U);
  EXPECT_EQ(survivors.begin()->first, "kept");  // the folder was not synchronised after the change of its name
  EXPECT_EQ(*survivors.begin()->second, "durable");
}

/// Sectors of 512 bytes that hold `letter`, of a disk of 16 sectors.
std::size_t sectors_of(char letter, std::span<const DiskEvent> events, std::uint32_t seed) {
  const TemporaryFolder folder;
  const std::string image = folder.path() + "/image";
  std::ofstream(image).close();
  std::filesystem::resize_file(image, 16 * 512);
  std::mt19937 random(seed);
  write_survivors(events, random, image);
  std::ifstream file(image, std::ios::binary);
  const std::string content{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  return static_cast<std::size_t>(std::ranges::count(content, letter)) / 512;
}

TEST(LoggedDisk, WrittenBeforeTheLastFlush_IsKept_AfterIt_MayBeLostOrTorn) {
  const std::vector<DiskEvent> events{{.offset = 0, .bytes = std::vector<char>(4 * 512, 'a')},
                                      {.is_flush = true},
                                      {.offset = 4 * 512, .bytes = std::vector<char>(8 * 512, 'b')}};
  std::size_t whole = 0, lost = 0, torn = 0;

  for (std::uint32_t seed = 0; seed < 100; ++seed) {
    EXPECT_EQ(sectors_of('a', events, seed), 4U) << "seed " << seed;
    const std::size_t kept = sectors_of('b', events, seed);
    ++(kept == 8 ? whole : kept == 0 ? lost : torn);
  }

  EXPECT_GT(whole, 0U);
  EXPECT_GT(lost, 0U);
  EXPECT_GT(torn, 0U);
}

TEST(PowerCut, AtRandomMoments_LosesAtMostASecondAndNothingBeforeIt) {
  RecordProperty("requirement", "REC-3");
  const Reference reference = Reference::compute(floor16_rig(), 60.0);

  const auto cuts = cut_power(6.0, 20, std::random_device()(), reference);

  ASSERT_EQ(cuts.size(), 20U);
  for (const PowerCut& cut : cuts) EXPECT_EQ(cut.problem, "") << "after " << cut.recorded_s << " s, " << cut.lost_s << " s lost";
}

}  // namespace
}  // namespace dts::fault
