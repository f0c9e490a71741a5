// The constants that decide a diagnosis, of stage 3: rows of the table in host/identify/criteria.hpp.
#pragma once

// clang-format off
#define PVG_CRITERIA_LOCALISATION(X) \
  X(3, double, time_localisation, 0.45, "--minutes", \
    "when the localisation ends", \
    "chosen by judgement: the later stages need most of the time") \
  X(3, double, rest_speed, 2e-3, "m/s", \
    "speed below which a body is at rest", \
    "chosen by judgement, not measured") \
  X(3, double, rest_spin, 2e-2, "rad/s", \
    "spin below which a body is at rest", \
    "chosen by judgement, not measured") \
  X(3, double, slip_speed, 5e-3, "m/s", \
    "speed across the normal above which a contact slips", \
    "chosen by judgement, not measured") \
  X(3, double, impact_speed, 0.1, "m/s", \
    "speed along the normal above which a contact is an impact", \
    "chosen by judgement, not measured") \
  X(3, double, roll_spin, 0.2, "rad/s", \
    "spin above which a body on a contact that does not slip rolls", \
    "chosen by judgement, not measured") \
  X(3, double, locate_window, 0.25, "s", \
    "window in which a cell is located", \
    "not recorded") \
  X(3, double, false_discoveries, 0.01, "1", \
    "false discovery rate of cells", \
    "convention (Benjamini, Hochberg 1995)") \
  X(3, std::size_t, onset_n_samples, 8, "1", \
    "samples in a row that mark an onset", \
    "not recorded") \
  X(3, double, onset_p_value, 1e-4, "1", \
    "p-value of such a stretch", \
    "not recorded")
// clang-format on
