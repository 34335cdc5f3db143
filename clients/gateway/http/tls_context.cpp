// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/tls_context.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

namespace dts::gateway {
namespace {

namespace ssl = boost::asio::ssl;

/// Only forward secrecy and authenticated encryption: the "intermediate" list of Mozilla's server-side TLS guidelines, without DHE. All
/// cipher suites of TLS 1.3 are acceptable.
constexpr const char* kCiphersOfTls12 = "ECDHE+AESGCM:ECDHE+CHACHA20";

tl::unexpected<client::Error> unusable(const std::string& file, const std::string& why) {
  return client::fail(client::ErrorCode::InvalidArgument, file + ": " + why,
                      "both files must be PEM, and the key must fit the certificate");
}

}  // namespace

client::Result<std::unique_ptr<ssl::context>> open_tls(const std::string& certificate_file, const std::string& key_file) {
  if (certificate_file.empty()) return unusable(key_file, "key without a certificate");
  if (key_file.empty()) return unusable(certificate_file, "certificate without a key");
  for (const std::string& file : {certificate_file, key_file}) {
    std::error_code unknown;
    if (!std::filesystem::is_regular_file(file, unknown)) return unusable(file, "is not a readable file");  // a pipe would block
    if (::faccessat(AT_FDCWD, file.c_str(), R_OK, AT_EACCESS) != 0) {
      return client::fail(client::ErrorCode::InvalidArgument, "cannot read " + file + ": " + std::generic_category().message(errno),
                          "let the user or the group of the gateway read it");
    }
  }
  auto context = std::make_unique<ssl::context>(ssl::context::tls_server);
  SSL_CTX* const raw = context->native_handle();
  SSL_CTX_set_options(raw, SSL_OP_NO_COMPRESSION | SSL_OP_NO_RENEGOTIATION | SSL_OP_CIPHER_SERVER_PREFERENCE);
  SSL_CTX_set_mode(raw, SSL_MODE_RELEASE_BUFFERS);  // saves 34 kB for each idle connection
  if (SSL_CTX_set_min_proto_version(raw, TLS1_2_VERSION) != 1 || SSL_CTX_set_cipher_list(raw, kCiphersOfTls12) != 1) {
    return client::fail(client::ErrorCode::Unsupported, "this OpenSSL has no TLS 1.2 with forward secrecy");
  }
  boost::system::error_code error;
  context->use_certificate_chain_file(certificate_file, error);
  if (error) return unusable(certificate_file, error.message());
  context->use_private_key_file(key_file, ssl::context::pem, error);
  if (error) return unusable(key_file, error.message());
  return context;
}

}  // namespace dts::gateway
