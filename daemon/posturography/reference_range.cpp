// SPDX-License-Identifier: Apache-2.0
#include "posturography/reference_range.h"

#include <array>

namespace dts::posturography {
namespace {

constexpr std::string_view kYoung = "36 people of 20 to 38 years, no illness, disability or fall reported";
constexpr std::string_view kOld =
    "76 people aged 60 or more, illness allowed (6 of them free of every condition): not a norm of healthy elderly people";
constexpr std::string_view kSource =
    "computed for dtsd from Santos & Duarte 2016, A public data set of human balance evaluations, PeerJ 4:e2648 "
    "(Figshare 10.6084/m9.figshare.3394432), CC BY 4.0";

constexpr std::string_view kOpenFirm =
    "eyes open, firm surface, 60 s, force plate at 100 Hz, low-passed at 10 Hz by its authors, profile asis; median of three trials";
constexpr std::string_view kClosedFirm =
    "eyes closed, firm surface, 60 s, force plate at 100 Hz, low-passed at 10 Hz by its authors, profile asis; median of three trials";
constexpr std::string_view kClosedFoam =
    "eyes closed, foam, 60 s, force plate at 100 Hz, low-passed at 10 Hz by its authors, profile asis; median of three trials";

constexpr std::array kProtocols = {
    ReferenceProtocol{"bds-young-eo-firm", kYoung, kOpenFirm, kSource, "open", "firm", 60.0},
    ReferenceProtocol{"bds-young-ec-firm", kYoung, kClosedFirm, kSource, "closed", "firm", 60.0},
    ReferenceProtocol{"bds-young-ec-foam", kYoung, kClosedFoam, kSource, "closed", "foam", 60.0},
    ReferenceProtocol{"bds-60plus-eo-firm", kOld, kOpenFirm, kSource, "open", "firm", 60.0},
    ReferenceProtocol{"bds-60plus-ec-firm", kOld, kClosedFirm, kSource, "closed", "firm", 60.0},
};

struct ReferenceRow {
  Measure measure;
  std::array<ReferenceRange, kProtocols.size()> ranges;  ///< In the order of the protocols.
};

// Posturography sheet section 9. The sheet has only medians for RDIST and MVELO by axis; these are left out, because a range must be
// complete.
// clang-format off: one measure per line
constexpr std::array kReferenceRows = {
    ReferenceRow{Measure::Mdist, {{{4.53, 2.84, 7.69}, {5.14, 3.10, 8.59}, {11.1, 8.5, 14.8}, {4.63, 2.84, 8.30}, {4.71, 2.77, 7.69}}}},
    ReferenceRow{Measure::Rdist, {{{5.32, 3.32, 8.69}, {6.00, 3.56, 9.56}, {12.8, 9.7, 16.7}, {5.12, 3.25, 10.2}, {5.42, 3.21, 8.87}}}},
    ReferenceRow{Measure::Mvelo, {{{8.64, 5.76, 14.9}, {8.90, 6.20, 18.0}, {31.2, 19.8, 57.5}, {10.1, 6.87, 20.7}, {10.9, 6.22, 22.2}}}},
    ReferenceRow{Measure::Range, {{{25.2, 15.3, 35.0}, {27.3, 16.4, 38.3}, {66.5, 49.9, 81.8}, {24.9, 15.5, 44.3}, {26.6, 16.3, 42.8}}}},
    ReferenceRow{Measure::AreaCc, {{{254, 103, 630}, {335, 103, 743}, {1453, 812, 2396}, {236, 93, 918}, {267, 99, 755}}}},
    ReferenceRow{Measure::Pea95F, {{{223, 91, 480}, {240, 97, 713}, {1449, 858, 2403}, {217, 85, 552}, {223, 79, 523}}}},
    ReferenceRow{Measure::AreaSw, {{{12.2, 5.6, 26.6}, {13.1, 6.0, 37.7}, {110, 68, 235}, {14.2, 6.5, 34.3}, {16.3, 5.9, 45.2}}}},
    ReferenceRow{Measure::Mfreq,
                 {{{0.286, 0.19, 0.51}, {0.309, 0.20, 0.51}, {0.450, 0.31, 0.66}, {0.347, 0.22, 0.59}, {0.384, 0.23, 0.62}}}},
    ReferenceRow{Measure::FdCe, {{{1.66, 1.57, 1.82}, {1.66, 1.54, 1.84}, {1.77, 1.65, 1.91}, {1.71, 1.59, 1.90}, {1.74, 1.59, 1.90}}}},
    ReferenceRow{Measure::Pf50Ap,
                 {{{0.342, 0.25, 0.49}, {0.367, 0.24, 0.48}, {0.383, 0.26, 0.53}, {0.367, 0.26, 0.62}, {0.367, 0.25, 0.64}}}},
    ReferenceRow{Measure::Pf95Ap, {{{1.13, 0.83, 1.64}, {1.15, 0.75, 1.59}, {1.18, 0.80, 1.92}, {1.25, 0.86, 1.60}, {1.26, 0.84, 1.62}}}},
    ReferenceRow{Measure::CfreqAp,
                 {{{0.580, 0.46, 0.82}, {0.589, 0.42, 0.80}, {0.634, 0.45, 0.91}, {0.655, 0.45, 0.87}, {0.673, 0.43, 0.87}}}},
    ReferenceRow{Measure::FreqdAp,
                 {{{0.632, 0.57, 0.72}, {0.627, 0.57, 0.71}, {0.619, 0.58, 0.68}, {0.615, 0.50, 0.68}, {0.624, 0.51, 0.70}}}},
    ReferenceRow{Measure::Aamv2sAp, {{{20.1, 13.5, 35.5}, {21.1, 13.8, 44.4}, {71.2, 50, 133}, {23.3, 15.9, 49.8}, {27.0, 15.8, 58.1}}}},
    ReferenceRow{Measure::SdaDsAp, {{{6.60, 3.3, 17.3}, {7.63, 3.5, 26.4}, {85.4, 54, 178}, {10.2, 4.6, 40.7}, {13.1, 4.7, 51.6}}}},
    ReferenceRow{Measure::SdaHsAp,
                 {{{0.846, 0.77, 0.90}, {0.855, 0.77, 0.89}, {0.853, 0.75, 0.89}, {0.836, 0.77, 0.90}, {0.835, 0.78, 0.90}}}},
};
// clang-format on

}  // namespace

std::span<const ReferenceProtocol> reference_protocols() noexcept { return kProtocols; }

std::optional<ReferenceRange> reference_range(const ReferenceProtocol& protocol, Measure measure) noexcept {
  for (std::size_t column = 0; column < kProtocols.size(); ++column) {
    if (kProtocols[column].id != protocol.id) continue;
    for (const ReferenceRow& row : kReferenceRows) {
      if (row.measure == measure) return row.ranges[column];
    }
  }
  return std::nullopt;
}

}  // namespace dts::posturography
