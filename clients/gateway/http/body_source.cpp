// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/body_source.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

namespace dts::gateway {

BodySource::BodySource(std::variant<std::string, FileBody> body) {
  if (auto* text = std::get_if<std::string>(&body)) {
    text_ = std::move(*text);
    size_bytes_ = text_.size();
    return;
  }
  auto& from = std::get<FileBody>(body);
  when_done_ = std::move(from.when_done);
  // O_NONBLOCK: opening a fifo must not block the only thread of all connections.
  file_ = ::open(from.path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW);
  struct stat status {};
  is_good_ = file_ >= 0 && ::fstat(file_, &status) == 0 && S_ISREG(status.st_mode);
  if (is_good_) size_bytes_ = static_cast<std::uint64_t>(status.st_size);
}

BodySource::~BodySource() {
  if (file_ >= 0) ::close(file_);
  give_up();
}

void BodySource::give_up() {
  if (const auto done = std::exchange(when_done_, nullptr)) done();
}

std::optional<std::string_view> BodySource::next() {
  const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(kPieceBytes, size_bytes_ - taken_bytes_));
  if (wanted == 0) return std::string_view();
  if (file_ < 0) {
    const auto piece = std::string_view(text_).substr(static_cast<std::size_t>(taken_bytes_), wanted);
    taken_bytes_ += wanted;
    return piece;
  }
  text_.resize(wanted);
  ssize_t got = 0;
  do {
    got = ::read(file_, text_.data(), wanted);
  } while (got < 0 && errno == EINTR);
  if (got <= 0) return std::nullopt;
  taken_bytes_ += static_cast<std::uint64_t>(got);
  return std::string_view(text_).substr(0, static_cast<std::size_t>(got));
}

}  // namespace dts::gateway
