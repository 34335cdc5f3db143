// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "classifier/trunk_model.h"
#include "core/reach.h"
#include "physics/body/person.h"
#include "session/figure.h"
#include "session/trial_run.h"

namespace dts::session {

/// Targets that differ by less are the same: protocols have a resolution of 1 mm at best.
inline constexpr double kSameTargetCm = 0.05;

/// The result of one trial of the reaching task.
struct ReachTrialResult {
  std::uint32_t trial = 0;
  std::uint32_t attempt = 1;
  std::string condition{};
  std::optional<double> target_cm;
  std::uint32_t segment = 0;
  core::ScanIndex go;                           ///< Scan of the cue.
  bool has_gap = false;                         ///< Scans are missing between cue and end: the trial has no result.
  std::optional<core::ReachEvent> reach;        ///< Nothing if no reach was found between cue and end.
  std::optional<core::TrunkMovement> movement;  ///< On the subject's own scale once it is known; nothing without a reach or a model.
  /// Class of the trunk flexion expected for this target and subject; nothing without a target or the subject's measures.
  std::optional<core::TrunkClass> expected;
};

/// Builds the subject from the fields of the protocol (thesis Table 6.1): weight_kg, height_cm, arm_length_cm, max_reach_cm, group. Returns
/// nothing if a number is missing or not positive.
[[nodiscard]] std::optional<physics::Person> person_of(const std::vector<std::pair<std::string, std::string>>& fields);

/// Returns the class of the trunk flexion expected for a target at `target_cm`; nothing if the flexion is unknown.
[[nodiscard]] std::optional<core::TrunkClass> expected_class(const std::optional<physics::Person>& person, std::optional<double> target_cm);

/// Computes results from the events of a session: one per trial, and one summary. Depends only on its inputs, so that daemon, replay and
/// laboratory compute the same results. Thread: one at a time.
///
///     scans     go        P1     P2      P3    final   done
///     events    |---------x------x-------x-------x------|    a reach belongs to this trial if its P2 and its final are in [go, done)
///
/// P2, where the trunk starts to move forward, has the most exact time. P1 is traced back into the noise and may lie before the cue.
///
/// Memory is bounded: the newest `kMostPending` events of each kind, and twice as many attempts as a plan may have trials.
class ReachResults {
 public:
  static constexpr std::size_t kMostPending = 1024;
  static constexpr std::size_t kMostAttempts = std::size_t{2} * kMostTrials;

  /// `model` outlives this object; nullptr: reaches are not classified again.
  ReachResults(std::optional<physics::Person> person, const classifier::TrunkModel* model) : person_(person), model_(model) {}

  void take(const core::ReachEvent& event);
  void take(const core::ClassEvent& event);
  /// Processes an event of the protocol at its scan.
  void take(const TrialEvent& event, std::uint32_t segment, core::ScanIndex scan);
  /// Decides the trials that ended before `scan` of `segment`: all reaches and classes before this scan were passed to `take`.
  void advance(std::uint32_t segment, core::ScanIndex scan);
  /// Decides all remaining trials at the end of the session.
  void finish();

  /// Returns the trials decided since the last call, oldest first; how often it is called does not change the results. Leaves out void
  /// trials, and returns them if that is undone. A trial that is redone or rejected later is void in the summary.
  [[nodiscard]] std::vector<ReachTrialResult> take_decided();
  /// Returns all valid trials, classified with everything that is known now.
  [[nodiscard]] std::vector<ReachTrialResult> results() const;
  /// Returns the same for all trials that were decided, also those that are void now.
  [[nodiscard]] std::vector<ReachTrialResult> results_of_void_too() const;
  /// Returns the scale from the subject's first three consecutive maximum reaches that agree; nothing before they are known. One wrong
  /// reach does not prevent it, and later ones do not change earlier results.
  [[nodiscard]] std::optional<classifier::SubjectCalibration> own_scale() const;
  /// Returns trunk contribution at the critical boundary, classes per target, agreement with the expected class, consistency and
  /// smoothness: see reach_summary.h. Empty without a valid trial.
  [[nodiscard]] std::vector<SessionFigure> summary() const;

 private:
  struct Place {
    std::uint32_t segment = 0;
    core::ScanIndex scan;

    friend auto operator<=>(const Place&, const Place&) = default;
  };
  struct Attempt {
    std::string condition{};
    std::optional<double> target_cm;
    std::optional<Place> go;
    std::optional<Place> done;
    bool is_void = false;
    bool is_decided = false;
    std::optional<core::ReachEvent> reach;
    std::optional<core::TrunkMovement> live;  ///< The class from the rig's own pipeline.
  };
  using Key = std::pair<std::uint32_t, std::uint32_t>;  ///< Trial, attempt.

  void decide_until(const std::optional<Place>& place);
  void decide(const Key& key, Attempt& attempt);
  void undo(const Key& key);
  [[nodiscard]] std::optional<core::ReachEvent> reach_of(const Attempt& attempt) const;
  [[nodiscard]] std::optional<core::TrunkMovement> class_of(const core::ReachEvent& reach, const Place& done) const;
  [[nodiscard]] std::vector<const Attempt*> counting() const;
  [[nodiscard]] bool is_at_maximum(const Attempt& attempt) const;
  [[nodiscard]] std::vector<ReachTrialResult> results_of(bool with_void) const;
  [[nodiscard]] ReachTrialResult result_of(const Key& key, const Attempt& attempt,
                                           const std::optional<classifier::SubjectCalibration>& scale) const;

  std::optional<physics::Person> person_;
  const classifier::TrunkModel* model_;
  std::map<Key, Attempt> attempts_;
  std::vector<Key> undecided_;
  std::vector<ReachTrialResult> fresh_;  ///< Decided and not returned yet, each with what was known at that time.
  std::deque<core::ReachEvent> reaches_;
  std::deque<core::ClassEvent> classes_;
  std::optional<Place> complete_until_;
};

}  // namespace dts::session
