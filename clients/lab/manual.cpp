// SPDX-License-Identifier: Apache-2.0
#include "lab/manual.h"

#include <string>

#include "cli/documents.h"

namespace dts::lab {
namespace {

/// An indented example in man(7) format, line by line.
constexpr auto kPlateCase =
    ".SH PLATE CASES\nLengths in mm from a corner of the plate, forces in N, the modulus in Pa. Deflection is positive along the "
    "load.\n.PP\n.nf\n"
    "[plate]\n"
    "a_mm = 430.0             # along x; 10 to 10000\n"
    "b_mm = 430.0             # along y\n"
    "h_mm = 3.0               # thickness\n"
    "e_pa = 198.7e9           # Young's modulus\n"
    "nu = 0.27                # Poisson's ratio\n"
    "[support]\n"
    "kind = \\(dqcorner\\(dq          # four points; or edges, x\\-edges, clamped\n"
    "inset_mm = 0.0           # of the points from the corners\n"
    "[[load]]                 # a point\n"
    "x_mm = 215.0\n"
    "y_mm = 215.0\n"
    "force_n = 49.03\n"
    "[[load]]                 # spread evenly over a rectangle\n"
    "x0_mm = 0.0\n"
    "x1_mm = 400.0\n"
    "y0_mm = 0.0\n"
    "y1_mm = 360.0\n"
    "force_n = 480.0          # in total\n"
    "[[probe]]                # position at which to compute the deflection\n"
    "x_mm = 107.5\n"
    "y_mm = 107.5\n"
    "[solver]                 # optional\n"
    "method = \\(dqfdm\\(dq           # or fem\n"
    "divisions = 120          # of each side\n"
    "nonlinear = false        # true: von Karman, supports slide in the plane\n"
    "simpson = false          # true: point loads spread as in thesis eq. 3.13; fdm only\n"
    ".fi\n";

constexpr auto kTables =
    ".SH CSV FILES\nThe first line names the columns, in any order; unknown columns are ignored. An empty cell is "
    "an "
    "undefined value where that is allowed.\n"
    ".TP\n.B p_n, x_mm, y_mm, w1_mm, w2_mm, ...\nPoints of\n.BR \"dtslab cop\" :\nload in N, its position from a corner of the plate, "
    "deflection at each sensor in the order of the rig file. For\n.B cop estimate\nload and position may be missing; est_x_mm, "
    "est_y_mm, est_p_n and flags are added. The flags, joined by a bar, are no_contact, outside_area and outside_load; nothing: a good "
    "estimate.\n"
    ".TP\n.B person, stated_width_mm, stated_weight_n\nOptional columns for\n.B cop estimate\nwith a calibration of\n.BR \"dtslab cop "
    "two\\-feet\" .\nRows with the same person are one stance on two feet, and are corrected; a row without these values is a load in one "
    "point. stated_width_mm: between the middle lines of the feet. stated_weight_n: only a check. Further flags: about (no width stated), "
    "doubtful (the load differs from the stated weight by more than 5 %), outside_two_feet (unlike the stances of the correction), "
    "outside_travel (a deflection beyond the sensors).\n"
    ".TP\n.B t_s, true_ml_mm, true_ap_mm, true_load_n\nThe truth beside a recording of\n.BR \"dtslab simulate floor\" ;\n"
    "empty while no one is on the plate.\n"
    ".TP\n.B number, condition, target_cm, t_on_s, t_hit_s, t_back_s, t_end_s, trunk_deg\nThe truth beside a recording of\n"
    ".BR \"dtslab simulate chair\" :\none row for each reach that was completed; when it began, hit the target, turned back and ended, and "
    "the trunk's flexion at the target.\n"
    ".TP\n.B t_s, x_mm, y_mm, trigger, marker\nRecordings of\n.BR \"dtslab compare\" :\nincreasing time, position of the centre of "
    "pressure, "
    "and optionally a trigger level, or marker texts at their scans.\n"
    ".TP\n.B subject, trial, t_p1, t_p2, t_p3, p1_mm, p2_mm, p3_mm, class, p_class, trunk_deg, trunk_lo_deg, trunk_hi_deg\n"
    "What\n.B dtslab reach events\nand\n.B dtslab reach classify\nwrite: times in s from the first sample of each trial, levels of the "
    "transient, degree of trunk movement (1 minor, 2 moderate, 3 maximum, 0 none, \\-1 rejected), its probability, trunk flexion with its "
    "90 % interval. Empty: not found, or not known.\n"
    ".TP\n.B subjects.csv, trials.csv, sensors.csv, calibration.csv\nA folder of reaching trials. subjects: subject, group (healthy or "
    "stroke), weight_kg, "
    "height_cm, arm_cm, max_reach_cm; trials: subject, trial, condition (the target asked for: max, or percent of the arm's length such as "
    "120; may be empty), rate_hz, file; "
    "the volts of all trials of a file in rows of trial,v1,v2,v3,v4.\n"
    ".TP\n.B t_s, x_mm, y_mm, load_n\nQuiet standing for\n.BR \"dtslab sway\" :\nx to the subject's right, y forward; an empty cell is a "
    "missing sample, load_n is optional.\n"
    ".TP\n.B file, session, subject, trial, attempt, condition, LABELS, profile, fs_hz, n, duration_s, flags, MEASURES\n"
    "What\n.B dtslab sway \\-\\-table\nwrites, one row for each trial, and\n.B dtslab steadiness\nreads: flags joined by a bar, measures "
    "by their symbols (MVELO, PEA95_F, ...). Empty: not known, or not defined.\n"
    ".TP\n.B file, session, subject, trial, label, p_LABEL ..., outside\nWhat\n.B dtslab steadiness classify\nwrites: the label, its "
    "probability and that of each other one, the measures beyond the range that the model was trained on.\n"
    ".SH RECORDINGS\nXDF files of\n.BR dtsd .\n.B dtslab replay\nexits with 0 if every derived stream equals the values computed "
    "from the recorded raw stream, or if there is none; with 1 if a stream differs; with 2 if the file is not a recording of dtsd; with 7 "
    "if it is damaged.\n"
    ".B dtslab compare\nuses the stream cop of a recording, with its rising triggers and its markers.\n"
    ".B dtslab reach results\nuses the events reach, class and trial, the subject's measures and the model of trunk movement; exits with "
    "1 if a recorded "
    "result differs from the computed one.\n"
    ".B dtslab sway\nuses the stream cop and the trials of a recording; without trials, each period in which a person stands for 10 s. "
    "By "
    "the report's definition (profile lp10, 100 Hz) it exits with 1 if a recorded result differs from the computed one.\n"
    ".SH JSON\nNumbers are numbers. What is undefined is absent. Units are in the names.\n";

}  // namespace

cli::Manual make_manual() {
  return {.summary = "offline laboratory of the distributive tactile sensing daemon",
          .description =
              "Computes the bending of plates, recomputes the tables of the founding thesis, calibrates and evaluates estimators of the "
              "centre of "
              "pressure, finds and classifies reaches on the chair, measures the sway of standing people, records simulated people, and "
              "recomputes recordings bit by bit. "
              "Needs no running\n.BR dtsd (8).",
          .environment = {{"NO_COLOR", "If set, the output has no colours."}},
          .exit_statuses = {0, 1, 2, 4, 6, 7, 130},
          .further_sections = std::string(kPlateCase) + kTables + ".SH JSON\n" + cli::kJsonErrors,
          .files = {},
          .see_also = {{"dtsctl", 1}, {"dtsd", 8}, {"gnuplot", 1}}};
}

}  // namespace dts::lab
