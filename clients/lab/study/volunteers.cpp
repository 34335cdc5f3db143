// SPDX-License-Identifier: Apache-2.0
#include "lab/study/volunteers.h"

namespace dts::lab::study {
namespace {

using core::TrunkClass;
using Angles = std::array<double, 3>;

constexpr std::array<Volunteer, 3> kTeachers{{
    {.name = "A", .person = {68.0, 175.0, 67.0, 124.0}},
    {.name = "B", .person = {52.0, 165.0, 59.0, 115.0}},
    {.name = "C", .person = {81.0, 182.0, 71.0, 130.0}},
}};

constexpr std::array<Volunteer, 10> kHealthy{{
    {.name = "H1", .person = {85.0, 183.0, 71.0, 132.0}, .measured_deg = Angles{0.4, 28.4, 61.4}},
    {.name = "H2", .person = {84.0, 170.0, 67.0, 115.0}, .measured_deg = Angles{3.0, 34.1, 52.5}},
    {.name = "H3", .person = {48.0, 160.0, 59.0, 111.0}, .measured_deg = Angles{1.5, 22.3, 48.0}},
    {.name = "H4", .person = {67.0, 165.0, 65.5, 121.0}, .measured_deg = Angles{7.7, 31.0, 48.8}},
    {.name = "H5", .person = {66.0, 170.0, 63.5, 124.0}, .measured_deg = Angles{2.0, 20.6, 60.4}},
    {.name = "H6", .person = {72.0, 176.0, 68.5, 118.0}, .measured_deg = Angles{2.0, 36.4, 54.3}},
    {.name = "H7", .person = {63.0, 164.0, 70.0, 122.0}, .measured_deg = Angles{8.4, 34.2, 60.0}},
    {.name = "H8", .person = {78.0, 187.0, 74.0, 133.0}, .measured_deg = Angles{9.9, 30.2, 50.9}},
    {.name = "H9", .person = {83.0, 178.0, 67.0, 125.0}, .measured_deg = Angles{2.1, 26.8, 51.8}},
    {.name = "H10", .person = {82.0, 180.0, 71.0, 129.0}, .measured_deg = Angles{4.1, 27.6, 54.5}},
}};

constexpr std::array<Volunteer, 5> kStroke{{
    {"S1", {50.0, 160.0, 68.0, 43.0}, false, {}, 21.0, TrunkClass::Moderate},
    {"S2", {80.0, 178.0, 71.0, 127.0}, false, {}, 4.3, TrunkClass::Minor},
    {"S3", {54.0, 168.0, 65.0, 120.0}, false, {}, 4.3, TrunkClass::Minor},
    {"S4", {57.0, 155.0, 62.0, 106.0}, false, {}, 6.0, TrunkClass::Minor},
    {"S5", {83.0, 175.0, 69.0, 98.0}, false, {}, 30.9, TrunkClass::Moderate},
}};

}  // namespace

std::span<const Volunteer> teachers() noexcept { return kTeachers; }
std::span<const Volunteer> healthy() noexcept { return kHealthy; }
std::span<const Volunteer> stroke() noexcept { return kStroke; }

}  // namespace dts::lab::study
