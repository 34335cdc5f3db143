// SPDX-License-Identifier: Apache-2.0
// What a stranger sends to the gateway's port, from bytes to what the routes see: Beast's parser with the gateway's limits, then all of its
// checks. Whatever gets through is harmless as a path; whatever is refused is refused in one head without lines of the stranger's.
#include <boost/asio/buffer.hpp>
#include <boost/beast/http/parser.hpp>

#include "core/utf8.h"
#include "fuzz/fuzz_support.h"
#include "gateway/archive/archive_path.h"
#include "gateway/http/request_check.h"
#include "gateway/http/request_target.h"
#include "gateway/http/response_head.h"
#include "gateway/http/server.h"

namespace dts::fuzz::http {
namespace {

namespace http = boost::beast::http;

bool has_control(std::string_view text) {
  return std::ranges::any_of(text, [](char letter) { return static_cast<unsigned char>(letter) < 0x20 || letter == 0x7F; });
}

void check_path(const std::string& path) {
  promise(path.starts_with('/') && core::is_utf8(path) && !has_control(path), "a path is a text");
  promise(path.find('\\') == std::string::npos, "a path has no backslash");
  const std::string closed = path + "/";
  promise(closed.find("/../") == std::string::npos && closed.find("/./") == std::string::npos, "a path leads down");
}

void check_archive(const std::string& path) {
  const auto asked = gateway::read_archive_path(path);
  if (!asked) return;
  for (const std::string& name : {asked->session_id, asked->page}) {
    promise(name.find('/') == std::string::npos && !name.starts_with('.'), "a file has a name");
  }
  promise(!asked->session_id.empty(), "a session has an id");
}

void check_target(std::string_view text) {
  const auto target = gateway::parse_target(text);
  if (!target) return;
  check_path(target->path);
  check_archive(target->path);
  for (const auto& [key, value] : target->query) {
    promise(core::is_utf8(key) && core::is_utf8(value) && !has_control(key) && !has_control(value), "a query is text");
  }
}

void check_host(std::string_view text) {
  const auto authority = gateway::parse_authority(text);
  if (!authority) return;
  const std::string again = authority->host + (authority->port ? ":" + std::to_string(*authority->port) : "");
  const auto parsed = gateway::parse_authority(again);
  promise(parsed && parsed->host == authority->host && parsed->port == authority->port, "a host is one when written again");
  promise(gateway::is_same_origin("http://" + again, *authority, false), "a host is its own origin");
}

void check_answer(const gateway::HttpResponse& response, const std::string& path) {
  const std::string head = gateway::response_head(response, {.path = path, .body_bytes = 7});
  promise(response.status >= 400 && response.status < 600, "a refusal is one");
  promise(head.find("\r\n\r\n") == head.size() - 4, "a head ends once");
}

void check_message(std::string_view bytes) {
  const gateway::ServerLimits limits;
  http::request_parser<http::string_body> parser;
  parser.header_limit(static_cast<std::uint32_t>(limits.header_bytes));
  parser.body_limit(limits.body_bytes);
  parser.eager(true);
  boost::system::error_code error;
  while (!bytes.empty() && !parser.is_done() && !error) {
    const std::size_t taken = parser.put(boost::asio::buffer(bytes.data(), bytes.size()), error);
    if (taken == 0) break;
    bytes.remove_prefix(taken);
  }
  if (error) {
    if (const auto refused = gateway::refuse_unreadable(error)) check_answer(*refused, "/");
    return;
  }
  if (!parser.is_done()) return;
  gateway::RawRequest raw = parser.release();
  const gateway::HostCheck hosts({"clinic.example"}, true);
  const auto request = gateway::check_request(raw, {.remote_address = "127.0.0.1", .local_address = "127.0.0.1"}, false, hosts);
  if (!request) return check_answer(request.error(), "/");
  check_path(request->path);
  check_archive(request->path);
  promise(request->method == "GET" || request->method == "HEAD" || request->method == "POST", "one of three methods");
  promise(request->method == "POST" || request->body.empty(), "a body where one belongs");
  promise(request->body.size() <= limits.body_bytes, "a body within the limit");
  promise(request->method != "POST" || request->is_same_origin || !request->headers.contains("origin"), "nobody else's page posts");
  promise(request->cookie("dts_token").size() <= limits.header_bytes, "a cookie is part of the head");
  if (const auto refused = gateway::refuse_upgrade(raw, *request)) check_answer(*refused, request->path);
}

}  // namespace

void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  const std::string input = fuzz::text_of(bytes, size);
  check_message(input);
  check_target(input);
  check_archive(input);
  check_host(input);
}

}  // namespace dts::fuzz::http

DTS_FUZZ_TARGET(http)
