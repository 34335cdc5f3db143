// SPDX-License-Identifier: Apache-2.0
#include "fleet/worker/stored_recording.h"

#include <fcntl.h>
#include <sodium.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

namespace dts::fleet::worker {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 20U;

std::string hexadecimal(crypto_hash_sha256_state& state) {
  std::array<unsigned char, crypto_hash_sha256_BYTES> hash{};
  crypto_hash_sha256_final(&state, hash.data());
  std::array<char, 2 * crypto_hash_sha256_BYTES + 1> text{};
  sodium_bin2hex(text.data(), text.size(), hash.data(), hash.size());
  return text.data();
}

core::Result<std::string> sha256_of_open(int descriptor, const std::string& file, const std::function<bool()>& keeps_on) {
  crypto_hash_sha256_state state{};
  crypto_hash_sha256_init(&state);
  std::vector<unsigned char> block(kBlock);
  while (true) {
    const auto count = ::read(descriptor, block.data(), block.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return core::fail_errno(errno, "cannot read '" + file + "'", "check the disk of the store");
    if (count == 0) return hexadecimal(state);
    crypto_hash_sha256_update(&state, block.data(), static_cast<std::size_t>(count));
    if (!keeps_on()) return core::fail(core::ErrorCode::WrongState, "the check of '" + file + "' was stopped");
  }
}

}  // namespace

core::Result<std::string> stored_file(const std::string& directory, const std::string& key) {
  if (key.empty()) return core::fail(core::ErrorCode::NotFound, "the catalogue has no recording of this part");
  const std::filesystem::path path(key);
  for (const auto& step : path) {
    if (step == ".." || step == "/") return core::fail(core::ErrorCode::DataDamaged, "the catalogue has a wrong store key");
  }
  return directory + "/" + key;
}

core::Status check_sha256(const std::string& file, const std::string& sha256, const std::function<bool()>& keeps_on) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (descriptor < 0) return core::fail_errno(errno, "cannot open '" + file + "'", "check [store] directory in the configuration");
  const auto found = sha256_of_open(descriptor, file, keeps_on);
  ::close(descriptor);
  DTS_TRY(found);
  if (*found == sha256) return {};
  return core::fail(core::ErrorCode::DataDamaged, "'" + file + "' is not the recording that the catalogue names: its SHA-256 differs",
                    "check the disk of the store");
}

core::Result<RecordingName> RecordingName::in_new_folder() {
  std::error_code error;
  std::string folder = (std::filesystem::temp_directory_path(error) / "dts-worker-XXXXXX").string();
  if (error || ::mkdtemp(folder.data()) == nullptr) return core::fail_errno(errno, "cannot make the folder '" + folder + "'");
  return RecordingName(std::move(folder));
}

core::Result<RecordingName> RecordingName::fetch(s3::Bucket& bucket, const std::string& key, const std::function<bool()>& keeps_on) {
  if (key.empty()) return core::fail(core::ErrorCode::NotFound, "the catalogue has no recording of this part");
  DTS_TRY_ASSIGN(RecordingName name, in_new_folder());
  DTS_TRY(bucket.get(key, name.path(), keeps_on));
  return name;
}

core::Result<RecordingName> RecordingName::create(const std::string& file) {
  DTS_TRY_ASSIGN(RecordingName name, in_new_folder());
  if (::symlink(file.c_str(), name.path().c_str()) != 0) return core::fail_errno(errno, "cannot make the link '" + name.path() + "'");
  return name;
}

RecordingName::RecordingName(RecordingName&& other) noexcept : folder_(std::exchange(other.folder_, {})) {}

RecordingName::~RecordingName() {
  if (folder_.empty()) return;
  ::unlink(path().c_str());
  ::rmdir(folder_.c_str());
}

}  // namespace dts::fleet::worker
