// SPDX-License-Identifier: Apache-2.0
#include "fleet/s3/bucket.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <pugixml.hpp>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/descriptor.h"
#include "core/utf8.h"
#include "files/whole_file.h"
#include "fleet/s3/connection.h"
#include "fleet/s3/sha256.h"

namespace dts::fleet::s3 {
namespace {

constexpr std::size_t kReadBytes = 256 * 1024;
constexpr std::size_t kMostCaBytes = 4 * 1024 * 1024;
constexpr std::size_t kMostReason = 200;
constexpr std::size_t kLongestId = 4096;
constexpr std::size_t kMostKeys = 1000;
constexpr mode_t kPrivateMode = 0600;
constexpr std::uint64_t kSpareBytes = 64 * 1024 * 1024;  // a copy leaves so much of the disk free
constexpr const char* kMakeRoom = "make room on the disk";
constexpr std::chrono::seconds kLongestCompletion{300};  // S3 puts the parts together before it answers
constexpr const char* kCheckKeys = "check the keys and what they may do: put, get, list, delete";
constexpr const char* kNoBucket = "NoSuchBucket";
constexpr const char* kTryLater = "it is tried again; check the server of S3";

const std::string& sha256_of_nothing() {
  static const std::string sum = hexadecimal(Sha256().finish());
  return sum;
}

/// Part of a file. Computes the SHA-256 of what was sent.
class FileBody final : public Body {
 public:
  FileBody(int file, std::uint64_t begin, std::uint64_t size) : file_(file), begin_(begin), size_(size) {}
  [[nodiscard]] std::uint64_t size() const override { return size_; }
  [[nodiscard]] std::int64_t read(char* to, std::size_t most) override {
    const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(most, size_ - sent_));
    if (wanted == 0) return 0;
    const ssize_t got = ::pread(file_, to, wanted, static_cast<off_t>(begin_ + sent_));
    if (got <= 0) return -1;  // the file is shorter than it was
    sum_.add({to, static_cast<std::size_t>(got)});
    sent_ += static_cast<std::uint64_t>(got);
    return got;
  }
  void rewind() override {
    sent_ = 0;
    sum_.restart();
  }
  [[nodiscard]] std::string sha256() { return sum_.finish(); }

 private:
  int file_;
  std::uint64_t begin_;
  std::uint64_t size_;
  std::uint64_t sent_ = 0;
  Sha256 sum_;
};

class TextBody final : public Body {
 public:
  explicit TextBody(const std::string& text) : text_(text) {}
  [[nodiscard]] std::uint64_t size() const override { return text_.size(); }
  [[nodiscard]] std::int64_t read(char* to, std::size_t most) override {
    const std::size_t count = text_.copy(to, most, sent_);
    sent_ += count;
    return static_cast<std::int64_t>(count);
  }
  void rewind() override { sent_ = 0; }

 private:
  const std::string& text_;
  std::size_t sent_ = 0;
};

bool is_key(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](char letter) {
    return (letter >= 'a' && letter <= 'z') || (letter >= '0' && letter <= '9') || letter == '-' || letter == '/';
  });
}

std::string sha256_of_text(const std::string& text) {
  Sha256 sum;
  sum.add(text);
  return hexadecimal(sum.finish());
}

/// Returns the root of an answer, whatever its namespace; an empty node if it is not XML with this root.
pugi::xml_node root_of(pugi::xml_document& document, const std::string& text, const char* name) {
  if (!document.load_buffer(text.data(), text.size())) return {};
  const pugi::xml_node root = document.document_element();
  return std::string_view(root.name()) == name ? root : pugi::xml_node();
}

std::string code_of(const Answer& answer) {
  pugi::xml_document document;
  return root_of(document, answer.body, "Error").child_value("Code");
}

/// Returns the error of an answer that is not the expected one. S3 may also answer 200 with an error in the body.
tl::unexpected<core::Error> unexpected(const std::string& what, const Answer& answer) {
  pugi::xml_document document;
  const pugi::xml_node error = root_of(document, answer.body, "Error");
  std::string reason = std::string(error.child_value("Code")) + ": " + error.child_value("Message");
  reason = error ? core::printable(reason.substr(0, kMostReason)) : "no reason";
  const bool is_rejected = answer.status == 401 || answer.status == 403;
  return core::fail(core::ErrorCode::Unreachable, what + ": S3 answers " + std::to_string(answer.status) + ", " + reason,
                    is_rejected ? kCheckKeys : kTryLater);
}

bool is_etag(std::string_view text) {
  return text.size() > 2 && text.front() == '"' && text.back() == '"' &&
         std::ranges::all_of(text, [](char letter) { return letter > ' ' && letter < 127 && letter != '<' && letter != '&'; });
}

core::Result<std::string> sha256_of_part(int file, std::uint64_t begin, std::uint64_t size, Sha256& whole) {
  Sha256 sum;
  std::string block(kReadBytes, '\0');
  for (std::uint64_t done = 0; done < size;) {
    const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(block.size(), size - done));
    const ssize_t got = ::pread(file, block.data(), wanted, static_cast<off_t>(begin + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return core::fail_errno(got < 0 ? errno : EIO, "cannot read a file for S3", "check the disk");
    const std::string_view piece(block.data(), static_cast<std::size_t>(got));
    sum.add(piece);
    whole.add(piece);
    done += piece.size();
  }
  return sum.finish();
}

}  // namespace

/// A file on its way to S3.
struct Bucket::Upload {
  std::string key;
  std::string sha256;
  int file = -1;
  std::uint64_t bytes = 0;

  [[nodiscard]] tl::unexpected<core::Error> damaged() const {
    return core::fail(core::ErrorCode::DataDamaged, key + ": the bytes read for S3 have another SHA-256", "check the disk");
  }
};

/// A connection for one call.
class Bucket::Lent {
 public:
  explicit Lent(Bucket& bucket) : bucket_(bucket) {
    const std::lock_guard lock(bucket.mutex_);
    if (!bucket.idle_.empty()) {
      connection_ = std::move(bucket.idle_.back());
      bucket.idle_.pop_back();
    }
    if (!connection_) connection_ = std::make_unique<Connection>(bucket.settings_, bucket.credentials_);
  }
  ~Lent() {
    const std::lock_guard lock(bucket_.mutex_);
    bucket_.idle_.push_back(std::move(connection_));
  }
  Lent(const Lent&) = delete;
  Lent& operator=(const Lent&) = delete;
  Lent(Lent&&) = delete;
  Lent& operator=(Lent&&) = delete;
  [[nodiscard]] Connection& get() { return *connection_; }

 private:
  Bucket& bucket_;
  std::unique_ptr<Connection> connection_;
};

Bucket::Bucket(Settings settings, Credentials credentials) : settings_(std::move(settings)), credentials_(std::move(credentials)) {}

Bucket::~Bucket() = default;

core::Result<std::unique_ptr<Bucket>> Bucket::open(Settings settings) {
  DTS_TRY_ASSIGN(auto credentials, read_credentials(settings.credentials_file));
  if (!settings.ca_file.empty()) {
    const auto ca = files::read_whole_file(settings.ca_file, kMostCaBytes);
    if (!ca) return core::fail(ca.error().code, "cannot read '" + settings.ca_file + "': " + ca.error().what, "check [store.s3] ca");
  }
  std::unique_ptr<Bucket> bucket(new Bucket(std::move(settings), std::move(credentials)));
  const auto looked = bucket->look(Lent(*bucket).get());
  if (!looked && looked.error().code == core::ErrorCode::NotFound) return tl::make_unexpected(looked.error());
  return bucket;
}

core::Status Bucket::look(Connection& connection) const {
  DTS_TRY_ASSIGN(const Answer answer,
                 connection.perform({.method = "HEAD", .path = "/" + settings_.bucket, .payload_sha256 = sha256_of_nothing()}));
  if (answer.status == 404)
    return core::fail(core::ErrorCode::NotFound, "S3 has no bucket '" + settings_.bucket + "'", "check bucket and endpoint in [store.s3]");
  // 403: there is one, but the key may not ask for it.
  return answer.status == 200 || answer.status == 403 ? core::Status() : unexpected("look for the bucket", answer);
}

core::Status Bucket::put(const std::string& key, const std::string& file, const std::string& sha256) {
  const core::Descriptor opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  struct stat facts {};
  if (opened.get() < 0 || ::fstat(opened.get(), &facts) != 0)
    return core::fail_errno(errno, "cannot read '" + file + "'", "check the disk");
  const Upload upload{.key = key, .sha256 = sha256, .file = opened.get(), .bytes = static_cast<std::uint64_t>(facts.st_size)};
  Lent connection(*this);
  DTS_TRY_ASSIGN(const std::string etag,
                 upload.bytes > kMostWhole ? put_parts(connection.get(), upload) : put_whole(connection.get(), upload));
  DTS_TRY_ASSIGN(const auto stored, find(connection.get(), key));
  if (stored && stored->bytes == upload.bytes && stored->etag == etag) return {};
  return core::fail(core::ErrorCode::Unreachable,
                    key + ": S3 has confirmed the object, but shows " + (stored ? "another size or ETag" : "no object"), kTryLater);
}

core::Result<std::string> Bucket::put_whole(Connection& connection, const Upload& upload) const {
  FileBody body(upload.file, 0, upload.bytes);
  DTS_TRY_ASSIGN(
      const Answer answer,
      connection.perform({.method = "PUT", .path = path_of(upload.key), .payload_sha256 = hexadecimal(upload.sha256), .body = &body}));
  if (answer.status != 200 || !is_etag(answer.etag)) return unexpected("put " + upload.key, answer);
  if (body.sha256() == upload.sha256) return answer.etag;
  // The server did not check.
  DTS_TRY(connection.perform({.method = "DELETE", .path = path_of(upload.key), .payload_sha256 = sha256_of_nothing()}));
  return upload.damaged();
}

core::Result<std::string> Bucket::put_parts(Connection& connection, const Upload& upload) const {
  DTS_TRY_ASSIGN(
      const Answer begun,
      connection.perform({.method = "POST", .path = path_of(upload.key), .query = "uploads=", .payload_sha256 = sha256_of_nothing()}));
  pugi::xml_document document;
  const std::string id = root_of(document, begun.body, "InitiateMultipartUploadResult").child_value("UploadId");
  if (begun.status != 200 || id.empty() || id.size() > kLongestId) return unexpected("begin " + upload.key, begun);
  auto etag = send_parts(connection, upload, id);
  if (etag) return etag;
  // Else the parts would stay, and cost. If this fails too, the bucket's lifecycle rule removes them.
  static_cast<void>(connection.perform(
      {.method = "DELETE", .path = path_of(upload.key), .query = "uploadId=" + encoded(id), .payload_sha256 = sha256_of_nothing()}));
  return etag;
}

core::Result<std::string> Bucket::send_parts(Connection& connection, const Upload& upload, const std::string& id) const {
  const std::uint64_t part_bytes = std::max(kLeastPart, (upload.bytes + kMostParts - 1) / kMostParts);
  Sha256 whole;
  std::vector<std::string> etags;
  for (std::uint64_t begin = 0; begin < upload.bytes; begin += part_bytes) {
    const std::uint64_t size = std::min(part_bytes, upload.bytes - begin);
    DTS_TRY_ASSIGN(const std::string sum, sha256_of_part(upload.file, begin, size, whole));
    FileBody body(upload.file, begin, size);
    const std::string number = std::to_string(etags.size() + 1);
    DTS_TRY_ASSIGN(const Answer answer, connection.perform({.method = "PUT",
                                                            .path = path_of(upload.key),
                                                            .query = "partNumber=" + number + "&uploadId=" + encoded(id),
                                                            .payload_sha256 = hexadecimal(sum),
                                                            .body = &body}));
    if (answer.status != 200 || !is_etag(answer.etag)) return unexpected("put part " + number + " of " + upload.key, answer);
    if (body.sha256() != sum) return upload.damaged();
    etags.push_back(answer.etag);
  }
  // Before this, there is no object.
  if (whole.finish() != upload.sha256) return upload.damaged();
  DTS_TRY_ASSIGN(const auto before, find(connection, upload.key));
  const auto etag = complete(connection, upload, id, etags);
  if (etag) return etag;
  // S3 may have put the parts together, and only its answer is lost.
  const auto now = find(connection, upload.key);
  const bool is_here = now && *now && (*now)->bytes == upload.bytes && is_etag((*now)->etag);
  if (is_here && (!before || before->etag != (*now)->etag)) return (*now)->etag;
  return etag;
}

core::Result<std::string> Bucket::complete(Connection& connection, const Upload& upload, const std::string& id,
                                           const std::vector<std::string>& etags) const {
  std::string list = "<CompleteMultipartUpload>";
  for (std::size_t number = 1; number <= etags.size(); ++number)
    list += "<Part><PartNumber>" + std::to_string(number) + "</PartNumber><ETag>" + etags[number - 1] + "</ETag></Part>";
  list += "</CompleteMultipartUpload>";
  TextBody body(list);
  DTS_TRY_ASSIGN(const Answer answer, connection.perform({.method = "POST",
                                                          .path = path_of(upload.key),
                                                          .query = "uploadId=" + encoded(id),
                                                          .payload_sha256 = sha256_of_text(list),
                                                          .body = &body,
                                                          .longest_silence = kLongestCompletion}));
  pugi::xml_document document;
  const std::string etag = root_of(document, answer.body, "CompleteMultipartUploadResult").child_value("ETag");
  if (answer.status != 200 || !is_etag(etag)) return unexpected("complete " + upload.key, answer);
  return etag;
}

core::Result<std::optional<Bucket::Stored>> Bucket::find(Connection& connection, const std::string& key) const {
  DTS_TRY_ASSIGN(const Answer answer, connection.perform({.method = "HEAD", .path = path_of(key), .payload_sha256 = sha256_of_nothing()}));
  if (answer.status == 404) {
    const auto looked = look(connection);  // without the bucket nothing is known of the object
    if (!looked) return core::fail(core::ErrorCode::Unreachable, "look for " + key + ": " + looked.error().what, looked.error().hint);
    return std::optional<Stored>();
  }
  if (answer.status != 200 || answer.bytes < 0) return unexpected("look for " + key, answer);
  return std::optional(Stored{.bytes = static_cast<std::uint64_t>(answer.bytes), .etag = answer.etag});
}

core::Result<std::optional<std::uint64_t>> Bucket::size(const std::string& key) {
  Lent connection(*this);
  DTS_TRY_ASSIGN(const auto found, find(connection.get(), key));
  return found ? std::optional(found->bytes) : std::nullopt;
}

core::Status Bucket::get(const std::string& key, const std::string& file, const std::function<bool()>& keeps_on) {
  if (!is_key(key)) return core::fail(core::ErrorCode::DataDamaged, "'" + core::printable(key) + "' is not the key of a recording");
  const core::Descriptor opened(::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kPrivateMode));
  struct statvfs disk {};
  if (opened.get() < 0 || ::fstatvfs(opened.get(), &disk) != 0) {  // Failed, also without the folder: NotFound is for objects
    return core::fail(core::ErrorCode::Failed, "cannot create '" + file + "': " + std::system_category().message(errno), "check the disk");
  }
  const std::uint64_t free = std::uint64_t{disk.f_bavail} * disk.f_frsize;
  const std::uint64_t most = free > kSpareBytes ? free - kSpareBytes : 0;
  std::uint64_t received = 0;
  bool is_stopped = false;
  Lent connection(*this);
  const auto answer = connection.get().perform(
      {.method = "GET", .path = path_of(key), .payload_sha256 = sha256_of_nothing(), .receive = [&](std::string_view piece) {
         received += piece.size();
         is_stopped = !keeps_on();
         if (is_stopped || received > most) return false;
         return ::write(opened.get(), piece.data(), piece.size()) == static_cast<ssize_t>(piece.size());
       }});
  if (answer && answer->status == 200) return {};
  ::unlink(file.c_str());
  if (is_stopped) return core::fail(core::ErrorCode::WrongState, "reading " + key + " was stopped");
  if (received > most) return core::fail(core::ErrorCode::LimitExceeded, key + " is too large for the disk of '" + file + "'", kMakeRoom);
  DTS_TRY(answer);
  if (answer->status == 404 && code_of(*answer) != kNoBucket) return core::fail(core::ErrorCode::NotFound, "S3 has no object " + key);
  return unexpected("get " + key, *answer);
}

core::Result<bool> Bucket::remove(const std::string& key) {
  Lent connection(*this);
  DTS_TRY_ASSIGN(const auto found, find(connection.get(), key));
  if (!found) return false;
  DTS_TRY_ASSIGN(const Answer answer,
                 connection.get().perform({.method = "DELETE", .path = path_of(key), .payload_sha256 = sha256_of_nothing()}));
  const bool is_gone = answer.status == 204 || answer.status == 200 || (answer.status == 404 && code_of(answer) != kNoBucket);
  if (!is_gone) return unexpected("remove " + key, answer);
  return true;
}

core::Result<Page> Bucket::list(const std::string& prefix, const std::string& next) {
  Lent connection(*this);
  const std::string after = next.empty() ? "" : "&start-after=" + encoded(next);  // no token: it may have a '+', see README
  DTS_TRY_ASSIGN(const Answer answer, connection.get().perform({.method = "GET",
                                                                .path = "/" + settings_.bucket,
                                                                .query = "list-type=2&prefix=" + encoded(prefix) + after,
                                                                .payload_sha256 = sha256_of_nothing()}));
  pugi::xml_document document;
  const pugi::xml_node root = root_of(document, answer.body, "ListBucketResult");
  if (answer.status != 200 || !root) return unexpected("list " + prefix, answer);
  Page page;
  for (const pugi::xml_node object : root.children("Contents")) page.keys.emplace_back(object.child_value("Key"));
  const bool is_cut = std::string_view(root.child_value("IsTruncated")) == "true";
  if (is_cut && !page.keys.empty()) page.next = page.keys.back();
  if ((is_cut && page.next <= next) || page.next.size() > kLongestId || page.keys.size() > kMostKeys)
    return core::fail(core::ErrorCode::Unreachable, "list " + prefix + ": S3 answers with a page that has no end", kTryLater);
  return page;
}

}  // namespace dts::fleet::s3
