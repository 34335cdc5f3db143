// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "unit/pipeline/reaching_signal.h"
#include "unit/record/xdf_fixture.h"

namespace dts::lab::reach {

/// A folder of synthetic trials, laid out as the development data; removed at the end.
class TrialFolder {
 public:
  TrialFolder() {
    write("subjects.csv",
          "subject,group,sex,weight_kg,height_cm,arm_cm,max_reach_cm,fugl_meyer\nP,healthy,M,68,175,67,124,\nQ,stroke,F,52,165,59,115,41/"
          "60\n");
    write("sensors.csv",
          "channel,thesis_number,x_mm,y_mm,tare_v\n1,2,140,120,0.6263\n2,5,260,120,0.6263\n3,10,140,220,0.6263\n4,13,260,220,0.6263\n");
    std::ostringstream calibration;
    calibration << "d_mm,v1,v2,v3,v4\n";
    for (double gap_mm = 0.5; gap_mm <= 12.01; gap_mm += 0.25) {
      calibration << gap_mm;
      for (int c = 0; c < 4; ++c) calibration << ',' << volts_at(gap_mm);
      calibration << '\n';
    }
    write("calibration.csv", calibration.str());
    write("trials.csv", "subject,trial,file,rate_hz,condition\nP,1,P.csv,100,150\nP,2,P.csv,100,80\nQ,1,Q.csv,100,max\n");
    const pipeline::SeatedPerson still;
    const pipeline::SeatedPerson reaching{.reaches = {{.start_s = 1.5}}};
    write("P.csv", "trial,v1,v2,v3,v4\n" + rows(1, reaching) + rows(2, still));
    write("Q.csv", "trial,v1,v2,v3,v4\n" + rows(1, reaching));
  }
  [[nodiscard]] std::string path() const { return folder_ / ""; }
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  void remove(const std::string& name) const { std::filesystem::remove(folder_ / name); }

  /// The shape of reach-model section 4.
  static double volts_at(double gap_mm) { return 0.3 + 4.0 / (1.0 + std::pow(gap_mm / 2.5, 2.0)); }
  static std::string rows(int trial, const pipeline::SeatedPerson& person) {
    constexpr double kTareGapMm = 8.38848;  // where volts_at gives 0.6263
    const pipeline::Signal deflections = pipeline::deflections_of(person, 6.0, 100.0, static_cast<std::uint64_t>(trial));
    std::ostringstream text;
    text.precision(6);
    for (std::size_t i = 0; i < deflections.scans(); ++i) {
      text << trial;
      for (std::size_t c = 0; c < 4; ++c) text << ',' << volts_at(kTareGapMm - deflections.values[c][i]);
      text << '\n';
    }
    return text.str();
  }

 private:
  record::xdf_test::Folder folder_;
};

}  // namespace dts::lab::reach
