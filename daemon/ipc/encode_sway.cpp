// SPDX-License-Identifier: Apache-2.0
#include "ipc/encode_sway.h"

#include <cmath>

#include "record/utf8_text.h"

namespace dts::ipc {
namespace {

using posturography::Measure;
using record::clean_text;
namespace flag = posturography::sway_flag;

static_assert(flag::kShortRecord == dts::v1::SWAY_FLAG_SHORT_RECORD && flag::kMissingSamples == dts::v1::SWAY_FLAG_MISSING_SAMPLES &&
              flag::kConstant == dts::v1::SWAY_FLAG_CONSTANT && flag::kSteppedOff == dts::v1::SWAY_FLAG_STEPPED_OFF &&
              flag::kMoved == dts::v1::SWAY_FLAG_MOVED && flag::kDoubtful == dts::v1::SWAY_FLAG_DOUBTFUL &&
              flag::kUnclearCriticalPoint == dts::v1::SWAY_FLAG_UNCLEAR_CRITICAL_POINT);

void add(dts::v1::Sway& out, Measure measure, double value) {
  if (!std::isfinite(value)) return;
  const posturography::MeasureInfo& about = posturography::info(measure);
  dts::v1::SwayMeasure& entry = *out.add_measures();
  entry.set_symbol(std::string(about.symbol));
  entry.set_value(value);
  entry.set_unit(std::string(about.unit));
}

void add_running(dts::v1::Sway& out, const core::RunningSway& values) {
  if (values.samples < 2) return;
  const double duration_s = static_cast<double>(values.samples) / values.rate_hz;
  add(out, Measure::Rdist, values.rdist_mm);
  add(out, Measure::RdistAp, values.rdist_ap_mm);
  add(out, Measure::RdistMl, values.rdist_ml_mm);
  add(out, Measure::Totex, values.totex_mm);
  add(out, Measure::TotexAp, values.totex_ap_mm);
  add(out, Measure::TotexMl, values.totex_ml_mm);
  add(out, Measure::Mvelo, values.totex_mm / duration_s);
  add(out, Measure::MveloAp, values.totex_ap_mm / duration_s);
  add(out, Measure::MveloMl, values.totex_ml_mm / duration_s);
  add(out, Measure::RangeAp, values.range_ap_mm);
  add(out, Measure::RangeMl, values.range_ml_mm);
  if (values.samples < 3) return;
  add(out, Measure::Pea95F, values.pea95_f_mm2);
  add(out, Measure::EllSd1, values.ellipse_sd1_mm);
  add(out, Measure::EllSd2, values.ellipse_sd2_mm);
  add(out, Measure::EllAngle, values.ellipse_angle_deg);
}

void set_analysis(dts::v1::Sway& out, const posturography::Analysis& analysis) {
  out.set_profile(std::string(posturography::name(analysis.profile)));
  out.set_rate_hz(analysis.rate_hz);
  out.set_samples(analysis.samples);
  out.set_duration_s(analysis.duration_s);
  out.set_flags(analysis.flags);
  out.set_is_valid(analysis.is_valid());
  for (std::size_t index = 0; index < posturography::kMeasureCount; ++index) {
    const auto measure = static_cast<Measure>(index);
    if (const auto value = analysis.measures.get(measure)) add(out, measure, *value);
  }
}

}  // namespace

dts::v1::Event sway_event(std::uint64_t instance_id, const core::SwayEvent& event) {
  dts::v1::Event out;
  out.set_instance_id(instance_id);
  out.set_segment(event.segment);
  out.set_scan(event.scan.value);
  out.set_host_time_ns(event.host_time_ns);
  dts::v1::Sway& sway = *out.mutable_sway();
  sway.set_is_preliminary(true);
  sway.set_trial(event.trial);
  sway.set_first_scan(event.first_scan.value);
  sway.set_end_scan(event.scan.value + 1);
  sway.set_profile(std::string(posturography::name(posturography::Profile::Lp10)));
  sway.set_rate_hz(event.values.rate_hz);
  sway.set_samples(event.values.samples);
  if (event.values.rate_hz > 0.0) sway.set_duration_s(static_cast<double>(event.values.samples) / event.values.rate_hz);
  sway.set_is_valid(true);
  add_running(sway, event.values);
  return out;
}

dts::v1::Sway sway(const session::SwayTrialResult& result, const std::string& session_id, const std::string& software) {
  dts::v1::Sway out;
  out.set_session_id(session_id);
  out.set_trial(result.trial);
  out.set_attempt(result.attempt);
  out.set_condition(clean_text(result.condition));
  for (const auto& [label, word] : result.labels) (*out.mutable_labels())[clean_text(label)] = clean_text(word);
  out.set_first_scan(result.first_scan.value);
  out.set_end_scan(result.end_scan.value);
  out.set_software(clean_text(software));
  out.set_problem(clean_text(result.problem));
  if (result.analysis) set_analysis(out, *result.analysis);
  return out;
}

}  // namespace dts::ipc
