// SPDX-License-Identifier: Apache-2.0
#include "lab/resolution/resolution_view.h"

#include <algorithm>
#include <string>
#include <utility>

#include "cli/table.h"

namespace dts::lab::resolution {
namespace {

using cli::decimal;
using cli::Json;

constexpr std::array<const char*, kMeasures> kKeys = {"rise_of_p1", "ratio_change", "dip_of_p1", "any"};

std::string text_of(const Limit& limit) { return limit ? decimal(*limit, 1) : "> 20"; }

std::string text_of(const LimitInterval& limit) {
  return text_of(limit.value) + " (" + text_of(limit.lowest) + " .. " + text_of(limit.highest) + ")";
}

Json to_json(const Limit& limit) { return limit ? Json(*limit) : Json(nullptr); }

Json to_json(const LimitInterval& limit) {
  return {{"deg", to_json(limit.value)}, {"lowest_deg", to_json(limit.lowest)}, {"highest_deg", to_json(limit.highest)}};
}

template <typename Value>
Json by_measure(const ByMeasure<Value>& values) {
  Json json = Json::object();
  for (std::size_t measure = 0; measure < kMeasures; ++measure) {
    for (std::size_t k = 0; k < kReaches.size(); ++k) {
      json[kKeys[measure]][std::to_string(kReaches[k]) + "_reaches"] = to_json(values[measure][k]);
    }
  }
  return json;
}

const std::vector<std::string>& notes() {
  static const std::vector<std::string> all{
      "All people are simulated, with models of body, seat and sensors: synthetic, no clinical claim.",
      "The trunk turns from its rest at the back rest, some 5 deg behind upright. Target at 100 % of the arm, which needs no trunk.",
      "A limit of detection (Currie 1968): mean of N reaches minus the mean of N reaches with the arm alone, same person, same target. 5 % "
      "of the differences without movement are above the decision threshold, and 95 % of those at the limit. One of three measures is "
      "enough: rise, ratio, dip.",
      "In brackets the 95 % interval of a repeated study: of a person over the reaches, of the median over the people. One person: no "
      "interval of the median."};
  return all;
}

/// One person has no spread over people, so the median has no interval.
bool has_interval(const Setup& setup) { return setup.people.size() > 1; }

std::string median_text(const Setup& setup, std::size_t reaches) {
  const LimitInterval& median = setup.medians[kAny][reaches];
  return has_interval(setup) ? text_of(median) : text_of(median.value);
}

Json medians_to_json(const Setup& setup) {
  Json medians = by_measure(setup.medians);
  if (has_interval(setup)) return medians;
  for (Json& of_measure : medians) {
    for (Json& median : of_measure) {
      median.erase("lowest_deg");
      median.erase("highest_deg");
    }
  }
  return medians;
}

std::string heading_of(const Setup& setup) { return decimal(setup.noise_mv, 1) + " mV, " + decimal(setup.rate_hz, 0) + " Hz"; }

void print_setups(const Resolution& resolution, cli::Console& console) {
  console.out << cli::styled(console, cli::Style::Bold, "Smallest turn of the trunk that the chair distinguishes from none (deg)")
              << "\n\n";
  cli::Table table({">NOISE (mV)", ">RATE (Hz)", ">1 REACH", ">3 REACHES", ">10 REACHES", ">9 IN 10 PEOPLE, 1 REACH"});
  for (const Setup& setup : resolution.setups) {
    table.add({{decimal(setup.noise_mv, 1)},
               {decimal(setup.rate_hz, 0)},
               {median_text(setup, 0)},
               {median_text(setup, 1)},
               {median_text(setup, 2)},
               {text_of(setup.worst_tenth[kAny][0])}});
  }
  table.print(console);
  console.out << '\n';
}

void print_measures(const Resolution& resolution, cli::Console& console) {
  console.out << cli::styled(console, cli::Style::Bold, "By one measure, one reach, median of the people (deg)") << "\n\n";
  cli::Table table({">NOISE (mV)", ">RATE (Hz)", ">RISE d2 / P1", ">RATIO FRONT TO REAR", ">DIP d1 / P1"});
  for (const Setup& setup : resolution.setups) {
    std::vector<cli::Cell> cells{{decimal(setup.noise_mv, 1)}, {decimal(setup.rate_hz, 0)}};
    for (std::size_t measure = 0; measure < kAny; ++measure) cells.push_back({text_of(setup.medians[measure][0].value)});
    table.add(std::move(cells));
  }
  table.print(console);
  console.out << '\n';
}

void print_people(const Resolution& resolution, cli::Console& console) {
  console.out << cli::styled(console, cli::Style::Bold, "Each simulated person, one reach (deg)") << "\n\n";
  std::vector<std::string> headers{"PERSON", ">WEIGHT (kg)"};
  for (const Setup& setup : resolution.setups) headers.push_back(">" + heading_of(setup));
  cli::Table table(std::move(headers));
  for (std::size_t k = 0; k < resolution.setups.front().people.size(); ++k) {
    const PersonResolution& person = resolution.setups.front().people[k];
    std::vector<cli::Cell> cells{{person.name}, {decimal(person.weight_kg, 0)}};
    for (const Setup& setup : resolution.setups) cells.push_back({text_of(setup.people[k].limits[kAny][0])});
    table.add(std::move(cells));
  }
  table.print(console);
  console.out << '\n';
}

}  // namespace

void print(const Resolution& resolution, cli::Console& console) {
  print_setups(resolution, console);
  print_measures(resolution, console);
  print_people(resolution, console);
  for (const std::string& note : notes()) console.out << "- " << note << '\n';
}

cli::Json to_json(const Resolution& resolution) {
  Json json{{"is_synthetic", true}, {"seed", resolution.seed}, {"reaches", resolution.reaches}, {"setups", Json::array()}};
  for (const Setup& setup : resolution.setups) {
    Json one{{"noise_mv", setup.noise_mv}, {"rate_hz", setup.rate_hz}};
    one["median"] = medians_to_json(setup);
    one["nine_in_ten"] = by_measure(setup.worst_tenth);
    one["people"] = Json::array();
    for (const PersonResolution& person : setup.people) {
      one["people"].push_back({{"name", person.name},
                               {"weight_kg", person.weight_kg},
                               {"missed_part", person.missed_part},
                               {"limits", by_measure(person.limits)}});
    }
    json["setups"].push_back(std::move(one));
  }
  json["notes"] = notes();
  return json;
}

CurvePlot picture_of(const Resolution& resolution) {
  CurvePlot plot{.title = "Smallest turn of the trunk distinguished from none, simulated people",
                 .x_label = "noise of a scan (mV)",
                 .y_label = "turn (deg)",
                 .curves = {}};
  Curve people{.name = "people, one reach", .points = {}, .style = CurveStyle::Points};
  for (std::size_t k = 0; k < kReaches.size(); ++k) {
    std::vector<double> rates;
    for (const Setup& setup : resolution.setups) {
      if (std::ranges::find(rates, setup.rate_hz) == rates.end()) rates.push_back(setup.rate_hz);
    }
    for (const double rate_hz : rates) {
      Curve curve{.name = std::to_string(kReaches[k]) + (kReaches[k] == 1 ? " reach, " : " reaches, ") + decimal(rate_hz, 0) + " Hz",
                  .points = {}};
      for (const Setup& setup : resolution.setups) {
        if (setup.rate_hz == rate_hz && setup.medians[kAny][k].value) {
          curve.points.emplace_back(setup.noise_mv, *setup.medians[kAny][k].value);
        }
      }
      plot.curves.push_back(std::move(curve));
    }
  }
  for (const Setup& setup : resolution.setups) {
    for (const PersonResolution& person : setup.people) {
      if (person.limits[kAny][0].value) people.points.emplace_back(setup.noise_mv, *person.limits[kAny][0].value);
    }
  }
  plot.curves.push_back(std::move(people));
  std::erase_if(plot.curves, [](const Curve& curve) { return curve.points.empty(); });
  return plot;
}

}  // namespace dts::lab::resolution
