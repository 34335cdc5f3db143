// SPDX-License-Identifier: Apache-2.0
#include "fleet/s3/settings.h"

#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "files/whole_file.h"

namespace dts::fleet::s3 {
namespace {

constexpr std::size_t kMostCredentialBytes = 1024;
constexpr std::string_view kPlain = "http://";
constexpr std::string_view kSafe = "https://";
constexpr const char* kTwoLines = "write two lines: the ID of the access key, the secret key";

bool has_only(std::string_view text, std::string_view more) {
  return std::ranges::all_of(text, [more](char letter) {
    return (letter >= 'a' && letter <= 'z') || (letter >= '0' && letter <= '9') || more.find(letter) != std::string_view::npos;
  });
}

/// `host`: "127.0.0.1:9000".
bool is_loopback(std::string_view host) {
  const std::string_view name = host.substr(0, host.rfind(':'));
  return name == "127.0.0.1" || name == "[::1]" || name == "localhost";
}

/// Returns whether the text is a server without a path: the path is part of the signature.
bool is_endpoint(std::string_view text) {
  const bool is_plain = text.starts_with(kPlain);
  if (!is_plain && !text.starts_with(kSafe)) return false;
  const std::string_view host = text.substr(is_plain ? kPlain.size() : kSafe.size());
  return !host.empty() && has_only(host, "-.:[]") && (!is_plain || is_loopback(host));
}

bool is_bucket(std::string_view text) {
  return text.size() >= 3 && text.size() <= 63 && has_only(text, "-.") && text.front() != '.' && text.find("..") == std::string_view::npos;
}

std::string required_text(files::TomlReader& reader, std::string_view key) {
  reader.require(key);
  return reader.text(key, "");
}

/// Returns a name relative to the folder of the configuration; empty if the text is.
std::string beside(const files::TomlReader& reader, const std::string& text) {
  std::error_code error;
  const auto folder = std::filesystem::absolute(reader.file(), error).parent_path();
  return text.empty() ? text : (folder / text).lexically_normal().string();
}

bool is_word(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](char letter) { return letter > ' ' && letter < 127 && letter != ':'; });
}

}  // namespace

Settings read_settings(files::TomlReader reader) {
  Settings settings;
  settings.endpoint = required_text(reader, "endpoint");
  settings.bucket = required_text(reader, "bucket");
  settings.region = required_text(reader, "region");
  settings.credentials_file = beside(reader, required_text(reader, "credentials"));
  settings.ca_file = beside(reader, reader.text("ca", ""));
  if (reader.has("endpoint") && !is_endpoint(settings.endpoint))
    reader.report("endpoint", "needs https and no path: \"https://s3.example.org\"; http only for a server on this machine");
  if (reader.has("bucket") && !is_bucket(settings.bucket))
    reader.report("bucket", "has 3 to 63 of the characters a-z, 0-9, - and .: \"dts-recordings\"");
  if (reader.has("region") && (settings.region.empty() || !has_only(settings.region, "-")))
    reader.report("region", "has the characters a-z, 0-9 and -: \"eu-west-2\"");
  reader.finish();
  return settings;
}

core::Result<Credentials> read_credentials(const std::string& file) {
  struct stat found {};
  if (::stat(file.c_str(), &found) == 0 && (found.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    return core::fail(core::ErrorCode::NotAllowed, "others can read the keys of S3 in " + file, "run: chmod 600 " + file);
  const auto text = files::read_whole_file(file, kMostCredentialBytes);
  if (!text) return core::fail(text.error().code, "cannot read the keys of S3 in " + file + ": " + text.error().what, kTwoLines);
  const std::size_t end = text->find('\n');
  Credentials credentials{.access_key = text->substr(0, end),
                          .secret_key = end == std::string::npos ? std::string() : text->substr(end + 1)};
  if (credentials.secret_key.ends_with('\n')) credentials.secret_key.pop_back();
  if (!is_word(credentials.access_key) || !is_word(credentials.secret_key))
    return core::fail(core::ErrorCode::InvalidArgument, file + " has not the form of keys of S3", kTwoLines);
  return credentials;
}

}  // namespace dts::fleet::s3
