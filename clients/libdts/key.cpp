// SPDX-License-Identifier: Apache-2.0
#include "dts/key.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <toml++/toml.h>
#include <unistd.h>
#include <zmq.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "try.h"

namespace dts::client {
namespace {

constexpr std::size_t kKeyCharacters = 40;
constexpr std::size_t kLongestFile = 4096;

bool is_z85(const std::string& key) {
  std::array<std::uint8_t, 32> bytes{};
  return key.size() == kKeyCharacters && key.find('\0') == std::string::npos && zmq_z85_decode(bytes.data(), key.c_str()) != nullptr;
}

Result<void> check_mode(const std::string& file) {
  struct stat found {};
  if (::stat(file.c_str(), &found) != 0) {
    return fail(ErrorCode::InvalidArgument, "key file " + file + ": " + std::generic_category().message(errno),
                "make a key on the daemon's machine: dtsctl key new");
  }
  if (!S_ISREG(found.st_mode))
    return fail(ErrorCode::InvalidArgument, "key file " + file + " is not a regular file");  // a pipe would block
  if ((found.st_mode & 0077U) == 0) return {};
  return fail(ErrorCode::NotAllowed, "key file " + file + " is readable or writable by other users: its secret is not protected",
              "chmod 0600 " + file);
}

Result<std::string> read_text(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string text(kLongestFile + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream && stream.gcount() == 0) return fail(ErrorCode::InvalidArgument, "key file " + file + " is empty or cannot be read");
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() > kLongestFile) return fail(ErrorCode::InvalidArgument, "key file " + file + " is too large for a key file");
  return text;
}

Result<Key> parse(const std::string& text, const std::string& file) {
  try {
    const toml::table table = toml::parse(text, file);
    const auto value = [&](const char* key) { return table[key].value_or(std::string()); };
    Key key{.name = value("name"),
            .public_key = value("public_key"),
            .secret_key = value("secret_key"),
            .server_public_key = value("server_public_key"),
            .control = value("control"),
            .data = value("data")};
    for (const auto& [name, part] :
         {std::pair("public_key", &key.public_key), {"secret_key", &key.secret_key}, {"server_public_key", &key.server_public_key}}) {
      if (!is_z85(*part))
        return fail(ErrorCode::InvalidArgument, file + ": " + name + " is not a key of 40 characters",
                    "use an unchanged file from dtsctl key new");
    }
    return key;
  } catch (const toml::parse_error& error) {
    const auto& at = error.source().begin;
    return fail(ErrorCode::InvalidArgument, file + ":" + std::to_string(at.line) + ":" + std::to_string(at.column) + ": not a key file",
                "use an unchanged file from dtsctl key new");
  }
}

}  // namespace

Result<Key> new_key(const std::string& name) {
  std::array<char, kKeyCharacters + 1> public_key{};
  std::array<char, kKeyCharacters + 1> secret_key{};
  if (zmq_curve_keypair(public_key.data(), secret_key.data()) != 0) {
    return fail(ErrorCode::Failed, "libzmq was built without CURVE encryption", "install Debian's libzmq5");
  }
  return Key{.name = name, .public_key = public_key.data(), .secret_key = secret_key.data()};
}

Result<Key> read_key(const std::string& file) {
  DTS_TRY(check_mode(file));
  DTS_TRY_ASSIGN(const auto text, read_text(file));
  return parse(text, file);
}

std::string key_text(const Key& key) {
  // No character that may occur in a key, a name or an address is special within a quoted TOML string.
  return "# Key of a client of dtsd: dtsctl --key FILE ..., or DTSD_KEY=FILE. Anyone with this file can connect as \"" + key.name +
         "\": keep it secret.\nname = \"" + key.name + "\"\npublic_key = \"" + key.public_key + "\"\nsecret_key = \"" + key.secret_key +
         "\"\nserver_public_key = \"" + key.server_public_key + "\"\ncontrol = \"" + key.control + "\"\ndata = \"" + key.data + "\"\n";
}

Result<void> write_new_key(const std::string& file, const Key& key) {
  const int made = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
  if (made < 0 && errno == EEXIST) {
    return fail(ErrorCode::WrongState, file + " already exists", "give another name: --out FILE");
  }
  const std::string text = key_text(key);
  const bool is_written = made >= 0 && ::write(made, text.data(), text.size()) == static_cast<ssize_t>(text.size()) && ::fsync(made) == 0;
  const int why = errno;
  if (made >= 0) ::close(made);
  if (is_written) return {};
  if (made >= 0) ::unlink(file.c_str());
  return fail(ErrorCode::Failed, "cannot write " + file + ": " + std::generic_category().message(why),
              "check that the folder exists and that you may write to it");
}

}  // namespace dts::client
