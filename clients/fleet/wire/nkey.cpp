// SPDX-License-Identifier: Apache-2.0
#include "fleet/wire/nkey.h"

#include <fcntl.h>
#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/descriptor.h"

namespace dts::fleet::wire {
namespace {

static_assert(crypto_sign_SEEDBYTES == 32 && crypto_sign_PUBLICKEYBYTES == 32);

constexpr std::size_t kKeyBytes = 32;
constexpr std::size_t kCheckBytes = 2;
// Their first five bits are the first letter in base32: U for a user, S for a seed, whose letter is in the next five bits.
constexpr std::uint8_t kUser = 20U << 3U;
constexpr std::array<std::uint8_t, 2> kUserSeed{(18U << 3U) | (kUser >> 5U), (kUser & 31U) << 3U};
constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZ234567";
constexpr std::size_t kSeedLetters = 58;
constexpr std::size_t kPublicLetters = 56;

/// CRC-16/XMODEM, as NATS appends it.
std::uint16_t checksum(std::span<const std::uint8_t> bytes) noexcept {
  unsigned crc = 0;
  for (const std::uint8_t byte : bytes) {
    crc ^= static_cast<unsigned>(byte) << 8U;
    for (int bit = 0; bit < 8; ++bit) crc = (crc << 1U) ^ ((crc & 0x8000U) != 0 ? 0x1021U : 0U);
    crc &= 0xFFFFU;
  }
  return static_cast<std::uint16_t>(crc);
}

std::string base32(std::span<const std::uint8_t> bytes) {
  std::string text;
  unsigned waiting = 0;
  unsigned bits = 0;
  for (const std::uint8_t byte : bytes) {
    waiting = (waiting << 8U) | byte;
    for (bits += 8; bits >= 5; bits -= 5) text += kAlphabet[(waiting >> (bits - 5)) & 31U];
    waiting &= (1U << bits) - 1U;
  }
  if (bits > 0) text += kAlphabet[(waiting << (5 - bits)) & 31U];
  return text;
}

std::optional<std::vector<std::uint8_t>> bytes_of_base32(std::string_view text) {
  std::vector<std::uint8_t> bytes;
  unsigned waiting = 0;
  unsigned bits = 0;
  for (const char letter : text) {
    const std::size_t value = kAlphabet.find(letter);
    if (value == std::string_view::npos) return std::nullopt;
    waiting = (waiting << 5U) | static_cast<unsigned>(value);
    bits += 5;
    if (bits >= 8) {
      bits -= 8;
      bytes.push_back(static_cast<std::uint8_t>(waiting >> bits));
    }
    waiting &= (1U << bits) - 1U;
  }
  if (waiting != 0) return std::nullopt;  // the last letter has more bits than the last byte needs: they must be 0
  return bytes;
}

std::string encoded(std::span<const std::uint8_t> prefix, std::span<const std::uint8_t, kKeyBytes> key) {
  std::vector<std::uint8_t> bytes(prefix.begin(), prefix.end());
  bytes.insert(bytes.end(), key.begin(), key.end());
  const std::uint16_t check = checksum(bytes);
  bytes.push_back(static_cast<std::uint8_t>(check & 0xFFU));
  bytes.push_back(static_cast<std::uint8_t>(check >> 8U));
  return base32(bytes);
}

/// Returns the 32 bytes after the prefix, or nothing if the prefix, the length or the checksum is wrong.
std::optional<std::array<std::uint8_t, kKeyBytes>> decoded(std::string_view text, std::size_t letters,
                                                           std::span<const std::uint8_t> prefix) {
  if (text.size() != letters) return std::nullopt;
  const auto bytes = bytes_of_base32(text);
  if (!bytes || bytes->size() != prefix.size() + kKeyBytes + kCheckBytes) return std::nullopt;
  const std::span<const std::uint8_t> all(*bytes);
  const auto checked = all.first(all.size() - kCheckBytes);
  const unsigned check = all[checked.size()] | (static_cast<unsigned>(all[checked.size() + 1]) << 8U);
  if (checksum(checked) != check || !std::equal(prefix.begin(), prefix.end(), all.begin())) return std::nullopt;
  std::array<std::uint8_t, kKeyBytes> key{};
  std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(prefix.size()), kKeyBytes, key.begin());
  return key;
}

NKey key_of(const std::array<std::uint8_t, kKeyBytes>& seed) {
  std::array<std::uint8_t, crypto_sign_PUBLICKEYBYTES> public_key{};
  std::array<std::uint8_t, crypto_sign_SECRETKEYBYTES> secret_key{};
  crypto_sign_seed_keypair(public_key.data(), secret_key.data(), seed.data());
  sodium_memzero(secret_key.data(), secret_key.size());
  return {.public_key = encoded(std::span(&kUser, 1), public_key), .seed = encoded(kUserSeed, seed)};
}

}  // namespace

NKey create_nkey() {
  std::array<std::uint8_t, kKeyBytes> seed{};
  randombytes_buf(seed.data(), seed.size());
  return key_of(seed);
}

core::Result<NKey> nkey_of_seed(std::string_view seed) {
  const auto bytes = decoded(seed, kSeedLetters, kUserSeed);
  if (!bytes) return core::fail(core::ErrorCode::InvalidArgument, "not the seed of a key (it starts with SU and has 58 letters)");
  return key_of(*bytes);
}

core::Result<std::string> signature(std::string_view seed, std::string_view text) {
  const auto bytes = decoded(seed, kSeedLetters, kUserSeed);
  if (!bytes) return core::fail(core::ErrorCode::InvalidArgument, "not the seed of a key");
  std::array<std::uint8_t, crypto_sign_PUBLICKEYBYTES> public_key{};
  std::array<std::uint8_t, crypto_sign_SECRETKEYBYTES> secret_key{};
  std::array<std::uint8_t, crypto_sign_BYTES> signed_bytes{};
  crypto_sign_seed_keypair(public_key.data(), secret_key.data(), bytes->data());
  crypto_sign_detached(signed_bytes.data(), nullptr, reinterpret_cast<const unsigned char*>(text.data()), text.size(), secret_key.data());
  sodium_memzero(secret_key.data(), secret_key.size());
  constexpr int kVariant = sodium_base64_VARIANT_URLSAFE_NO_PADDING;
  std::string encoded_text(sodium_base64_ENCODED_LEN(crypto_sign_BYTES, kVariant), '\0');
  sodium_bin2base64(encoded_text.data(), encoded_text.size(), signed_bytes.data(), signed_bytes.size(), kVariant);
  encoded_text.pop_back();  // the terminating 0
  return encoded_text;
}

bool is_public_nkey(std::string_view text) { return decoded(text, kPublicLetters, std::span(&kUser, 1)).has_value(); }

core::Result<NKey> read_nkey(const std::string& file) {
  const core::Descriptor opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (opened.get() < 0) {
    const int reason = errno;
    return core::fail_errno(reason, "cannot read the key " + file,
                            reason == EACCES ? "its owner must be the user of this program: chown USER " + file : "");
  }
  struct stat found {};
  if (::fstat(opened.get(), &found) != 0) return core::fail_errno(errno, "cannot read the key " + file);
  if ((found.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
    return core::fail(core::ErrorCode::NotAllowed, "others can read the key " + file, "run: chmod 600 " + file);
  }
  std::array<char, kSeedLetters + 2> text{};  // room for a line end, and for what is too long
  const ssize_t length = ::read(opened.get(), text.data(), text.size());
  if (length < 0) return core::fail_errno(errno, "cannot read the key " + file);
  std::string_view seed(text.data(), static_cast<std::size_t>(length));
  if (seed.ends_with('\n')) seed.remove_suffix(1);
  auto key = nkey_of_seed(seed);
  sodium_memzero(text.data(), text.size());
  if (!key)
    return core::fail(key.error().code, file + ": " + key.error().what, "restore the file from your backup, or enrol the clinic again");
  return key;
}

core::Result<NKey> read_or_create_nkey(const std::string& file) {
  const NKey created = create_nkey();
  const std::string text = created.seed + "\n";
  // A file of this name is complete from the moment that it exists: link() does not replace another one.
  const std::string scratch = file + "." + std::to_string(::getpid()) + ".new";
  {
    const core::Descriptor opened(::open(scratch.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, S_IRUSR | S_IWUSR));
    if (opened.get() < 0) return core::fail_errno(errno, "cannot create the key " + file);
    if (::write(opened.get(), text.data(), text.size()) != static_cast<ssize_t>(text.size()) || ::fsync(opened.get()) != 0) {
      const int reason = errno;
      ::unlink(scratch.c_str());
      return core::fail_errno(reason, "cannot write the key " + file);
    }
  }
  const bool is_new = ::link(scratch.c_str(), file.c_str()) == 0;
  const int reason = errno;
  ::unlink(scratch.c_str());
  if (is_new) return created;
  if (reason != EEXIST) return core::fail_errno(reason, "cannot create the key " + file);
  return read_nkey(file);
}

}  // namespace dts::fleet::wire
