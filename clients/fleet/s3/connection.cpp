// SPDX-License-Identifier: Apache-2.0
#include "fleet/s3/connection.h"

#include <curl/curl.h>

#include <array>
#include <cstdio>
#include <string>

namespace dts::fleet::s3 {
namespace {

constexpr long kConnectS = 10;
constexpr long kSlowBytes = 1000;
constexpr std::size_t kMostHeaderText = 200;

/// What the functions that libcurl calls need.
struct Exchange {
  CURL* handle = nullptr;
  const Request* request = nullptr;
  Answer answer{};
  bool is_too_long = false;
  bool is_unwritten = false;
};

std::size_t send_body(char* to, std::size_t size, std::size_t count, void* context) {
  const auto& exchange = *static_cast<Exchange*>(context);
  const std::int64_t read = exchange.request->body->read(to, size * count);
  return read < 0 ? CURL_READFUNC_ABORT : static_cast<std::size_t>(read);
}

int rewind_body(void* context, curl_off_t offset, int origin) {
  if (offset != 0 || origin != SEEK_SET) return CURL_SEEKFUNC_CANTSEEK;
  static_cast<Exchange*>(context)->request->body->rewind();
  return CURL_SEEKFUNC_OK;
}

std::size_t take_answer(char* data, std::size_t size, std::size_t count, void* context) {
  auto& exchange = *static_cast<Exchange*>(context);
  const std::string_view piece(data, size * count);
  long status = 0;
  curl_easy_getinfo(exchange.handle, CURLINFO_RESPONSE_CODE, &status);
  if (status == 200 && exchange.request->receive) {
    exchange.is_unwritten = !exchange.request->receive(piece);
    return exchange.is_unwritten ? 0 : piece.size();
  }
  exchange.is_too_long = exchange.answer.body.size() + piece.size() > kMostAnswerBytes;
  if (exchange.is_too_long) return 0;
  exchange.answer.body += piece;
  return piece.size();
}

class Headers {
 public:
  ~Headers() { curl_slist_free_all(list_); }
  Headers() = default;
  Headers(const Headers&) = delete;
  Headers& operator=(const Headers&) = delete;
  Headers(Headers&&) = delete;
  Headers& operator=(Headers&&) = delete;
  void add(const std::string& line) {
    if (curl_slist* const longer = curl_slist_append(list_, line.c_str()); longer != nullptr) list_ = longer;
  }
  [[nodiscard]] curl_slist* get() const { return list_; }

 private:
  curl_slist* list_ = nullptr;
};

}  // namespace

struct Connection::State {
  CURL* handle = nullptr;
  std::string signature;    // "aws:amz:REGION:s3"
  std::string credentials;  // "KEY:SECRET"
};

Connection::Connection(const Settings& settings, const Credentials& credentials) : settings_(settings), state_(std::make_unique<State>()) {
  static const bool is_initialised = curl_global_init(CURL_GLOBAL_DEFAULT) == CURLE_OK;
  state_->handle = is_initialised ? curl_easy_init() : nullptr;
  state_->signature = "aws:amz:" + settings.region + ":s3";
  state_->credentials = credentials.access_key + ":" + credentials.secret_key;
}

Connection::~Connection() { curl_easy_cleanup(state_->handle); }

core::Result<Answer> Connection::perform(const Request& request) {
  CURL* const handle = state_->handle;
  if (handle == nullptr) return core::fail(core::ErrorCode::Failed, "libcurl does not start");
  Exchange exchange{.handle = handle, .request = &request};
  std::array<char, CURL_ERROR_SIZE> problem{};
  const std::string url = settings_.endpoint + request.path + (request.query.empty() ? "" : "?" + request.query);
  Headers headers;
  headers.add("x-amz-content-sha256: " + request.payload_sha256);
  headers.add("Expect:");
  headers.add("Content-Type:");

  curl_easy_reset(handle);  // keeps the connection
  curl_easy_setopt(handle, CURLOPT_URL, url.c_str());
  curl_easy_setopt(handle, CURLOPT_PROTOCOLS_STR, settings_.endpoint.starts_with("https:") ? "https" : "http");
  curl_easy_setopt(handle, CURLOPT_PROXY, "");
  curl_easy_setopt(handle, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(handle, CURLOPT_HTTP_VERSION, static_cast<long>(CURL_HTTP_VERSION_1_1));
  curl_easy_setopt(handle, CURLOPT_AWS_SIGV4, state_->signature.c_str());
  curl_easy_setopt(handle, CURLOPT_USERPWD, state_->credentials.c_str());
  curl_easy_setopt(handle, CURLOPT_HTTPHEADER, headers.get());
  curl_easy_setopt(handle, CURLOPT_ERRORBUFFER, problem.data());
  curl_easy_setopt(handle, CURLOPT_CONNECTTIMEOUT, kConnectS);
  curl_easy_setopt(handle, CURLOPT_LOW_SPEED_TIME, static_cast<long>(request.longest_silence.count()));
  curl_easy_setopt(handle, CURLOPT_LOW_SPEED_LIMIT, kSlowBytes);
  curl_easy_setopt(handle, CURLOPT_WRITEFUNCTION, &take_answer);
  curl_easy_setopt(handle, CURLOPT_WRITEDATA, &exchange);
  if (!settings_.ca_file.empty()) {
    curl_easy_setopt(handle, CURLOPT_CAINFO, settings_.ca_file.c_str());
    curl_easy_setopt(handle, CURLOPT_CAPATH, nullptr);  // else the folder of the system's authorities counts too
  }
  if (request.body != nullptr) {
    curl_easy_setopt(handle, CURLOPT_UPLOAD, 1L);
    curl_easy_setopt(handle, CURLOPT_INFILESIZE_LARGE, static_cast<curl_off_t>(request.body->size()));
    curl_easy_setopt(handle, CURLOPT_READFUNCTION, &send_body);
    curl_easy_setopt(handle, CURLOPT_READDATA, &exchange);
    curl_easy_setopt(handle, CURLOPT_SEEKFUNCTION, &rewind_body);
    curl_easy_setopt(handle, CURLOPT_SEEKDATA, &exchange);
  }
  if (request.method == "HEAD") curl_easy_setopt(handle, CURLOPT_NOBODY, 1L);
  curl_easy_setopt(handle, CURLOPT_CUSTOMREQUEST, request.method.c_str());

  const CURLcode ended = curl_easy_perform(handle);
  const std::string what = request.method + " " + url + ": ";
  if (exchange.is_too_long) return core::fail(core::ErrorCode::Unreachable, what + "S3 answers with too many bytes");
  if (exchange.is_unwritten) return core::fail(core::ErrorCode::Failed, what + "cannot keep the answer", "make room on the disk");
  if (ended != CURLE_OK) {
    const std::string reason = problem.front() == '\0' ? curl_easy_strerror(ended) : problem.data();
    return core::fail(core::ErrorCode::Unreachable, what + reason, "check the server and [store.s3]");
  }
  curl_easy_getinfo(handle, CURLINFO_RESPONSE_CODE, &exchange.answer.status);
  curl_off_t bytes = -1;
  if (curl_easy_getinfo(handle, CURLINFO_CONTENT_LENGTH_DOWNLOAD_T, &bytes) == CURLE_OK) exchange.answer.bytes = bytes;
  curl_header* etag = nullptr;
  if (curl_easy_header(handle, "ETag", 0, CURLH_HEADER, -1, &etag) == CURLHE_OK)
    exchange.answer.etag = std::string(etag->value).substr(0, kMostHeaderText);
  return std::move(exchange.answer);
}

std::string encoded(std::string_view text) {
  std::string out;
  for (const char letter : text) {
    const bool is_plain = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') || (letter >= '0' && letter <= '9') ||
                          letter == '-' || letter == '.' || letter == '_' || letter == '~';
    if (is_plain) {
      out += letter;
      continue;
    }
    std::array<char, 4> code{};
    std::snprintf(code.data(), code.size(), "%%%02X", static_cast<unsigned>(static_cast<unsigned char>(letter)));
    out += code.data();
  }
  return out;
}

}  // namespace dts::fleet::s3
