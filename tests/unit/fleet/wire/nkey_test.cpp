// SPDX-License-Identifier: Apache-2.0
#include "fleet/wire/nkey.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>

#include "support/temporary_folder.h"

namespace dts::fleet::wire {
namespace {

// From the documentation of NATS (docs.nats.io, "NKeys").
constexpr const char* kKnownSeed = "SUACSSL3UAHUDXKFSNVUZRF5UHPMWZ6BFDTJ7M6USDXIEDNPPQYYYCU3VY";
constexpr const char* kKnownPublic = "UDXU4RCSJNZOIQHZNWXHXORDPRTGNJAHAHFRGZNEEJCPQTT2M7NLCNF4";

TEST(NKeyTest, AKnownSeedHasItsPublicKey) {
  const auto key = nkey_of_seed(kKnownSeed);
  ASSERT_TRUE(key);
  EXPECT_EQ(key->public_key, kKnownPublic);
  EXPECT_EQ(key->seed, kKnownSeed);
  EXPECT_TRUE(is_public_nkey(kKnownPublic));
}

TEST(NKeyTest, EveryChangedLetterIsNoticed) {
  for (std::size_t place = 0; place < 56; ++place) {
    std::string seed = kKnownSeed;
    seed[place] = seed[place] == 'A' ? 'B' : 'A';
    EXPECT_FALSE(nkey_of_seed(seed)) << place;
    std::string key = kKnownPublic;
    key[place] = key[place] == 'A' ? 'B' : 'A';
    EXPECT_FALSE(is_public_nkey(key)) << place;
  }
  for (const char* const text : {"", "SU", "udxu4rcsjnzoiqhznwxhxordprtgnjahahfrgzneejcpqtt2m7nlcnf4", kKnownSeed})
    EXPECT_FALSE(is_public_nkey(text));
  EXPECT_FALSE(nkey_of_seed(kKnownPublic));
  EXPECT_FALSE(nkey_of_seed(std::string(kKnownSeed) + "A"));
}

TEST(NKeyTest, NewKeysDiffer) {
  const NKey first = create_nkey();
  const NKey second = create_nkey();
  EXPECT_NE(first.seed, second.seed);
  EXPECT_TRUE(is_public_nkey(first.public_key));
  EXPECT_EQ(nkey_of_seed(first.seed)->public_key, first.public_key);
}

TEST(NKeyTest, AFileKeepsItsKey) {
  const test::TemporaryFolder folder;
  const std::string file = folder.path() + "/kent.nk";
  const auto created = read_or_create_nkey(file);
  ASSERT_TRUE(created);
  struct stat found {};
  ASSERT_EQ(::stat(file.c_str(), &found), 0);
  EXPECT_EQ(found.st_mode & 0777U, 0600U);
  EXPECT_EQ(read_or_create_nkey(file)->seed, created->seed);
  EXPECT_EQ(read_nkey(file)->public_key, created->public_key);
}

TEST(NKeyTest, AFileThatOthersCanReadIsRejected) {
  const test::TemporaryFolder folder;
  const std::string file = folder.path() + "/kent.nk";
  ASSERT_TRUE(read_or_create_nkey(file));
  ASSERT_EQ(::chmod(file.c_str(), 0640), 0);
  EXPECT_EQ(read_nkey(file).error().code, core::ErrorCode::NotAllowed);
}

TEST(NKeyTest, AFileOfAnotherUser_IsNamedWithWhatToDo) {
  if (::getuid() != 0) GTEST_SKIP() << "only root can act as another user";
  const test::TemporaryFolder folder;
  const std::string file = folder.path() + "/kent.nk";
  ASSERT_TRUE(read_or_create_nkey(file));
  constexpr uid_t kNobody = 65534;
  ASSERT_EQ(::seteuid(kNobody), 0);
  const auto read = read_nkey(file);
  ASSERT_EQ(::seteuid(0), 0);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().hint, "its owner must be the user of this program: chown USER " + file);
}

TEST(NKeyTest, AFileWithAnythingElseIsRejected) {
  const test::TemporaryFolder folder;
  const std::string file = folder.path() + "/kent.nk";
  EXPECT_EQ(read_nkey(file).error().code, core::ErrorCode::NotFound);
  std::ofstream(file) << kKnownSeed << "\n\n";
  ASSERT_EQ(::chmod(file.c_str(), 0600), 0);
  const auto read = read_nkey(file);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().what.find(file), std::string::npos);
  EXPECT_EQ(read_or_create_nkey(file).error().code, core::ErrorCode::InvalidArgument);
}

}  // namespace
}  // namespace dts::fleet::wire
