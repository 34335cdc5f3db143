// SPDX-License-Identifier: Apache-2.0
#include "gateway/options.h"

#include <boost/asio/ip/address.hpp>
#include <charconv>
#include <filesystem>
#include <system_error>
#include <utility>

#include "cli/try.h"
#include "gateway/access/user_file.h"

namespace dts::gateway {
namespace {

namespace fs = std::filesystem;
using client::ErrorCode;

client::Result<std::pair<std::string, std::uint16_t>> parse_listen(const std::string& text) {
  const auto wrong = client::fail(ErrorCode::InvalidArgument, "cannot listen on '" + text + "'", "write 127.0.0.1:8080 or [::1]:8080");
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos) return wrong;
  std::string address = text.substr(0, colon);
  const bool is_bracketed = address.size() > 2 && address.front() == '[' && address.back() == ']';
  if (is_bracketed) address = address.substr(1, address.size() - 2);
  std::uint16_t port = 0;
  const char* end = text.data() + text.size();
  const auto [rest, problem] = std::from_chars(text.data() + colon + 1, end, port);
  if (problem != std::errc() || rest != end) return wrong;
  boost::system::error_code error;
  const auto parsed = boost::asio::ip::make_address(address, error);
  if (error || parsed.is_v6() != is_bracketed) return wrong;
  return std::pair{address, port};
}

bool is_loopback(const std::string& address) { return boost::asio::ip::make_address(address).is_loopback(); }

client::Result<v1::Role> parse_role(const std::string& name) {
  if (name == role_name(v1::ROLE_UNSPECIFIED)) return v1::ROLE_UNSPECIFIED;
  if (const auto role = role_of(name)) return *role;
  return client::fail(ErrorCode::InvalidArgument, "unknown role '" + name + "'", "viewer, operator, engineer or none");
}

}  // namespace

void add_server_options(CLI::App& command, Options& options) {
  command.add_option("--listen", options.listen, "Address and port; other addresses than loopback require TLS and users")
      ->option_text("ADDRESS:PORT");
  command.add_option("--tls-certificate", options.certificate_file, "PEM file with the certificate and its chain")->option_text("FILE");
  command.add_option("--tls-key", options.key_file, "PEM file with the private key of the certificate")->option_text("FILE");
  command.add_option("--host-name", options.host_names, "Name of this machine in browsers; may be repeated")->option_text("NAME");
  command.add_option("--users", options.users_file, "File of users, made by `dts-gateway user add`")->option_text("FILE");
  command
      .add_option("--local-role", options.local_role,
                  "Role without a login from this machine: viewer, operator, engineer, none. Default: operator without "
                  "--users, else none")
      ->option_text("ROLE");
  command.add_option("--web-root", options.web_root, "Folder of the dashboard's files")->option_text("DIR");
}

client::Result<ServerOptions> server_options(const Options& options) {
  DTS_TRY_ASSIGN(auto listen, parse_listen(options.listen));
  if (options.certificate_file.empty() != options.key_file.empty()) {
    return client::fail(ErrorCode::InvalidArgument, "TLS requires a certificate and its key", "give --tls-certificate and --tls-key");
  }
  if (!is_loopback(listen.first) && (options.certificate_file.empty() || options.users_file.empty())) {
    return client::fail(ErrorCode::InvalidArgument,
                        "'" + options.listen + "' can be reached from other machines: this requires TLS and users",
                        "give --tls-certificate, --tls-key and --users, or listen on 127.0.0.1");
  }
  return ServerOptions{.address = listen.first,
                       .port = listen.second,
                       .certificate_file = options.certificate_file,
                       .key_file = options.key_file,
                       .host_names = options.host_names};
}

client::Result<AccessOptions> access_options(const Options& options) {
  const std::string fallback = options.users_file.empty() ? "operator" : "none";
  DTS_TRY_ASSIGN(const auto role, parse_role(options.local_role.empty() ? fallback : options.local_role));
  if (role == v1::ROLE_UNSPECIFIED && options.users_file.empty()) {
    return client::fail(ErrorCode::InvalidArgument, "no user could log in: no users file and no local role",
                        "give --users or --local-role");
  }
  return AccessOptions{.users_file = options.users_file, .local_role = role};
}

client::Result<std::string> web_root(const Options& options) {
  std::vector<fs::path> places{options.web_root};
  if (options.web_root.empty()) {
    std::error_code ignored;
    const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
    places = {program.parent_path().parent_path() / "share/dts-gateway/web", "/usr/share/dts-gateway/web"};
  }
  for (const fs::path& place : places) {
    std::error_code ignored;
    if (fs::is_regular_file(place / "index.html", ignored)) return place.string();
  }
  return client::fail(ErrorCode::InvalidArgument, "the dashboard's files are not in " + places.front().string(),
                      "build the target 'dashboard' (needs node), or give --web-root");
}

}  // namespace dts::gateway
