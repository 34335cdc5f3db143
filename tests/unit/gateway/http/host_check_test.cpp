// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/host_check.h"

#include <gtest/gtest.h>

#include <string>

namespace dts::gateway {
namespace {

bool is_ours(const HostCheck& hosts, const std::string& header, const std::string& local_address) {
  const auto host = parse_authority(header);
  return host && hosts.is_ours(*host, local_address);
}

TEST(HostCheck, OnLoopbackAddressAndLocalhostAreOurs) {
  const HostCheck hosts({}, true);

  for (const char* ours : {"127.0.0.1", "127.0.0.1:8080", "localhost", "LocalHost:1"})
    EXPECT_TRUE(is_ours(hosts, ours, "127.0.0.1")) << ours;
  EXPECT_TRUE(is_ours(hosts, "[::1]:8080", "::1"));
  for (const char* foreign : {"evil.example", "127.0.0.1.evil.example", "localhost.evil.example", "evil-localhost", "localhost.", "127.1",
                              "2130706433", "0x7f000001", "127.0.0.2", "[::1]", "0.0.0.0", "192.168.1.5"}) {
    EXPECT_FALSE(is_ours(hosts, foreign, "127.0.0.1")) << foreign;
  }
}

TEST(HostCheck, OnTheNetworkLocalhostIsNotOurs) {
  const HostCheck hosts({"Gait-Lab.clinic.example"}, false);

  EXPECT_TRUE(is_ours(hosts, "gait-lab.clinic.example:443", "192.168.1.5"));
  EXPECT_TRUE(is_ours(hosts, "192.168.1.5:8443", "192.168.1.5"));
  EXPECT_FALSE(is_ours(hosts, "localhost", "127.0.0.1"));
  EXPECT_FALSE(is_ours(hosts, "gait-lab", "192.168.1.5"));
}

TEST(Authority, WhatIsNotExactlyOneIsRefused) {
  for (const char* bad : {"", ":80", "a:", "a:0", "a:65536", "a:80x", "a:+80", "a b", "user@a", "a/b", "[::1", "[::1]x", "[127.0.0.1]",
                          "[]", "::1", "a,b", "a\tb"}) {
    EXPECT_FALSE(parse_authority(bad).has_value()) << bad;
  }
}

TEST(SameOrigin, SchemeNameAndPortAreThoseOfTheHost) {
  const Authority host = *parse_authority("127.0.0.1:8080");
  const Authority usual = *parse_authority("gait.example");

  EXPECT_TRUE(is_same_origin("http://127.0.0.1:8080", host, false));
  EXPECT_TRUE(is_same_origin("https://127.0.0.1:8080", host, true));
  EXPECT_TRUE(is_same_origin("https://gait.example:443", usual, true));
  for (const char* foreign :
       {"", "null", "https://127.0.0.1:8080", "http://127.0.0.1", "http://127.0.0.1:8081", "http://localhost:8080",
        "http://127.0.0.1:8080/", "http://127.0.0.1:8080.evil.example", "file://", "http://127.0.0.1:8080,http://x"}) {
    EXPECT_FALSE(is_same_origin(foreign, host, false)) << foreign;
  }
}

}  // namespace
}  // namespace dts::gateway
