// SPDX-License-Identifier: Apache-2.0
#include "record/export/bids_names.h"

#include <algorithm>
#include <iterator>

namespace dts::record {
namespace {

constexpr std::size_t kLongestLabel = 48;  // four labels and their separators fit the name limit of every file system

bool is_letter_or_digit(char letter) {
  return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') || (letter >= '0' && letter <= '9');
}

}  // namespace

std::string bids_label(std::string_view text, std::string_view otherwise) {
  std::string label;
  std::ranges::copy_if(text, std::back_inserter(label), is_letter_or_digit);
  label.resize(std::min(label.size(), kLongestLabel));
  return label.empty() ? std::string(otherwise) : label;
}

BidsNames::BidsNames(const Recording& recording, const std::string& subject) {
  const SessionFacts session = recording.session().value_or(SessionFacts{});
  rig_ = session.rig;
  subject_ = "sub-" + bids_label(subject, "unknown");
  session_ = "ses-" + bids_label(session.session_id, "unknown");
  task_ = bids_label(session.protocol, "free");
  // Companions have the same run and a tracking system of their own, unless the names of their rigs become equal.
  const auto has_same_label = [&](const std::string& rig) { return bids_label(rig, "") == bids_label(session.rig, ""); };
  const std::uint32_t run = std::ranges::count_if(session.rigs, has_same_label) > 1 ? session.part : leading_part(session);
  if (run > 1) run_ = "_run-" + std::to_string(run);
}

std::string BidsNames::tracking_system(const StreamInfo& stream) const {
  const std::size_t slash = stream.name.rfind('/');
  const std::string rig = slash == std::string::npos ? rig_ : stream.name.substr(0, slash);
  return bids_label(rig + short_name(stream.name), "stream");
}

std::string BidsNames::path(const std::string& tracking_system, const std::string& suffix) const {
  return subject_ + "/" + session_ + "/" + path_in_session(tracking_system, suffix);
}

std::string BidsNames::path_in_session(const std::string& tracking_system, const std::string& suffix) const {
  return "motion/" + subject_ + "_" + session_ + "_task-" + task_ + "_tracksys-" + tracking_system + run_ + "_" + suffix;
}

std::string BidsNames::scans_table() const { return subject_ + "/" + session_ + "/" + subject_ + "_" + session_ + "_scans.tsv"; }

}  // namespace dts::record
