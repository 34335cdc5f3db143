// SPDX-License-Identifier: Apache-2.0
#include "record/session_facts.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <string_view>

#include "record/stream_info.h"

namespace dts::record {
namespace {

using Facts = std::vector<std::pair<std::string, std::string>>;

constexpr std::size_t kMaxTextBytes = 1U << 20U;
constexpr std::size_t kMaxListed = 256;  ///< Most stages, and most fields.
constexpr std::size_t kMaxRigs = 64;
constexpr std::string_view kField = "field.";
constexpr const char* kVersion = "format_version";

struct TextFact {
  const char* name;
  std::string SessionFacts::*member;
};
constexpr TextFact kTexts[] = {{"session_id", &SessionFacts::session_id},
                               {"rig", &SessionFacts::rig},
                               {"kind", &SessionFacts::kind},
                               {"protocol", &SessionFacts::protocol},
                               {"subject", &SessionFacts::subject},
                               {"label", &SessionFacts::label},
                               {"boot_id", &SessionFacts::boot_id},
                               {"software", &SessionFacts::software},
                               {"device_uri", &SessionFacts::device_uri},
                               {"device_model", &SessionFacts::device_model},
                               {"device_serial", &SessionFacts::device_serial},
                               {"firmware", &SessionFacts::firmware},
                               {"calibration_id", &SessionFacts::calibration_id},
                               {"rig_definition", &SessionFacts::rig_definition},
                               {"protocol_definition", &SessionFacts::protocol_definition},
                               {"model_sha256", &SessionFacts::model_sha256}};

template <class Number>
core::Status read_number(const Facts& facts, const char* name, Number& number) {
  const std::string text = fact(facts, name);
  if (text.empty()) return {};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error == std::errc{} && end == text.data() + text.size()) return {};
  return core::fail(core::ErrorCode::DataDamaged, std::string("the fact ") + name + " is not a valid number: '" + text.substr(0, 40) + "'");
}

std::string shortest(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

core::Status read_version(const Facts& facts) {
  int version = 0;
  DTS_TRY(read_number(facts, kVersion, version));
  if (version == kFormatVersion) return {};
  return core::fail(core::ErrorCode::DataDamaged, std::string("the fact ") + kVersion + " is '" + fact(facts, kVersion).substr(0, 40) +
                                                      "', only " + std::to_string(kFormatVersion) + " is supported");
}

core::Status read_stages(const Facts& facts, SessionFacts& session) {
  std::uint64_t count = 0;
  DTS_TRY(read_number(facts, "stages", count));
  if (count > kMaxListed) return core::fail(core::ErrorCode::DataDamaged, "the fact stages is " + std::to_string(count) + ", at most 256");
  for (std::uint64_t stage = 1; stage <= count; ++stage) session.stages.push_back(fact(facts, "stage." + std::to_string(stage)));
  return {};
}

core::Status read_rigs(const Facts& facts, SessionFacts& session) {
  std::uint64_t count = 0;
  DTS_TRY(read_number(facts, "rigs", count));
  if (count > kMaxRigs) return core::fail(core::ErrorCode::DataDamaged, "the fact rigs is " + std::to_string(count) + ", at most 64");
  for (std::uint64_t rig = 1; rig <= count; ++rig) session.rigs.push_back(fact(facts, "rigs." + std::to_string(rig)));
  DTS_TRY(read_number(facts, "leading_part", session.leading_part));
  const auto wrong = [](const std::string& what) { return core::fail(core::ErrorCode::DataDamaged, what); };
  if (!session.rigs.empty() && std::ranges::find(session.rigs, session.rig) == session.rigs.end()) {
    return wrong("the rig '" + session.rig + "' is not one of the facts rigs");
  }
  if (session.leading_part == 0) return {};
  if (session.rigs.empty() || session.leading_part >= session.part) {
    return wrong("the fact leading_part is " + std::to_string(session.leading_part) +
                 ", which is no earlier part of a session over several rigs");
  }
  return {};
}

core::Status read_fields(const Facts& facts, SessionFacts& session) {
  for (const auto& [name, text] : facts)
    if (name.starts_with(kField)) session.fields.emplace_back(name.substr(kField.size()), text);
  if (session.fields.size() <= kMaxListed) return {};
  return core::fail(core::ErrorCode::DataDamaged, "there are " + std::to_string(session.fields.size()) + " facts field.*, at most 256");
}

}  // namespace

bool is_id(std::string_view text) noexcept {
  return text.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.-") == std::string_view::npos;
}

const std::string& leading_rig(const SessionFacts& facts) noexcept { return facts.rigs.empty() ? facts.rig : facts.rigs.front(); }
std::uint32_t leading_part(const SessionFacts& facts) noexcept { return facts.leading_part == 0 ? facts.part : facts.leading_part; }

Facts to_facts(const SessionFacts& session) {
  Facts facts = {{kVersion, std::to_string(kFormatVersion)}};
  for (const auto& [name, member] : kTexts)
    if (const std::string& text = session.*member; !text.empty()) facts.emplace_back(name, text);
  facts.emplace_back("part", std::to_string(session.part));
  if (!session.rigs.empty()) facts.emplace_back("rigs", std::to_string(session.rigs.size()));
  for (std::size_t rig = 0; rig < session.rigs.size(); ++rig) facts.emplace_back("rigs." + std::to_string(rig + 1), session.rigs[rig]);
  if (session.leading_part != 0) facts.emplace_back("leading_part", std::to_string(session.leading_part));
  facts.emplace_back("started_utc_ns", std::to_string(session.started_utc_ns));
  facts.emplace_back("utc_minus_monotonic_ns", std::to_string(session.utc_minus_monotonic_ns));
  facts.emplace_back("plan_seed", std::to_string(session.plan_seed));
  if (session.duration_s > 0.0) facts.emplace_back("duration_s", shortest(session.duration_s));
  if (session.settle_s > 0.0) facts.emplace_back("settle_s", shortest(session.settle_s));
  for (const auto& [name, text] : session.fields) facts.emplace_back(std::string(kField) + name, text);
  facts.emplace_back("stages", std::to_string(session.stages.size()));
  for (std::size_t stage = 0; stage < session.stages.size(); ++stage)
    facts.emplace_back("stage." + std::to_string(stage + 1), session.stages[stage]);
  return facts;
}

core::Result<SessionFacts> session_facts(const Facts& facts) {
  for (const auto& [name, text] : facts)
    if (text.size() > kMaxTextBytes)
      return core::fail(core::ErrorCode::DataDamaged, "the fact " + name.substr(0, 40) + " is longer than 1 MiB");
  SessionFacts session;
  for (const auto& [name, member] : kTexts) session.*member = fact(facts, name);
  for (const auto& status :
       {read_version(facts), read_number(facts, "part", session.part), read_number(facts, "started_utc_ns", session.started_utc_ns),
        read_number(facts, "utc_minus_monotonic_ns", session.utc_minus_monotonic_ns), read_number(facts, "plan_seed", session.plan_seed),
        read_number(facts, "duration_s", session.duration_s), read_number(facts, "settle_s", session.settle_s), read_stages(facts, session),
        read_rigs(facts, session), read_fields(facts, session)})
    if (!status) return tl::make_unexpected(status.error());
  return session;
}

}  // namespace dts::record
