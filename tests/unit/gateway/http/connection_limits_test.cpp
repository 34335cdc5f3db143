// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/connection_limits.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace dts::gateway {
namespace {

using Seat = ConnectionLimits::Seat;
using boost::asio::ip::make_address;
using std::chrono::milliseconds;
using std::chrono::seconds;

class ConnectionLimitsTest : public ::testing::Test {
 protected:
  /// A connection from `address` that is named in `gone_` when it has to go.
  Seat& sit(const std::string& name, const std::string& address = "10.0.0.1") {
    auto seat = limits_.take_seat(make_address(address));
    EXPECT_TRUE(seat) << name;
    seats_.push_back(std::move(*seat));
    seats_.back().on_eviction([this, name] { gone_.push_back(name); });
    return seats_.back();
  }

  ConnectionLimits limits_{{.all = 8, .strangers = 6, .per_address = 3, .per_user = 2}};
  std::vector<std::string> gone_;
  std::vector<Seat> seats_ = [] {
    std::vector<Seat> seats;
    seats.reserve(100);
    return seats;
  }();
};

TEST_F(ConnectionLimitsTest, TooManyStrangersOfAnAddress_TheOldestOfThemGoes) {
  sit("other", "10.0.0.2");
  for (const char* name : {"a", "b", "c", "d", "e"}) sit(name);
  EXPECT_EQ(gone_, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(limits_.taken(), 4U);
  EXPECT_EQ(limits_.evicted_total(), 2U);
}

TEST_F(ConnectionLimitsTest, UserOfACrowdedAddress_ComesInAndStays) {
  for (const char* name : {"a", "b", "c"}) sit(name);
  EXPECT_TRUE(sit("user").belongs_to("anna"));
  for (const char* name : {"d", "e", "f", "g"}) sit(name);
  EXPECT_EQ(gone_, (std::vector<std::string>{"a", "b", "c", "d"}));
}

TEST_F(ConnectionLimitsTest, StrangersOfManyAddresses_LeaveTheReserveToUsers) {
  for (int address = 1; address <= 9; ++address) sit(std::to_string(address), "10.0.1." + std::to_string(address));
  EXPECT_EQ(limits_.taken(), 6U);
  EXPECT_TRUE(sit("user").belongs_to("anna"));
  EXPECT_TRUE(sit("user").belongs_to("ben"));
  EXPECT_LE(limits_.taken(), 8U);
}

TEST_F(ConnectionLimitsTest, NewcomerFromAnotherAddress_DisplacesTheMostCrowdedOne) {
  for (const char* name : {"a", "b", "c"}) sit(name);
  for (int address = 1; address <= 4; ++address) sit(std::to_string(address), "10.0.1." + std::to_string(address));
  EXPECT_EQ(gone_, (std::vector<std::string>{"a"}));
}

TEST_F(ConnectionLimitsTest, UserWithTooMany_GetsNoMoreAndTakesNobodysPlace) {
  EXPECT_TRUE(sit("1").belongs_to("anna"));
  EXPECT_TRUE(sit("2").belongs_to("anna"));
  Seat& third = sit("3");
  EXPECT_FALSE(third.belongs_to("anna"));
  EXPECT_FALSE(seats_.front().belongs_to("ben")) << "it is anna's already";
  EXPECT_TRUE(seats_.front().belongs_to("anna")) << "again";
  EXPECT_TRUE(third.belongs_to("ben"));
}

TEST_F(ConnectionLimitsTest, UsersOfAllPlaces_LeaveNoneToStrangers) {
  for (int user = 0; user < 7; ++user) EXPECT_TRUE(sit("user").belongs_to("user " + std::to_string(user)));
  sit("stranger");
  EXPECT_TRUE(sit("newcomer", "10.0.0.2").belongs_to("user 7"));
  EXPECT_EQ(gone_, std::vector<std::string>{"stranger"});
  EXPECT_FALSE(limits_.take_seat(make_address("10.0.0.9")));
  seats_.clear();
  EXPECT_EQ(limits_.taken(), 0U);
  sit("again");
}

TEST(CountedAs, ANetworkOfAddressesCountsAsOneHost) {
  EXPECT_EQ(counted_as(make_address("2001:db8:1:2:3::4")), counted_as(make_address("2001:db8:1:2:ffff::1")));
  EXPECT_NE(counted_as(make_address("2001:db8:1:2::1")), counted_as(make_address("2001:db8:1:3::1")));
  EXPECT_EQ(counted_as(make_address("127.0.0.1")), counted_as(make_address("::1")));
  EXPECT_EQ(counted_as(make_address("127.9.9.9")), counted_as(make_address("::ffff:127.0.0.1")));
}

TEST(CountedAs, AnAddressAsTextCountsAsTheAddress) {
  for (const char* text : {"192.0.2.7", "::ffff:192.0.2.7", "2001:db8:1:2::99", "127.0.0.1"}) {
    EXPECT_EQ(counted_as(std::string(text)), counted_as(make_address(text))) << text;
  }
  EXPECT_EQ(counted_as(std::string("::ffff:192.0.2.7")), "192.0.2.7");
  EXPECT_EQ(counted_as(std::string("nonsense")), "nonsense");
}

}  // namespace
}  // namespace dts::gateway
