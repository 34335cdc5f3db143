// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/static_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <boost/crc.hpp>
#include <cerrno>
#include <cstdint>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "cli/try.h"

namespace dts::gateway {
namespace {

namespace fs = std::filesystem;
using client::ErrorCode;
using client::Result;

constexpr std::uintmax_t kMostFileBytes = 64ULL << 20U;
constexpr std::string_view kIndex = "/index.html";
/// The patient screen has an address that can be typed. The dashboard's script reads it.
constexpr std::string_view kPatientScreen = "/patient";
constexpr std::string_view kHashedFolder = "/assets/";  // Vite puts files with a hash in their name here

std::string content_type_of(const fs::path& path) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 11> kTypes{{{".html", "text/html; charset=utf-8"},
                                                                                  {".js", "text/javascript; charset=utf-8"},
                                                                                  {".css", "text/css; charset=utf-8"},
                                                                                  {".svg", "image/svg+xml"},
                                                                                  {".png", "image/png"},
                                                                                  {".woff2", "font/woff2"},
                                                                                  {".json", "application/json"},
                                                                                  {".map", "application/json"},
                                                                                  {".txt", "text/plain; charset=utf-8"},
                                                                                  {".ico", "image/x-icon"},
                                                                                  {".webmanifest", "application/manifest+json"}}};
  const std::string extension = path.extension().string();
  for (const auto& [ending, type] : kTypes) {
    if (extension == ending) return std::string(type);
  }
  return "application/octet-stream";
}

/// A checksum is sufficient: an attacker gains nothing from two files with the same tag.
std::string etag_of(const std::string& bytes) {
  boost::crc_optimal<64, 0x42F0E1EBA9EA3693ULL, ~0ULL, ~0ULL, true, true> crc;  // CRC-64/XZ
  crc.process_bytes(bytes.data(), bytes.size());
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string tag = "\"";
  for (int shift = 60; shift >= 0; shift -= 4) tag += kDigits[(crc.checksum() >> static_cast<unsigned>(shift)) & 0xFU];
  return tag + "\"";
}

/// Reads a file of at most `most` bytes; does not follow a link at the end of the path.
Result<std::string> read_file(const fs::path& path, std::uintmax_t most) {
  const auto unreadable = [&path](int why) {
    return client::fail(ErrorCode::Failed, "cannot read '" + path.string() + "': " + std::generic_category().message(why));
  };
  const int file = ::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return unreadable(errno);
  std::string bytes;
  std::array<char, 65536> piece{};
  ssize_t got = 0;
  while ((got = ::read(file, piece.data(), piece.size())) > 0 && bytes.size() <= most) {
    bytes.append(piece.data(), static_cast<std::size_t>(got));
  }
  const int why = got < 0 ? errno : 0;
  ::close(file);
  if (why != 0) return unreadable(why);
  if (bytes.size() > most) return client::fail(ErrorCode::LimitExceeded, "the dashboard's files are larger than 64 MiB");
  return bytes;
}

/// Checks a list of tags for ours (RFC 9110, 13.1.2): "*" matches every tag; weak tags count.
bool names_tag(std::string_view list, std::string_view tag) {
  if (list == "*") return true;
  while (!list.empty()) {
    const std::size_t end = std::min(list.find(','), list.size());
    std::string_view one = list.substr(0, end);
    while (one.starts_with(' ')) one.remove_prefix(1);
    while (one.ends_with(' ')) one.remove_suffix(1);
    if (one.starts_with("W/")) one.remove_prefix(2);
    if (one == tag) return true;
    list.remove_prefix(std::min(end + 1, list.size()));
  }
  return false;
}

}  // namespace

Result<StaticFiles> StaticFiles::load(const fs::path& root) {
  StaticFiles all;
  std::uintmax_t total = 0;
  std::error_code failed;
  fs::recursive_directory_iterator entry(root, failed);
  for (; !failed && entry != fs::recursive_directory_iterator(); entry.increment(failed)) {
    std::error_code gone;
    if (!fs::is_regular_file(entry->symlink_status(gone))) continue;
    DTS_TRY_ASSIGN(auto bytes, read_file(entry->path(), kMostFileBytes - total));
    total += bytes.size();
    std::string etag = etag_of(bytes);
    all.files_.emplace("/" + entry->path().lexically_relative(root).generic_string(),
                       File{.bytes = std::move(bytes), .content_type = content_type_of(entry->path()), .etag = std::move(etag)});
  }
  if (failed && failed != std::errc::no_such_file_or_directory) {
    return client::fail(ErrorCode::Failed, "cannot read the folder '" + root.string() + "': " + failed.message());
  }
  if (!all.files_.contains(std::string(kIndex))) {
    return client::fail(ErrorCode::InvalidArgument, "no dashboard in '" + root.string() + "': no index.html",
                        "give the folder with the built dashboard: --web-root DIR");
  }
  return all;
}

void StaticFiles::serve(const HttpRequest& request, const Respond& respond) const {
  if (request.method != "GET" && request.method != "HEAD") {
    return respond({.status = 405, .body = "this path accepts only GET and HEAD\n", .headers = {{"Allow", "GET, HEAD"}}});
  }
  const bool is_page = request.path == "/" || request.path == kPatientScreen;
  const auto found = files_.find(is_page ? std::string(kIndex) : request.path);
  if (found == files_.end()) return respond({.status = 404, .body = "no such page\n"});
  const auto& [path, file] = *found;
  HttpResponse answer{.content_type = file.content_type};
  answer.headers.emplace_back("ETag", file.etag);
  answer.headers.emplace_back("Cache-Control", path.starts_with(kHashedFolder) ? "public, max-age=31536000, immutable" : "no-cache");
  if (names_tag(request.header("if-none-match"), file.etag)) {
    answer.status = 304;
  } else {
    answer.body = file.bytes;
  }
  respond(std::move(answer));
}

}  // namespace dts::gateway
