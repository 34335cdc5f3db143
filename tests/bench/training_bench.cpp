// SPDX-License-Identifier: Apache-2.0
// How long the eleven networks of a model take to train on 135 reaches of five features (thesis 5.3.4), beside scikit-learn's
// MLPClassifier with the same layers on the same rows. The rows are synthetic. Prints a Markdown table; the second row is left out, with a
// line that says so, when python3 cannot import sklearn.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/clock.h"
#include "lab/training/network_training.h"

namespace {

using namespace dts::lab::training;

constexpr std::size_t kRows = 135;
constexpr std::size_t kNetworks = 11;
constexpr int kRounds = 7;

/// d1, d2, P1, P2, P3 of three people at three targets, already scaled.
Batch reaches() {
  Batch batch{.input_count = 5, .inputs = {}, .classes = {}};
  Random random(1);
  for (std::size_t row = 0; row < kRows; ++row) {
    const std::size_t target = row % 3;
    const double body = static_cast<double>(row / 45) - 1.0;
    const double swing = (static_cast<double>(target) - 1.0) * 0.8 + 0.15 * body + random.uniform(-0.15, 0.15);
    const double dip = random.uniform(-1.0, 1.0);
    for (const double value : {dip, swing, 0.9 * body, 0.9 * body - 0.1 * dip, 0.5 * body + 0.5 * swing}) batch.inputs.push_back(value);
    batch.classes.push_back(target);
  }
  return batch;
}

constexpr const char* kPeer = R"(
import sys, time, warnings
try:
    import numpy as np
    from sklearn.neural_network import MLPClassifier
except ImportError:
    sys.exit(77)
warnings.simplefilter("ignore")
table = np.loadtxt(sys.argv[1], delimiter=",")
x, y = table[:, :-1], table[:, -1].astype(int)
times, right = [], 0.0
for _ in range(int(sys.argv[3])):
    begun = time.perf_counter()
    nets = [MLPClassifier((8,), activation="tanh", solver=sys.argv[2], max_iter=1000, early_stopping=False,
                          random_state=seed).fit(x, y) for seed in range(11)]
    times.append(time.perf_counter() - begun)
    right = np.mean([net.score(x, y) for net in nets])
print(sorted(times)[len(times) // 2] * 1e3, right)
)";

void print_peer(const std::filesystem::path& folder, const std::string& solver) {
  const std::string out = (folder / "out.txt").string();
  int status = 77;
  for (const char* python : {"python3", "/usr/bin/python3"}) {  // the second has Debian's packages wherever the first comes from
    const std::string call = std::string(python) + " " + (folder / "peer.py").string() + " " + (folder / "rows.csv").string() + " " +
                             solver + " " + std::to_string(kRounds) + " >" + out;
    status = WEXITSTATUS(std::system(call.c_str()));
    if (status == 0) break;
  }
  double milliseconds = 0.0;
  double right = 0.0;
  if (status == 0 && std::ifstream(out) >> milliseconds >> right) {
    std::printf("| scikit-learn MLPClassifier, %s | %.1f | %.3f |\n", solver.c_str(), milliseconds, right);
  } else {
    std::printf("\nscikit-learn (%s) is left out: python3-sklearn is not here or failed\n", solver.c_str());
  }
}

double accuracy(const std::vector<TrainedNetwork>& networks, const Batch& batch) {
  double right = 0.0;
  for (const TrainedNetwork& one : networks) {
    for (std::size_t row = 0; row < batch.size(); ++row) {
      const auto outputs = one.network.outputs(batch.row(row));
      right +=
          static_cast<std::size_t>(std::max_element(outputs.begin(), outputs.end()) - outputs.begin()) == batch.classes[row] ? 1.0 : 0.0;
    }
  }
  return right / static_cast<double>(networks.size() * batch.size());
}

void write_rows(const std::filesystem::path& file, const Batch& batch) {
  std::ofstream rows(file);
  for (std::size_t row = 0; row < batch.size(); ++row) {
    for (const double value : batch.row(row)) rows << value << ',';
    rows << batch.classes[row] << '\n';
  }
}

}  // namespace

int main() {
  const Batch batch = reaches();
  const dts::core::SystemClock clock;
  std::array<double, kRounds> milliseconds{};
  double right = 0.0;
  for (double& round : milliseconds) {
    const auto begun_ns = clock.now_ns();
    const auto networks = train_networks(batch, {}, 1, kNetworks, 0.0);
    round = static_cast<double>(clock.now_ns() - begun_ns) * 1e-6;
    if (!networks) return EXIT_FAILURE;
    right = accuracy(*networks, batch);
  }
  std::nth_element(milliseconds.begin(), milliseconds.begin() + kRounds / 2, milliseconds.end());
  std::printf("| 11 networks 5-8-3, 135 reaches | ms, median | right, own rows |\n|---|--:|--:|\n");
  std::printf("| dtslab, scaled conjugate gradient | %.1f | %.3f |\n", milliseconds[kRounds / 2], right);
  const auto folder = std::filesystem::temp_directory_path() / ("training_bench_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  write_rows(folder / "rows.csv", batch);
  std::ofstream(folder / "peer.py") << kPeer;
  std::fflush(stdout);
  for (const char* solver : {"lbfgs", "adam"}) print_peer(folder, solver);
  std::filesystem::remove_all(folder);
  return EXIT_SUCCESS;
}
