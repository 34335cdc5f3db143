// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "physics/cop/two_feet.h"

namespace dts::physics::test {

/// Constants: 2 mm to the right, 3 mm back, 10 % more load; without the width 20 %.
inline TwoFeetForm constant_form() {
  TwoFeetForm form;
  form.without_width.feature_count = 3;
  for (TwoFeetPolynomial* polynomial : {&form.with_width, &form.without_width}) {
    polynomial->features = {{{.mean = 215.0, .sd = 20.0, .range = {155.0, 275.0}},
                             {.mean = 215.0, .sd = 20.0, .range = {145.0, 285.0}},
                             {.mean = 700.0, .sd = 200.0, .range = {400.0, 1000.0}},
                             {.mean = 185.0, .sd = 40.0, .range = {90.0, 280.0}}}};
    polynomial->x_mm[0] = 2.0;
    polynomial->y_mm[0] = -3.0;
  }
  form.without_width.features[3] = {};
  form.with_width.log_load[0] = std::log(1.1);
  form.without_width.log_load[0] = std::log(1.2);
  return form;
}

}  // namespace dts::physics::test
