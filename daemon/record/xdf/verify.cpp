// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "record/xdf/number_text.h"
#include "record/xdf/recovery.h"
#include "record/xdf/survey.h"

namespace dts::record {
namespace {

constexpr double kTimeToleranceS = 1e-3;  ///< Other programs write footers with fewer digits.

tl::unexpected<core::Error> contradiction(const StreamSurvey& stream, const std::string& what) {
  return core::fail(core::ErrorCode::DataDamaged, "the footer of stream " + stream.name + " contradicts its samples: " + what);
}

core::Status check_footer(const StreamSurvey& stream) {
  if (!stream.footer) return {};
  const auto& footer = *stream.footer;
  if (footer.sample_count && *footer.sample_count != stream.samples)
    return contradiction(stream, std::to_string(*footer.sample_count) + " in the footer, " + std::to_string(stream.samples) + " found");
  if (stream.samples == 0) return {};
  const auto fits = [](std::optional<double> footer_s, double found_s) {
    return !footer_s || *footer_s == found_s || std::abs(*footer_s - found_s) <= kTimeToleranceS;
  };
  if (!fits(footer.first_time_s, stream.first_time_s)) return contradiction(stream, "the first time stamp is another");
  if (!fits(footer.last_time_s, stream.last_time_s)) return contradiction(stream, "the last time stamp is another");
  return {};
}

core::Status check(const Survey& found) {
  if (found.fault) return tl::make_unexpected(*found.fault);
  if (!found.has_file_header) return core::fail(core::ErrorCode::DataDamaged, "the file ends before its file header");
  if (found.index_fault) return tl::make_unexpected(*found.index_fault);
  for (const auto& [number, stream] : found.streams) DTS_TRY(check_footer(stream));
  return {};
}

}  // namespace

core::Result<Verification> verify(const std::string& file, const Progress& progress) {
  DTS_TRY_ASSIGN(const auto found, survey(file, progress));
  if (auto status = check(found); !status) return core::fail(status.error().code, file + ": " + status.error().what, status.error().hint);
  const StreamSurvey* const longest = found.longest_stream();
  Verification verification{.sha256 = found.sha256, .bytes = found.size, .chunks = found.chunks, .scans = longest ? longest->samples : 0};
  verification.duration_s = found.duration_s();
  verification.has_index = found.is_all_indexed;
  verification.is_closed = found.is_closed();
  verification.incomplete = found.footer_fact("incomplete");
  verification.is_recovered = !found.footer_fact("recovered").empty();
  const double lost_s = number_of<double>(found.footer_fact("lost_s_at_most")).value_or(0.0);
  verification.lost_s_at_most = std::isfinite(lost_s) ? std::max(lost_s, 0.0) : 0.0;
  return verification;
}

}  // namespace dts::record
