// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zmq.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <utility>

#include "access/key_store.h"

namespace dts::access {

inline constexpr std::int64_t kSecondNs = 1'000'000'000;

struct KeyPair {
  std::string public_key;
  std::string secret_key;
};

inline KeyPair new_pair() {
  std::array<char, kKeyCharacters + 1> public_key{};
  std::array<char, kKeyCharacters + 1> secret_key{};
  EXPECT_EQ(zmq_curve_keypair(public_key.data(), secret_key.data()), 0);
  return {public_key.data(), secret_key.data()};
}

inline ClientKey key_for(const std::string& name, v1::Role role, const KeyPair& pair = new_pair()) {
  return {.name = name, .role = role, .public_key = pair.public_key, .created_utc = "2026-01-31T12:00:00Z"};
}

inline std::array<std::uint8_t, 32> bytes_of(const std::string& key) {
  std::array<std::uint8_t, 32> bytes{};
  EXPECT_NE(zmq_z85_decode(bytes.data(), key.c_str()), nullptr);
  return bytes;
}

/// A store in a folder of its own.
class KeyFixture : public ::testing::Test {
 protected:
  KeyFixture() {
    std::string folder = (std::filesystem::temp_directory_path() / "dts-keys-XXXXXX").string();
    EXPECT_NE(::mkdtemp(folder.data()), nullptr);
    folder_ = folder;
    auto store = KeyStore::open(directory());
    EXPECT_TRUE(store.has_value());
    store_ = std::move(*store);
  }
  ~KeyFixture() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string directory() const { return folder_ + "/keys"; }
  [[nodiscard]] std::string client_file() const { return directory() + "/clients.toml"; }
  [[nodiscard]] static std::string text_of(const std::string& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  }
  static void write(const std::string& file, const std::string& text) { std::ofstream(file) << text; }
  [[nodiscard]] static mode_t mode_of(const std::string& file) {
    struct stat found {};
    EXPECT_EQ(::stat(file.c_str(), &found), 0);
    return found.st_mode & 07777U;
  }

  std::string folder_;
  std::unique_ptr<KeyStore> store_;
};

}  // namespace dts::access
