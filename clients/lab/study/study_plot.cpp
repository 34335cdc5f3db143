// SPDX-License-Identifier: Apache-2.0
#include "lab/study/study_plot.h"

#include <sstream>

#include "lab/base/gnuplot.h"
#include "lab/study/angle_windows.h"

namespace dts::lab::study {
namespace {

using core::TrunkClass;

// gnuplot treats axis labels as formats: %% is a percent sign.
constexpr std::array<TrunkClass, 3> kDrawnClasses = {TrunkClass::Minor, TrunkClass::Moderate, TrunkClass::Maximum};

/// Rows from the bottom: 120 %, 150 %, maximum.
void write_confusion(std::ostream& script, const std::string& name, const Confusion& answers) {
  script << "$" << name << " << END\n";
  for (std::size_t row = 0; row < kDrawnClasses.size(); ++row) {
    for (std::size_t column = 0; column < kEveryAnswer.size(); ++column) {
      script << column << ' ' << row << ' ' << answers.count(kDrawnClasses[row], kEveryAnswer[column]) << '\n';
    }
  }
  script << "END\n";
}

void plot_confusion(std::ostream& script, const std::string& name, const std::string& title) {
  script << "set title '" << title << "'\nset xtics rotate by -30 ('no answer' 0, 'none' 1, 'minor' 2, 'moderate' 3, 'maximum' 4)\n"
         << "set ytics ('120 %%' 0, '150 %%' 1, 'maximum' 2)\nset xrange [-0.5:4.5]\nset yrange [-0.5:2.5]\nset cbrange [0:150]\n"
         << "set xlabel 'answer'\nset ylabel 'target'\nunset colorbox\nunset key\n"
         << "plot $" << name << " using 1:2:3 with image, $" << name
         << " using 1:2:(sprintf('%d', $3)):($3 > 75 ? 0x000000 : 0xffffff) with labels tc rgb variable\n";
}

void write_windows(std::ostream& script) {
  const auto windows = angle_windows();
  for (const bool is_measured : {true, false}) {
    script << (is_measured ? "$measured" : "$geometry") << " << END\n";
    for (std::size_t k = 0; k < windows.size(); ++k) {
      const Window& window = is_measured ? windows[k].measured : windows[k].geometry;
      script << static_cast<double>(k) + (is_measured ? -0.12 : 0.12) << ' ' << window.mean_deg << ' ' << window.least_deg << ' '
             << window.most_deg << '\n';
    }
    script << "END\n";
  }
}

void plot_windows(std::ostream& script) {
  script << "set title 'Trunk angle of H1 to H10: least, mean, most'\nset xtics norotate ('120 %%' 0, '150 %%' 1, 'maximum' 2)\nset ytics "
            "auto\n"
         << "set xrange [-0.5:2.5]\nset yrange [0:75]\nset xlabel 'target'\nset ylabel 'trunk angle (deg)'\nset key top left\n"
         << "plot 15.25 lc rgb 'grey' dt 2 notitle, 42.2 lc rgb 'grey' dt 2 title 'between the classes', "
         << "$measured using 1:2:3:4 with yerrorbars lw 2 pt 7 lc rgb '#d1495b' title 'measured (Table 6.3)', "
         << "$geometry using 1:2:3:4 with yerrorbars lw 2 pt 5 lc rgb '#3b528b' title 'from the target'\n";
}

}  // namespace

std::string study_script(const Draw& draw) {
  std::ostringstream script;
  script.precision(9);
  write_confusion(script, "nn1", sum(draw.nn1.healthy));
  write_confusion(script, "nn2", sum(draw.nn2.healthy));
  write_confusion(script, "own", sum(draw.recommended.own.answers));
  write_windows(script);
  script << "set palette defined (0 '#440154', 1 '#3b528b', 2 '#21918c', 3 '#5ec962', 4 '#fde725')\nset tics out nomirror\n"
         << "set multiplot layout 2,2 title 'Simulated people, seed " << draw.seed << ": synthetic'\n";
  plot_confusion(script, "nn1", "H1 to H10 by NN1");
  plot_confusion(script, "nn2", "H1 to H10 by NN2");
  plot_confusion(script, "own", "A to C, H1 to H10: recommended, each left out, own scale");
  plot_windows(script);
  script << "unset multiplot\n";
  return script.str();
}

core::Status draw_study(const Draw& draw, const std::string& file) { return lab::draw(study_script(draw), file); }

}  // namespace dts::lab::study
