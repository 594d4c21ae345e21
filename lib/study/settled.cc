// SPDX-License-Identifier: Apache-2.0
#include "lib/study/settled.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace sagitta::study {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// An error of field and wavelength k among the worst; NaN adds nothing.
void add(Worst& worst, Quantity quantity, double error, const Answer& truth, double wavelength_um) {
  if (std::isnan(error)) return;
  if (truth.size() == 1 && truth.front() >= negligible(quantity, wavelength_um)) worst.percent = std::fmax(worst.percent, 100 * error / truth.front());
  else worst.absolute = std::fmax(worst.absolute, error);
}

double wavelength_of(const Sampling& sampling, const Answers& answers) { return sampling.wavelengths_um[answers.wavelength]; }

// Of the main() errors: those of fields and wavelengths that are judged that way, against twice the worst of the finest but one.
Order order_of_curve(const Curve& curve, double clear_of) {
  std::vector<double> counts, errors;
  for (const Step& step : curve.steps) {
    counts.push_back(step.count);
    errors.push_back(step.error.main());
  }
  return law_of(counts, errors, clear_of);
}

std::vector<Rung> rungs_of(Quantity quantity, std::span<const Run> runs, std::size_t k) {
  std::vector<Rung> rungs;
  for (const Run& run : runs) {
    Rung rung{static_cast<double>(run.answers.front().launched), {answer_of(run.answers[k], quantity)}};
    for (const std::vector<Answers>& answers : run.beyond) rung.answers.push_back(answer_of(answers[k], quantity));
    rungs.push_back(std::move(rung));
  }
  return rungs;
}

Curve curve_of(const Sampling& sampling, Quantity quantity, std::span<const Run> runs, const std::vector<Truth>& truths) {
  Curve curve{quantity, runs.front().pattern, truths, {}, {}, {}};
  for (const Run& run : runs) curve.steps.push_back({&run, static_cast<double>(run.answers.front().launched), {}, {}, {}, {}, {}});
  Worst clear_of;
  for (std::size_t k = 0; k < truths.size(); ++k) {
    const Settling settled = settling(rungs_of(quantity, runs, k), truths[k]);
    const double wavelength = wavelength_of(sampling, runs.front().answers[k]);
    const bool has_truth = !truths[k].value.empty();
    for (std::size_t i = 0; i < curve.steps.size(); ++i) {
      Step& step = curve.steps[i];
      step.errors.push_back(has_truth ? settled.error[i] : nan);
      step.worst.push_back(has_truth ? settled.worst[i] : nan);
      step.bounds.push_back(has_truth ? settled.bound[i] : nan);
      add(step.error, quantity, step.errors.back(), truths[k].value, wavelength);
      add(step.bound, quantity, step.bounds.back(), truths[k].value, wavelength);
    }
    if (!has_truth) continue;
    add(curve.uncertainty, quantity, truths[k].uncertainty, truths[k].value, wavelength);
    add(clear_of, quantity, truths[k].clear_of, truths[k].value, wavelength);
  }
  curve.order = order_of_curve(curve, clear_of.main());
  return curve;
}

std::vector<Truth> truths_of(Quantity quantity, std::span<const Run> runs) {
  std::vector<Truth> truths;
  for (std::size_t k = 0; k < runs.front().answers.size(); ++k) truths.push_back(truth_of(rungs_of(quantity, runs, k)));
  return truths;
}

// Of one interpolation or tolerance, from the finest.
template <class AnyRun>
std::array<Worst, quantities.size()> change_of(const Sampling& sampling, const AnyRun& run, const AnyRun& finest) {
  std::array<Worst, quantities.size()> change;
  for (const Quantity quantity : quantities) {
    const auto &finer = run_of(finest, quantity).answers, &other = run_of(run, quantity).answers;  // none where one has failed
    for (std::size_t k = 0; k < std::min(finer.size(), other.size()); ++k) {
      const Answer& truth = answer_of(finer[k], quantity);
      if (!truth.empty()) add(change[static_cast<std::size_t>(quantity)], quantity, error_of(answer_of(other[k], quantity), truth), truth, wavelength_of(sampling, finer[k]));
    }
  }
  return change;
}

}  // namespace

const char* name_of(Quantity quantity) {
  constexpr std::array names{"spot RMS", "wavefront RMS", "Zernike coefficients"};
  return names[static_cast<std::size_t>(quantity)];
}

const char* unit_of(Quantity quantity) { return quantity == Quantity::wavefront_rms ? "waves" : "µm"; }

const Answer& answer_of(const Answers& answers, Quantity quantity) {
  return quantity == Quantity::spot_rms ? answers.spot_rms_um : quantity == Quantity::wavefront_rms ? answers.wavefront_rms_waves : answers.zernike_um;
}

const std::string& reason_of(const Answers& answers, Quantity quantity) {
  return quantity == Quantity::spot_rms ? answers.no_spot : quantity == Quantity::wavefront_rms ? answers.no_wavefront : answers.no_zernike;
}

double negligible(Quantity quantity, double wavelength_um) {
  return quantity == Quantity::spot_rms ? wavelength_um / 100 : quantity == Quantity::wavefront_rms ? 1e-3 : std::numeric_limits<double>::infinity();
}

std::vector<Curve> curves_of(const Sampling& sampling) {
  std::vector<Curve> curves;
  for (const Quantity quantity : quantities) {
    const auto by_pattern = quantity == Quantity::spot_rms ? std::span<const std::vector<Run>>(sampling.spots) : std::span<const std::vector<Run>>(&sampling.wavefronts, 1);
    const std::vector<Truth> truths = truths_of(quantity, by_pattern.front());
    if (std::all_of(truths.begin(), truths.end(), [](const Truth& truth) { return truth.value.empty(); })) continue;
    for (const std::vector<Run>& runs : by_pattern) curves.push_back(curve_of(sampling, quantity, runs, truths));
  }
  return curves;
}

std::vector<CloudChange> changes_of(const Sampling& sampling) {
  std::vector<CloudChange> changes;
  const CloudRun* finest = nullptr;
  for (const CloudRun& run : sampling.clouds) {
    if (!finest || finest->surface_number != run.surface_number) finest = &run;
    changes.push_back({&run, finest, run.ns_per_ray() / finest->ns_per_ray(), change_of(sampling, run, *finest)});
  }
  return changes;
}

std::vector<ToleranceChange> tolerance_changes_of(const Sampling& sampling) {
  std::vector<ToleranceChange> changes;
  const auto given = std::find_if(sampling.tolerances.begin(), sampling.tolerances.end(), [](const ToleranceRun& run) { return run.is_given; });
  for (const ToleranceRun& run : sampling.tolerances)
    changes.push_back({&run, ns_per_ray(run.spots) / ns_per_ray(given->spots), change_of(sampling, run, sampling.tolerances.front())});
  return changes;
}

}  // namespace sagitta::study
