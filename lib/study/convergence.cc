// SPDX-License-Identifier: Apache-2.0
#include "lib/study/convergence.h"

#include <algorithm>
#include <cmath>

namespace sagitta::study {

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

Truth truth_of(std::span<const double> counts, std::span<const Answer> answers) {
  Truth truth{answers.back()};
  if (answers.size() < 2 || truth.value.empty()) return truth;
  std::vector<double> errors;
  for (const Answer& answer : answers) errors.push_back(error_of(answer, truth.value));
  const double last = errors[errors.size() - 2];
  truth.clear_of = 2 * last;
  truth.uncertainty = last;
  const Order law = law_of(counts, errors, truth.clear_of);
  const double at_finest = law.factor * std::pow(counts.back(), law.slope);
  if (law.slope < 0 && at_finest > last) truth.uncertainty = at_finest;
  return truth;
}

Settling settling(std::span<const Answer> answers, const Truth& truth) {
  Settling result;
  for (const Answer& answer : answers) result.error.push_back(error_of(answer, truth.value));
  result.bound = result.error;
  for (std::size_t i = result.bound.size(); i-- > 0;) {
    const double finer = i + 1 < result.bound.size() ? result.bound[i + 1] : 0;
    result.bound[i] = std::max(result.error[i], finer);
  }
  for (double& bound : result.bound) bound += truth.uncertainty;
  return result;
}

}  // namespace sagitta::study
