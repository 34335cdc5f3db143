// SPDX-License-Identifier: Apache-2.0
#include "fault/power_cut.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <random>

#include "fault/child_process.h"
#include "fault/durable_model.h"
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

TEST(PowerCut, AtRandomMoments_LosesAtMostASecondAndNothingBeforeIt) {
  RecordProperty("requirement", "REC-3");
  const Reference reference = Reference::compute(floor16_rig(), 60.0);

  const auto cuts = cut_power(6.0, 20, std::random_device()(), reference);

  ASSERT_EQ(cuts.size(), 20U);
  for (const PowerCut& cut : cuts) EXPECT_EQ(cut.problem, "") << "after " << cut.recorded_s << " s, " << cut.lost_s << " s lost";
}

}  // namespace
}  // namespace dts::fault
