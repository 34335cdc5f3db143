// SPDX-License-Identifier: Apache-2.0
// One call to the disk fails, somewhere in a little session. `scripts/fault inject` does it for every call.
#include "fault/injection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "fault/child_process.h"
#include "fault/recorded_session.h"
#include "fault/rigs.h"

namespace dts::fault {
namespace {

constexpr std::size_t kFaultsOfAKind = 6;  // some seconds in all

/// The first calls, the last ones, and some between: `count` of them.
std::vector<std::uint64_t> spread(std::uint64_t calls, std::size_t count) {
  std::vector<std::uint64_t> chosen;
  for (std::size_t i = 0; i < count && calls > 0; ++i) {
    const std::uint64_t nth = 1 + i * (calls - 1) / (count - 1);
    if (chosen.empty() || chosen.back() != nth) chosen.push_back(nth);
  }
  return chosen;
}

std::string only_recording(const std::string& folder) {
  for (const auto& entry : std::filesystem::directory_iterator(folder + "/sessions")) {
    if (entry.path().extension() == ".xdf") return entry.path();
  }
  return {};
}

/// Whoever looks afterwards must be able to find something.
TEST(Afterwards, OneByteOfACompleteRecordingChanged_IsFound) {
  RecordProperty("requirement", "REC-5");
  const TemporaryFolder folder;
  const Reference reference = little_reference();
  ASSERT_EQ(record_little_session(folder.path()), "");
  ASSERT_EQ(look_afterwards(folder.path(), reference).problem, "");
  const std::string file = only_recording(folder.path());
  std::filesystem::permissions(file, std::filesystem::perms::owner_write, std::filesystem::perm_options::add);

  std::fstream bytes(file, std::ios::binary | std::ios::in | std::ios::out);
  bytes.seekp(static_cast<std::streamoff>(std::filesystem::file_size(file) / 2));
  bytes.put('x');
  bytes.close();

  EXPECT_NE(look_afterwards(folder.path(), reference).problem, "");
}

TEST(Afterwards, OtherDevice_IsFound) {
  const TemporaryFolder folder;
  ASSERT_EQ(record_little_session(folder.path()), "");
  pipeline::RigConfig other = floor4_rig();
  other.device_uri = "sim:floor?seed=8";

  EXPECT_THAT(look_afterwards(folder.path(), Reference::compute(other, 60.0)).problem, ::testing::HasSubstr("simulator"));
}

class Injection : public ::testing::TestWithParam<Operation> {};

TEST_P(Injection, SpreadOverASession_NothingIsListedAsWhatItIsNot) {
  const Reference reference = little_reference();
  const CallCounts counts = count_calls(reference);
  ASSERT_EQ(counts.problem, "");
  const std::uint64_t calls = counts.calls[static_cast<std::size_t>(GetParam())];

  std::size_t struck = 0;
  std::size_t turn = 0;
  for (const std::uint64_t nth : spread(calls, kFaultsOfAKind)) {
    const Fault fault{.operation = GetParam(),
                      .nth = nth,
                      .error = kErrors[turn % kErrors.size()],
                      .is_lasting = (turn / kErrors.size() + turn) % 2 == 1};
    ++turn;
    const Injected injected = inject(fault, reference);
    EXPECT_EQ(injected.problem, "") << to_text(fault) << ", recording " << injected.outcome;
    struck += injected.has_struck ? 1 : 0;
  }

  EXPECT_TRUE(calls == 0 || struck > 0) << "no fault was reached: the session does not go through the faulty disk";
}

INSTANTIATE_TEST_SUITE_P(, Injection, ::testing::ValuesIn(kOperations), [](const auto& named) { return std::string(name(named.param)); });

}  // namespace
}  // namespace dts::fault
