// SPDX-License-Identifier: Apache-2.0
#include "sim/standing_person.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

namespace dts::sim {
namespace {

constexpr double kStanding = 30.0;  // s, long after both feet are on

StandingPerson make(const physics::Stance& stance) {
  auto person = StandingPerson::create(stance, physics::Plate{});
  EXPECT_TRUE(person.has_value()) << (person ? "" : person.error().what);
  return *person;
}

std::string refusal(const physics::Stance& stance) {
  const auto person = StandingPerson::create(stance, physics::Plate{});
  return person ? "" : person.error().what;
}

/// Centre of the patch forces, plate-centre origin.
CopPosition centre_of_force(const StandingPerson& person, const Contact& contact) {
  CopPosition sum;
  double load = 0.0;
  for (std::size_t i = 0; i < person.patches().size(); ++i) {
    const physics::Plate plate;
    sum.ml_mm += contact.force_n[i] * (person.patches()[i].centre.x.value - plate.a.value / 2);
    sum.ap_mm += contact.force_n[i] * (person.patches()[i].centre.y.value - plate.b.value / 2);
    load += contact.force_n[i];
  }
  return {sum.ml_mm / load, sum.ap_mm / load};
}

double sum_of(const Contact& contact) { return contact.force_n[0] + contact.force_n[1] + contact.force_n[2] + contact.force_n[3]; }

TEST(StandingPerson, AnyCopOnTheFeet_IsTheCentreOfForce) {
  physics::Stance stance;
  stance.centre_ml = core::Millimetres{12.0};
  stance.centre_ap = core::Millimetres{-7.0};
  const StandingPerson person = make(stance);
  std::mt19937 random(1);  // its numbers, unlike those of distributions, are fixed by the standard
  const auto within = [&random](double limit) { return limit * (static_cast<double>(random() % 2001) - 1000.0) / 1000.0; };

  for (int i = 0; i < 200; ++i) {
    const CopPosition sway{within(99.0), within(69.0)};
    const Contact contact = person.at(kStanding, sway);
    const CopPosition centre = centre_of_force(person, contact);
    EXPECT_NEAR(contact.cop.ml_mm, 12.0 + sway.ml_mm, 1e-9);
    EXPECT_NEAR(contact.cop.ap_mm, -7.0 + sway.ap_mm, 1e-9);
    EXPECT_NEAR(centre.ml_mm, contact.cop.ml_mm, 1e-9);
    EXPECT_NEAR(centre.ap_mm, contact.cop.ap_mm, 1e-9);
    EXPECT_NEAR(sum_of(contact), contact.load_n, 1e-9);
    for (const double force : contact.force_n) EXPECT_GE(force, 0.0);
  }
}

TEST(StandingPerson, Leaning_LoadsThePatchesOfThatSide) {
  const StandingPerson person = make({});

  const Contact upright = person.at(kStanding, {});
  const Contact right = person.at(kStanding, {50.0, 0.0});
  const Contact forward = person.at(kStanding, {0.0, 30.0});

  for (const double force : upright.force_n) EXPECT_NEAR(force, upright.load_n / 4, 1e-9);
  EXPECT_NEAR((right.force_n[2] + right.force_n[3]) / right.load_n, 0.75, 1e-9);
  EXPECT_GT(forward.force_n[1], forward.force_n[0]);
  EXPECT_GT(forward.force_n[3], forward.force_n[2]);
}

TEST(StandingPerson, CopBeyondTheFeet_IsClampedAndReportedSo) {
  const StandingPerson person = make({});

  const Contact contact = person.at(kStanding, {-500.0, 500.0});

  EXPECT_NEAR(contact.cop.ml_mm, -100.0, 1e-9);
  EXPECT_NEAR(contact.cop.ap_mm, 0.55 * 255.0 / 2, 1e-9);
  EXPECT_NEAR(centre_of_force(person, contact).ml_mm, -100.0, 1e-9);
  EXPECT_NEAR(contact.force_n[1], contact.load_n, 1e-9);
}

TEST(StandingPerson, BeforeStepOn_NobodyIsThere) {
  const StandingPerson person = make({});

  const Contact contact = person.at(2.49, {});

  EXPECT_EQ(contact.load_n, 0.0);
  EXPECT_EQ(sum_of(contact), 0.0);
  EXPECT_TRUE(std::isnan(contact.cop.ml_mm));
  EXPECT_TRUE(std::isnan(contact.cop.ap_mm));
}

TEST(StandingPerson, SteppingOn_LeftFootFirstThenBoth) {
  const StandingPerson person = make({});

  const Contact left_only = person.at(2.5 + StandingPerson::kLoadingS, {});
  const Contact shifting = person.at(2.5 + StandingPerson::kLoadingS + StandingPerson::kShiftS / 2, {});

  EXPECT_NEAR(left_only.cop.ml_mm, -100.0, 1e-9);
  EXPECT_NEAR(left_only.force_n[2] + left_only.force_n[3], 0.0, 1e-9);
  EXPECT_NEAR(left_only.load_n, 686.0, 686.0 * 0.005);
  EXPECT_NEAR(shifting.cop.ml_mm, -50.0, 1e-9);
}

TEST(StandingPerson, SteppingOn_NothingJumps) {
  physics::Stance stance;
  stance.step_off_s = 6.0;
  const StandingPerson person = make(stance);
  double load_before = 0.0;
  CopPosition cop_before{-100.0, 0.0};

  for (double t = 2.4; t < 8.0; t += 1e-3) {
    const Contact contact = person.at(t, {5.0, 9.0});
    EXPECT_NEAR(contact.load_n, load_before, 2.0) << t;
    load_before = contact.load_n;
    if (std::isnan(contact.cop.ml_mm)) continue;
    EXPECT_NEAR(contact.cop.ml_mm, cop_before.ml_mm, 0.5) << t;
    cop_before = contact.cop;
  }
}

TEST(StandingPerson, SteppedOff_NobodyIsThere) {
  physics::Stance stance;
  stance.step_off_s = 10.0;
  const StandingPerson person = make(stance);

  EXPECT_NEAR(person.at(9.99, {}).load_n, 686.0, 5.0);
  EXPECT_NEAR(person.at(10.0 + StandingPerson::kShiftS, {}).cop.ml_mm, -100.0, 1e-9);  // the right foot has left
  EXPECT_EQ(person.at(10.0 + StandingPerson::kShiftS + StandingPerson::kLoadingS, {}).load_n, 0.0);
}

TEST(StandingPerson, StandingQuietly_WeightFluctuatesBySmallParts) {
  const StandingPerson person = make({});
  double low = 1e9;
  double high = 0.0;
  for (double t = 10.0; t < 30.0; t += 0.01) {
    low = std::min(low, person.at(t, {}).load_n);
    high = std::max(high, person.at(t, {}).load_n);
  }

  EXPECT_LT(high - low, 0.01 * 686.0);
  EXPECT_GT(high - low, 0.002 * 686.0);
}

TEST(StandingPerson, Point_CarriesTheWholeLoadWhereItStands) {
  physics::Stance stance;
  stance.kind = physics::ContactKind::Point;
  stance.load = core::Newtons{196.0};
  stance.centre_ml = core::Millimetres{-129.0};
  stance.centre_ap = core::Millimetres{129.0};
  const StandingPerson person = make(stance);

  const Contact contact = person.at(kStanding, {40.0, 40.0});

  ASSERT_EQ(person.patches().size(), 1U);
  EXPECT_EQ(person.patches()[0].centre, (physics::Point{core::Millimetres{86.0}, core::Millimetres{344.0}}));
  EXPECT_EQ(person.patches()[0].width.value, 0.0);
  EXPECT_EQ(contact.force_n[0], 196.0);
  EXPECT_EQ(contact.load_n, 196.0);
  EXPECT_EQ(contact.cop, (CopPosition{-129.0, 129.0}));
}

TEST(StandingPerson, OneFoot_StandsOnTheHalvesOfItsSole) {
  physics::Stance stance;
  stance.kind = physics::ContactKind::OneFoot;
  stance.centre_ml = core::Millimetres{10.0};
  const StandingPerson person = make(stance);

  const Contact standing = person.at(kStanding, {12.0, -20.0});
  const Contact arriving = person.at(2.5 + StandingPerson::kLoadingS, {12.0, -20.0});
  const Contact beyond = person.at(kStanding, {100.0, 0.0});

  ASSERT_EQ(person.patches().size(), 4U);
  EXPECT_NEAR((person.patches()[3].centre.x - person.patches()[1].centre.x).value, 45.0, 1e-9);
  EXPECT_EQ(person.patches()[1].width.value, 45.0);  // together as wide as a forefoot
  EXPECT_NEAR(standing.cop.ml_mm, 22.0, 1e-9);
  EXPECT_NEAR(centre_of_force(person, standing).ml_mm, 22.0, 1e-9);
  EXPECT_NEAR(centre_of_force(person, standing).ap_mm, -20.0, 1e-9);
  EXPECT_NEAR(sum_of(standing), standing.load_n, 1e-9);
  EXPECT_NEAR(arriving.cop.ml_mm, 10.0, 1e-9);  // there is no other foot from which the weight would come
  EXPECT_NEAR(beyond.cop.ml_mm, 10.0 + 22.5, 1e-9);
}

TEST(StandingPerson, StanceThatCannotBe_IsRefused) {
  const auto point = [](double ml_mm, double ap_mm) {
    return physics::Stance{.kind = physics::ContactKind::Point, .centre_ml = {ml_mm}, .centre_ap = {ap_mm}};
  };
  const std::string beside = " (from the corner) does not fit on the 430.000000 mm x 430.000000 mm plate";
  const double arrival_s = StandingPerson::kLoadingS + StandingPerson::kShiftS;
  for (const auto& [stance, says] :
       {std::pair(point(215.0, -215.0), std::string()),
        {point(215.1, -215.0), "stance: a contact at x 430.100000 mm, y 0.000000 mm" + beside},
        {{.width = {360.0}}, "stance: a contact at x 35.000000 mm, y 285.125000 mm" + beside},
        {{.width = {0.0}}, "stance: width of 0.000000 mm and foot length of 255.000000 mm must both be positive"},
        {{.load = {0.0}}, "stance: load of 0.000000 N is not positive"},
        {{.load = {std::nan("")}}, "stance: load of nan N is not positive"},
        {{.step_off_s = 2.5 + arrival_s}, ""},
        {{.step_off_s = 2.499 + arrival_s},
         "stance: steps off at " + std::to_string(2.499 + arrival_s) + " s, but stepping on at 2.500000 s takes " +
             std::to_string(arrival_s) + " s"}}) {
    EXPECT_EQ(refusal(stance), says);
  }
}

}  // namespace
}  // namespace dts::sim
