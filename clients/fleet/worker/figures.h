// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"

namespace dts::fleet::worker {

/// A row of table `result`.
struct Figure {
  std::string name;    ///< As in the clinic's own results: "eyes-open/MVELO", of a later part "eyes-open/MVELO_part_2".
  double value = 0.0;  ///< Finite.
  std::string unit;
  std::string details;  ///< JSON; may be empty.
};

/// What one analysis found.
struct Figures {
  std::vector<Figure> all;                 ///< Names differ.
  std::size_t skipped = 0;                 ///< Without a usable name, finite value or unit.
  std::optional<core::Error> rejection{};  ///< Why dtslab could not analyse this recording.
};

}  // namespace dts::fleet::worker
