// SPDX-License-Identifier: Apache-2.0
#include "fleet/hub/durable_file.h"

#include <fcntl.h>
#include <openssl/evp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <memory>
#include <vector>

namespace dts::fleet::hub {
namespace {

constexpr std::size_t kReadBytes = 256 * 1024;
constexpr std::size_t kSha256Bytes = 32;
constexpr mode_t kFolderMode = 0750;

class Descriptor {
 public:
  Descriptor(const std::string& path, int flags) : number_(::open(path.c_str(), flags | O_CLOEXEC | O_NOFOLLOW)) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  Descriptor(Descriptor&&) = delete;
  Descriptor& operator=(Descriptor&&) = delete;
  [[nodiscard]] int number() const noexcept { return number_; }

 private:
  int number_;
};

std::string folder_of(const std::string& path) { return std::filesystem::path(path).parent_path().string(); }

}  // namespace

core::Status synchronise(const std::string& path) {
  const Descriptor file(path, O_RDONLY);
  if (file.number() < 0 || ::fsync(file.number()) != 0)
    return core::fail_errno(errno, "cannot synchronise '" + path + "'", "check the disk");
  return {};
}

core::Result<std::string> sha256_from_disk(const std::string& file, const std::stop_token& stop) {
  const Descriptor opened(file, O_RDONLY);
  if (opened.number() < 0 && errno == ENOENT) return core::fail(core::ErrorCode::NotFound, "there is no file '" + file + "'");
  if (opened.number() < 0) return core::fail_errno(errno, "cannot read '" + file + "'", "check the disk");
  static_cast<void>(::posix_fadvise(opened.number(), 0, 0, POSIX_FADV_DONTNEED));
  static_cast<void>(::posix_fadvise(opened.number(), 0, 0, POSIX_FADV_SEQUENTIAL));
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> state(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
  bool is_computed = state && EVP_DigestInit_ex(state.get(), EVP_sha256(), nullptr) == 1;
  std::vector<unsigned char> buffer(kReadBytes);
  while (is_computed) {
    if (stop.stop_requested()) return core::fail(core::ErrorCode::Timeout, "the hub ends");
    const ssize_t got = ::read(opened.number(), buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return core::fail_errno(errno, "cannot read '" + file + "'", "check the disk");
    if (got == 0) break;
    is_computed = EVP_DigestUpdate(state.get(), buffer.data(), static_cast<std::size_t>(got)) == 1;
  }
  std::array<unsigned char, kSha256Bytes> digest{};
  unsigned int size = 0;
  is_computed = is_computed && EVP_DigestFinal_ex(state.get(), digest.data(), &size) == 1 && size == digest.size();
  if (!is_computed) return core::fail(core::ErrorCode::Failed, "OpenSSL does not compute the SHA-256 of '" + file + "'");
  return std::string(digest.begin(), digest.end());
}

core::Status create_folder(const std::string& folder) {
  struct stat status {};
  const std::string above = folder_of(folder);
  if (::stat(folder.c_str(), &status) == 0 && S_ISDIR(status.st_mode)) return above.empty() ? core::Status() : synchronise(above);
  if (!above.empty() && above != folder) DTS_TRY(create_folder(above));
  if (::mkdir(folder.c_str(), kFolderMode) != 0 && errno != EEXIST) {
    return core::fail_errno(errno, "cannot create the folder '" + folder + "'", "check that its parent is writable for the hub");
  }
  return above.empty() ? core::Status() : synchronise(above);
}

core::Result<bool> remove_file(const std::string& file) {
  if (::unlink(file.c_str()) == 0) {
    DTS_TRY(synchronise(folder_of(file)));
    return true;
  }
  if (errno == ENOENT || errno == ENOTDIR) return false;
  return core::fail_errno(errno, "cannot remove '" + file + "'", "remove it by hand");
}

}  // namespace dts::fleet::hub
