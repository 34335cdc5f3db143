// SPDX-License-Identifier: Apache-2.0
#include "relay/fresh_keys.h"

#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <filesystem>
#include <sstream>

#include "unit/access/key_fixture.h"

namespace dts::relay {
namespace {

class FreshKeysTest : public access::KeyFixture {
 protected:
  [[nodiscard]] std::size_t count() {
    keys_->look();
    return keys_->store().keys().size();
  }
  [[nodiscard]] std::ptrdiff_t lines() const { return std::ranges::count(log_.str(), '\n'); }

  std::ostringstream log_;
  std::unique_ptr<FreshKeys> keys_ =
      FreshKeys::open(directory(),
                      core::Log(std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(log_))))
          .value();
};

TEST_F(FreshKeysTest, ChangesOfDtsd_AreSeenAtTheNextLook) {
  EXPECT_EQ(count(), 0U);
  ASSERT_TRUE(store_->add(access::key_for("eve", v1::ROLE_VIEWER)));
  EXPECT_EQ(count(), 1U);
  EXPECT_FALSE(keys_->store().take_losses());
  ASSERT_TRUE(store_->revoke("eve"));
  EXPECT_EQ(count(), 0U);
  EXPECT_TRUE(keys_->store().take_losses());
  ASSERT_TRUE(store_->add(access::key_for("eve", v1::ROLE_VIEWER)));
  EXPECT_EQ(count(), 1U);
  ASSERT_TRUE(std::filesystem::remove(client_file()));
  EXPECT_EQ(count(), 0U);
  const auto read = lines();
  EXPECT_EQ(count(), 0U);
  EXPECT_EQ(lines(), read) << "an unchanged file is not read again";
}

TEST_F(FreshKeysTest, DamagedFile_ChangesNothing_AndIsLoggedOnce) {
  ASSERT_TRUE(store_->add(access::key_for("eve", v1::ROLE_VIEWER)));
  EXPECT_EQ(count(), 1U);
  write(client_file(), "[[client]");
  const auto read = lines();
  for (int look = 0; look < 3; ++look) EXPECT_EQ(count(), 1U);
  EXPECT_EQ(lines(), read + 1);
  EXPECT_NE(log_.str().find("clients.toml:1:"), std::string::npos) << log_.str();
}

TEST_F(FreshKeysTest, WithoutTheKeyOfTheServer_NothingIsMade) {
  const auto opened = FreshKeys::open(folder_ + "/other", core::Log());

  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, core::ErrorCode::NotFound);
  EXPECT_FALSE(std::filesystem::exists(folder_ + "/other"));
}

}  // namespace
}  // namespace dts::relay
