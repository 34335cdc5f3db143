// SPDX-License-Identifier: Apache-2.0
#include "fleet/link/protocol.h"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "fleet/wire/nkey.h"

namespace dts::fleet::link {
namespace {

constexpr std::string_view kLineEnd = "\r\n";
constexpr std::string_view kNoListener = " 503";  // after "NATS/1.0" in the headers
constexpr std::size_t kLongestSubject = 1024;
constexpr std::size_t kMostWords = 6;

tl::unexpected<core::Error> damaged(const std::string& what) {
  return core::fail(core::ErrorCode::DataDamaged, "the server sends " + what);
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  while (words.size() <= kMostWords) {
    const std::size_t begin = line.find_first_not_of(" \t");
    if (begin == std::string_view::npos) break;
    const std::size_t end = std::min(line.find_first_of(" \t", begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    line.remove_prefix(end);
  }
  return words;
}

std::optional<std::uint64_t> number_of(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// A line "MSG subject subscription [reply] bytes", or "HMSG ... [reply] bytes-of-headers bytes".
struct MessageLine {
  Operation operation;
  std::size_t headers = 0;
  std::size_t bytes = 0;  ///< With the headers.
};

core::Result<MessageLine> message_line_of(std::string_view line) {
  const auto words = words_of(line);
  const bool has_headers = words.front() == "HMSG";
  const std::size_t fewest = has_headers ? 5 : 4;
  if (words.size() != fewest && words.size() != fewest + 1) return damaged("a message with a wrong first line");
  const auto subscription = number_of(words[2]);
  const auto bytes = number_of(words.back());
  const auto headers = has_headers ? number_of(words[words.size() - 2]) : std::optional<std::uint64_t>(0);
  if (!subscription || !bytes || !headers || *bytes > kLargestMessage || *headers > *bytes) return damaged("a message with wrong numbers");
  MessageLine out{.operation = {.kind = Operation::Kind::Message, .subscription = *subscription},
                  .headers = static_cast<std::size_t>(*headers),
                  .bytes = static_cast<std::size_t>(*bytes)};
  out.operation.letter.subject = words[1];
  if (words.size() > fewest) out.operation.letter.reply = words[3];
  return out;
}

}  // namespace

core::Result<ServerInfo> info_of_json(std::string_view json) {
  const auto info = nlohmann::json::parse(json, nullptr, false);
  if (!info.is_object()) return damaged("an INFO that is not JSON");
  ServerInfo out;
  if (const auto nonce = info.find("nonce"); nonce != info.end() && nonce->is_string()) out.nonce = nonce->get<std::string>();
  const auto limit = info.find("max_payload");
  if (limit == info.end() || !limit->is_number_unsigned()) return damaged("an INFO without max_payload");
  out.max_payload = static_cast<std::size_t>(std::min<std::uint64_t>(limit->get<std::uint64_t>(), kLargestMessage));
  return out;
}

core::Result<std::optional<Operation>> Parser::next() {
  const std::string_view rest = std::string_view(buffer_).substr(begin_);
  const std::size_t end = rest.find(kLineEnd);
  if (end == std::string_view::npos) {
    if (rest.size() > kLargestLine) return damaged("a line without an end");
    buffer_.erase(0, std::exchange(begin_, 0));
    return std::nullopt;
  }
  const std::string_view line = rest.substr(0, end);
  std::size_t used = end + kLineEnd.size();
  Operation operation;
  if (line.starts_with("MSG ") || line.starts_with("HMSG ")) {
    DTS_TRY_ASSIGN(auto message, message_line_of(line));
    if (rest.size() < used + message.bytes + kLineEnd.size()) {
      buffer_.erase(0, std::exchange(begin_, 0));
      return std::nullopt;
    }
    const std::string_view content = rest.substr(used, message.bytes);
    operation = std::move(message.operation);
    const std::string_view headers = content.substr(0, message.headers);
    operation.letter.has_no_listener = headers.substr(0, headers.find(kLineEnd)).ends_with(kNoListener);
    operation.letter.data = content.substr(message.headers);
    used += message.bytes + kLineEnd.size();
  } else if (line.starts_with("INFO ")) {
    operation = {.kind = Operation::Kind::Info, .text = std::string(line.substr(5))};
  } else if (line == "PING") {
    operation.kind = Operation::Kind::Ping;
  } else if (line == "PONG") {
    operation.kind = Operation::Kind::Pong;
  } else if (line.starts_with("-ERR")) {
    std::string_view text = line.substr(4);
    while (text.starts_with(' ') || text.starts_with('\'')) text.remove_prefix(1);
    while (text.ends_with(' ') || text.ends_with('\'')) text.remove_suffix(1);
    operation = {.kind = Operation::Kind::Error, .text = std::string(text)};
  } else if (line != "+OK") {
    return damaged("an unknown operation");
  }
  begin_ += used;
  return operation;
}

core::Result<std::string> connect_line(const std::string& name, const std::string& seed, const std::string& nonce, bool is_tls) {
  nlohmann::json options = {{"verbose", false}, {"pedantic", false},    {"tls_required", is_tls}, {"name", name},
                            {"lang", "dts"},    {"version", "1.0.0"},   {"protocol", 1},          {"echo", true},
                            {"headers", true},  {"no_responders", true}};
  if (!seed.empty()) {
    DTS_TRY_ASSIGN(const wire::NKey key, wire::nkey_of_seed(seed));
    DTS_TRY_ASSIGN(options["sig"], wire::signature(seed, nonce));
    options["nkey"] = key.public_key;
  }
  return "CONNECT " + options.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) + std::string(kLineEnd);
}

std::string subscribe_line(const std::string& subject, const std::string& queue, std::uint64_t subscription) {
  return "SUB " + subject + " " + (queue.empty() ? "" : queue + " ") + std::to_string(subscription) + std::string(kLineEnd);
}

std::string unsubscribe_line(std::uint64_t subscription) { return "UNSUB " + std::to_string(subscription) + std::string(kLineEnd); }

void append_publish(const Letter& letter, std::string& out) {
  out += "PUB " + letter.subject + " " + (letter.reply.empty() ? "" : letter.reply + " ") + std::to_string(letter.data.size());
  out += kLineEnd;
  out += letter.data;
  out += kLineEnd;
}

bool is_subject(std::string_view text) noexcept {
  return !text.empty() && text.size() <= kLongestSubject &&
         std::ranges::all_of(text, [](char letter) { return static_cast<unsigned char>(letter) > ' ' && letter != '\x7f'; });
}

}  // namespace dts::fleet::link
