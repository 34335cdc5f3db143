// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>
#include <unistd.h>

#include <cstdio>

#include "served_gateway.h"
#include "unit/libdts/fake_daemon.h"

namespace dts::gateway::test {
namespace {

using dts::test::upgrade_headers;
using ::testing::StartsWith;

/// A key and a certificate that it signed itself, in a folder of their own.
class Certificate {
 public:
  Certificate() {
    EVP_PKEY* key = EVP_EC_gen("P-256");
    X509* certificate = X509_new();
    ASN1_INTEGER_set(X509_get_serialNumber(certificate), 1);
    X509_gmtime_adj(X509_getm_notBefore(certificate), 0);
    X509_gmtime_adj(X509_getm_notAfter(certificate), 3600);
    X509_set_pubkey(certificate, key);
    X509_sign(certificate, key, EVP_sha256());
    FILE* file = std::fopen(key_file().c_str(), "w");
    PEM_write_PrivateKey(file, key, nullptr, nullptr, 0, nullptr, nullptr);
    std::fclose(file);
    file = std::fopen(certificate_file().c_str(), "w");
    PEM_write_X509(file, certificate);
    std::fclose(file);
    X509_free(certificate);
    EVP_PKEY_free(key);
  }

  [[nodiscard]] std::string certificate_file() const { return directory_.path() / "certificate.pem"; }
  [[nodiscard]] std::string key_file() const { return directory_.path() / "key.pem"; }

 private:
  dts::testing::TemporaryDirectory directory_;
};

/// TLS on top of a RawClient.
class TlsClient {
 public:
  explicit TlsClient(std::uint16_t port, int newest_version = 0, const char* ciphers = nullptr)
      : tcp_(port), context_(SSL_CTX_new(TLS_client_method())) {
    SSL_CTX_set_security_level(context_, 0);  // so that it is the server who refuses what is old
    if (newest_version != 0) SSL_CTX_set_max_proto_version(context_, newest_version);
    if (ciphers != nullptr) SSL_CTX_set_cipher_list(context_, ciphers);
    ssl_ = SSL_new(context_);
    SSL_set_fd(ssl_, tcp_.socket());
    is_connected_ = SSL_connect(ssl_) == 1;
  }
  ~TlsClient() {
    SSL_free(ssl_);
    SSL_CTX_free(context_);
  }
  TlsClient(const TlsClient&) = delete;
  TlsClient& operator=(const TlsClient&) = delete;

  [[nodiscard]] bool is_connected() const noexcept { return is_connected_; }
  [[nodiscard]] SSL* ssl() const noexcept { return ssl_; }
  void send(const std::string& bytes) const { static_cast<void>(SSL_write(ssl_, bytes.data(), static_cast<int>(bytes.size()))); }
  /// As much as one read gives; "" at the end.
  [[nodiscard]] std::string read_some() const {
    char piece[65536];
    const int got = SSL_read(ssl_, piece, sizeof piece);
    return {piece, static_cast<std::size_t>(got > 0 ? got : 0)};
  }

 private:
  RawClient tcp_;
  SSL_CTX* context_;
  SSL* ssl_;
  bool is_connected_ = false;
};

class TlsServer : public ::testing::Test {
 protected:
  Certificate certificate_;
  ServedGateway gateway_{{.certificate_file = certificate_.certificate_file(),
                          .key_file = certificate_.key_file(),
                          .limits = {.handshake_timeout = RawClient::kMostWait}}};
};

TEST_F(TlsServer, AnswersWithHsts) {
  const TlsClient client(gateway_.port());
  ASSERT_TRUE(client.is_connected());

  client.send(request(gateway_.port(), "GET /", "Connection: close\r\n"));
  std::string answer;
  for (std::string piece = client.read_some(); !piece.empty(); piece = client.read_some()) answer += piece;

  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(answer, HasSubstr("Strict-Transport-Security: max-age=31536000\r\n"));
  EXPECT_EQ(SSL_get_shutdown(client.ssl()) & SSL_RECEIVED_SHUTDOWN, SSL_RECEIVED_SHUTDOWN) << "an end without close_notify is an attack";
}

TEST_F(TlsServer, CarriesWebSocketsOfPagesThatCameOverTls) {
  const std::string http_origin = upgrade_headers(gateway_.port());
  std::string https_origin = http_origin;
  https_origin.replace(https_origin.find("http://"), 7, "https://");
  const TlsClient good(gateway_.port());
  const TlsClient bad(gateway_.port());

  good.send(request(gateway_.port(), "GET /ws", https_origin));
  bad.send(request(gateway_.port(), "GET /ws", http_origin));

  EXPECT_EQ(status_of(good.read_some()), "101");
  EXPECT_EQ(status_of(bad.read_some()), "403");
  good.send(dts::test::frame(dts::test::kFin | dts::test::kBinary, "hello"));
  std::string echo;
  while (echo.size() < 7) {
    const std::string piece = good.read_some();
    if (piece.empty()) break;
    echo += piece;
  }
  EXPECT_EQ(echo, "\x82\x05hello");
}

TEST_F(TlsServer, OldVersionsAndWeakCiphersAreRefused) {
  EXPECT_TRUE(TlsClient(gateway_.port(), TLS1_2_VERSION).is_connected());
  EXPECT_FALSE(TlsClient(gateway_.port(), TLS1_1_VERSION, "ALL").is_connected());
  EXPECT_FALSE(TlsClient(gateway_.port(), TLS1_2_VERSION, "ECDHE-ECDSA-AES128-SHA").is_connected());
}

TEST_F(TlsServer, DoesNotRenegotiate) {
  const TlsClient client(gateway_.port(), TLS1_2_VERSION);
  ASSERT_TRUE(client.is_connected());

  SSL_renegotiate(client.ssl());
  const bool is_renegotiated = SSL_do_handshake(client.ssl()) == 1 && !client.read_some().empty();

  EXPECT_FALSE(is_renegotiated);
}

TEST_F(TlsServer, AHandshakeThatDoesNotEndIsEnded) {
  const ServedGateway gateway{{.certificate_file = certificate_.certificate_file(),
                               .key_file = certificate_.key_file(),
                               .limits = {.handshake_timeout = milliseconds(500)}}};
  RawClient silent(gateway.port());
  RawClient plain(gateway.port());
  plain.send(request(gateway.port(), "GET /"));

  EXPECT_TRUE(silent.is_closed_within(RawClient::kMostWait));
  EXPECT_EQ(status_of(plain.read_to_end()), "");
}

TEST_F(TlsServer, AKeyThatCannotBeRead_IsNamedWithTheReason) {
  if (::getuid() != 0) GTEST_SKIP() << "only root can act as another user";
  const std::string folder = std::filesystem::path(certificate_.key_file()).parent_path();
  std::filesystem::permissions(folder, std::filesystem::perms(0755));
  std::filesystem::permissions(certificate_.certificate_file(), std::filesystem::perms(0644));
  std::filesystem::permissions(certificate_.key_file(), std::filesystem::perms(0600));
  boost::asio::io_context io;
  constexpr uid_t kNobody = 65534;
  ASSERT_EQ(::seteuid(kNobody), 0);
  const auto opened =
      Server::open(io, {.port = 0, .certificate_file = certificate_.certificate_file(), .key_file = certificate_.key_file()}, {});
  ASSERT_EQ(::seteuid(0), 0);
  ASSERT_FALSE(opened.has_value());
  EXPECT_EQ(opened.error().what, "cannot read " + certificate_.key_file() + ": Permission denied");
}

TEST_F(TlsServer, FilesThatCannotBeUsedAreNamed) {
  boost::asio::io_context io;
  const auto try_files = [&](const std::string& certificate, const std::string& key) {
    return Server::open(io, {.port = 0, .certificate_file = certificate, .key_file = key}, {});
  };
  const Certificate other;

  const auto absent = try_files("/absent.pem", certificate_.key_file());
  const auto foreign_key = try_files(certificate_.certificate_file(), other.key_file());

  ASSERT_FALSE(absent.has_value());
  EXPECT_EQ(absent.error().code, client::ErrorCode::InvalidArgument);
  EXPECT_THAT(absent.error().what, HasSubstr("/absent.pem"));
  ASSERT_FALSE(foreign_key.has_value());
  EXPECT_THAT(foreign_key.error().what, HasSubstr(other.key_file()));
  EXPECT_FALSE(try_files(certificate_.certificate_file(), "").has_value());
  const std::string pipe = certificate_.key_file() + ".pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THAT(try_files(certificate_.certificate_file(), pipe).error().what, HasSubstr(pipe));
  std::filesystem::remove(pipe);
}

}  // namespace
}  // namespace dts::gateway::test
