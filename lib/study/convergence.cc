// SPDX-License-Identifier: Apache-2.0
#include "lib/study/convergence.h"

#include <algorithm>
#include <cmath>

namespace sagitta::study {
namespace {

constexpr double least_order = 0.5;       // that (2) covers
constexpr std::size_t enough_counts = 4;  // between a rung and the next, for its m

// w
double worst_of(const Rung& rung, const Answer& truth) {
  double worst = 0;
  for (const Answer& answer : rung.answers) worst = std::max(worst, error_of(answer, truth));
  return worst;
}

// m, of what is measured.
std::vector<double> worst_from_there_on(std::span<const Rung> rungs, const Answer& truth) {
  std::vector<double> result(rungs.size());
  double worst = 0, rise = 0, next = 0;
  for (std::size_t i = rungs.size(); i-- > 0;) {
    for (std::size_t j = rungs[i].answers.size(); j-- > 0;) {
      const double error = error_of(rungs[i].answers[j], truth);
      worst = std::max(worst, error);
      rise = std::fmax(rise, next - error);
      next = error;
    }
    result[i] = worst + rise;
  }
  return result;
}

// Over the last rungs, of too few counts.
void carry_on(std::span<const Rung> rungs, std::vector<double>& m, double clear_of) {
  std::size_t end = rungs.size();
  while (end > 0 && rungs[end - 1].answers.size() <= enough_counts) --end;
  std::vector<double> counts;
  for (const Rung& rung : rungs.first(end)) counts.push_back(rung.count);
  const Order law = law_of(counts, std::span(m).first(end), clear_of);
  if (!(law.slope < 0)) return;
  for (std::size_t i = end; i < m.size(); ++i) m[i] = std::max(m[i], m[end - 1] * std::pow(rungs[i].count / counts.back(), law.slope));
}

}  // namespace

double error_of(const Answer& answer, const Answer& truth) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (answer.empty() || answer.size() != truth.size()) return infinity;
  double worst = 0;
  for (std::size_t k = 0; k < answer.size(); ++k) {
    const double off = std::abs(answer[k] - truth[k]);
    if (!(off <= worst)) worst = std::isnan(off) ? infinity : off;
  }
  return worst;
}

Order law_of(std::span<const double> counts, std::span<const double> errors, double clear_of) {
  std::vector<double> x, y;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (!(errors[i] > clear_of)) continue;
    x.push_back(counts[i]);
    y.push_back(errors[i]);
  }
  return order_of(x, y);
}

Truth truth_of(std::span<const Rung> rungs) {
  Truth truth{rungs.back().answers.front()};
  if (rungs.size() < 2 || truth.value.empty()) return truth;
  std::vector<double> counts, errors;
  for (const Rung& rung : rungs) {
    counts.push_back(rung.count);
    errors.push_back(worst_of(rung, truth.value));
  }
  const double last = errors[errors.size() - 2];
  truth.clear_of = 2 * last;
  const Order law = law_of(counts, errors, truth.clear_of);
  const double at_finest = law.slope < 0 ? law.factor * std::pow(counts.back(), law.slope) : 0;
  truth.uncertainty = std::max(last, at_finest) / std::min(1.0, std::pow(counts.back() / counts[counts.size() - 2], least_order) - 1);
  return truth;
}

Settling settling(std::span<const Rung> rungs, const Truth& truth) {
  Settling result;
  for (const Rung& rung : rungs) {
    result.error.push_back(error_of(rung.answers.front(), truth.value));
    result.worst.push_back(worst_of(rung, truth.value));
  }
  result.bound = worst_from_there_on(rungs, truth.value);
  carry_on(rungs, result.bound, truth.clear_of);
  for (double& bound : result.bound) bound += truth.uncertainty;
  return result;
}

}  // namespace sagitta::study
