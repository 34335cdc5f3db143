// SPDX-License-Identifier: Apache-2.0
#include "report/chair_parts.h"

#include <cmath>

#include "report/number_text.h"
#include "report/page_parts.h"

namespace dts::report {

Notes provenance_of_chair(const ChairData& chair, std::size_t first_part, std::size_t end_part) {
  std::string model = "none in the recording: the recorded classes are shown";
  if (chair.model) {
    const classifier::TrainingFacts& facts = chair.model->form().facts;
    model = "trained with " + std::to_string(facts.trials) + " reaches of " +
            std::to_string(facts.subjects.size() + facts.simulated_subjects) + " people, " + std::to_string(facts.simulated_subjects) +
            " of them simulated, by " + (facts.software.empty() ? "-" : facts.software);
    if (!facts.data_sha256.empty()) model += "; training data SHA-256 " + facts.data_sha256;
  }
  return provenance_notes(provenance_of(chair, first_part, end_part, {{.name = "Model of trunk movement", .value = model}}));
}

Notes methods_of_chair(const ChairData& chair) {
  std::string text = chair.is_synthetic() ? "The data are synthetic, no person was measured: the seat's deflection was simulated for"
                                          : "The deflection of the seat was recorded with";
  text += " an instrumented chair";
  if (chair.facts && !chair.facts->device_model.empty()) text += ", data acquisition by " + chair.facts->device_model + ",";
  if (!chair.trials.empty() && chair.trials.front().raw_rate_hz > 0.0)
    text += " at " + significant(chair.trials.front().raw_rate_hz) + " Hz";
  if (chair.facts && !chair.facts->software.empty()) text += " (" + chair.facts->software + ")";
  text +=
      ". The transient is the mean deflection at four sensors; reaches were found in its means over 50 ms at 100 Hz. P1 is the start of "
      "the "
      "reach, P2 the minimum of the reach initiation, P3 the maximum (thesis on distributive tactile sensing, section 5.3.3); d1 = P1 - "
      "P2, "
      "d2 = P3 - P1. Smoothness is the spectral arc length of the transient's speed from P1 to P3, up to 10 Hz, amplitude threshold 0.05 "
      "(Balasubramanian et al. 2012, 2015). It is of the seat, not of the hand: do not compare it with published values of hand movements. "
      "The trunk angle at P3 is a regression on features of the transient; the class is none, minor (below 15.25 \u00B0), moderate, or "
      "maximum "
      "(from 42.2 \u00B0).";
  if (!chair.software.empty()) text += " All values were computed with " + chair.software + ".";
  return {.title = "Methods, for a paper",
          .items = {std::move(text),
                    "Balasubramanian S, Melendez-Calderon A, Burdet E. A robust and sensitive metric for quantifying movement smoothness. "
                    "IEEE Trans Biomed Eng 2012; 59: 2126-2136.",
                    "Balasubramanian S, Melendez-Calderon A, Roby-Brami A, Burdet E. On the analysis of movement smoothness. J NeuroEng "
                    "Rehabil 2015; 12: 112."}};
}

std::string model_note(const ChairData& chair) {
  if (!chair.model) return "Accuracy: unknown, the recording has no model of trunk movement.";
  const classifier::ModelFigures& figures = chair.model->form().figures;
  const bool is_known = std::isfinite(figures.left_out_kept) && std::isfinite(figures.left_out_kept_accuracy);
  if (!is_known) return "Accuracy: not measured for this model of trunk movement.";
  const bool is_simulated = chair.model->form().facts.subjects.empty();
  std::string note = "Accuracy of the general model for people who were not in its training: " + fixed(100.0 * figures.left_out_kept, 0) +
                     " % of the reaches get a class, and " + fixed(100.0 * figures.left_out_kept_accuracy, 0) +
                     " % of these classes are right";
  if (std::isfinite(figures.left_out_angle_rms_deg))
    note += "; RMS error of the angle " + fixed(figures.left_out_angle_rms_deg, 1) + " \u00B0";
  return note + (is_simulated ? ". All these people were simulated: the accuracy for real people is not known." : ".");
}

std::string explanation_of_chair() {
  return "The transient falls when the trunk leaves the back rest (reach initiation, P1 to P2) and rises while the trunk bends (to P3). "
         "Trunk angle: 0 \u00B0 is upright, forward is positive. 90 % interval: meant to contain the true angle in 9 of 10 reaches; "
         "checked with simulated people only. Smoothness: "
         "nearer to 0 is smoother.";
}

}  // namespace dts::report
