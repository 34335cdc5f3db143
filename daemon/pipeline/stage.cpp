// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stage.h"

namespace dts::pipeline {

double StageOptions::number(std::string_view name) const { return std::get<double>(values_.at(std::string(name))); }

const std::string& StageOptions::word(std::string_view name) const { return std::get<std::string>(values_.at(std::string(name))); }

}  // namespace dts::pipeline
