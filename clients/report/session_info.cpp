// SPDX-License-Identifier: Apache-2.0
#include "report/session_info.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>

#include "record/catalogue/catalogue.h"
#include "record/xdf/recovery.h"
#include "report/recorded_definitions.h"

namespace dts::report {
namespace {

constexpr double kSameValue = 1e-9;
constexpr double kLargestUtcNs = 9e18;

core::Result<PartData> check_part(const std::string& path, const record::Recording& recording, Waiting& waiting, const Share& share) {
  PartData part{.file = std::filesystem::path(path).filename().string(),
                .sha256 = {},
                .damage = recording.damage(),
                .losses = to_text(recording.losses())};
  // Wrong values look like correct ones: only the checksums show damage. A value in a report must not be from a damaged file.
  const auto verified = record::verify(path, [&](std::uint64_t done, std::uint64_t of) {
    waiting.report(share, of > 0 ? static_cast<double>(done) / static_cast<double>(of) : 1.0);
    return waiting.is_wanted();
  });
  if (!waiting.is_wanted()) return interrupted();
  if (verified) {
    part.sha256 = verified->sha256;
    part.state = record::name(record::state_of(*verified, path));
  } else if (part.damage.empty()) {
    return core::fail(verified.error().code, verified.error().what, "copy the undamaged part: dtsctl session recover " + path);
  }
  return part;
}

}  // namespace

void Waiting::report(const Share& share, double fraction) {
  if (is_wanted_) is_wanted_ = progress_(share.begin + (share.end - share.begin) * std::clamp(fraction, 0.0, 1.0));
}

tl::unexpected<core::Error> interrupted() { return core::fail(core::ErrorCode::Failed, "the report was interrupted: no page was written"); }

core::Result<std::unique_ptr<record::Recording>> open_part(const std::string& path, Waiting& waiting, const Share& share,
                                                           SessionInfo& session) {
  DTS_TRY_ASSIGN(auto opened, record::Recording::open(path));
  if (session.parts.empty() && opened->session()) {
    DTS_TRY_ASSIGN(session.corrections, record::corrections_beside(path, *opened->session()));
    session.facts = record::corrected(*opened->session(), session.corrections);
    session.protocol = recorded_protocol(*session.facts);
    session.planned_trials = planned_trials(*session.facts);
  }
  DTS_TRY_ASSIGN(auto part, check_part(path, *opened, waiting, share));
  session.parts.push_back(std::move(part));
  return opened;
}

std::vector<std::string> leading_files(const std::vector<std::string>& files) {
  std::vector<std::string> leading;
  std::ranges::copy_if(files, std::back_inserter(leading), [](const std::string& file) {
    const auto facts = record::read_session_facts(file);
    return !facts || facts->leading_part == 0;
  });
  return leading.empty() ? files : leading;
}

std::optional<std::int64_t> utc_of(const std::optional<std::int64_t>& host_ns, const std::optional<record::SessionFacts>& facts) {
  if (!host_ns || !facts || facts->started_utc_ns <= 0) return std::nullopt;
  const double sum = static_cast<double>(*host_ns) + static_cast<double>(facts->utc_minus_monotonic_ns);
  if (!(std::abs(sum) < kLargestUtcNs)) return std::nullopt;
  return *host_ns + facts->utc_minus_monotonic_ns;
}

bool is_same_value(double a, double b) noexcept { return std::abs(a - b) <= kSameValue * std::max(std::abs(a), std::abs(b)); }

}  // namespace dts::report
