// SPDX-License-Identifier: Apache-2.0
// What the runs of a sampling (sampling.h) come to: for each answer, how far it is off by each number of rays, at the worst of the fields and
// wavelengths, and what may be claimed of it (convergence.h).
//
// Errors are in percent of the answer of the same field and wavelength, or, where this one is so small that nobody wants it in percent
// (a spot below a hundredth of the wavelength, a wavefront below a thousandth of a wave), in its own unit. Zernike coefficients are in
// their own unit always: many are zero by symmetry.
#pragma once

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "lib/study/sampling.h"

namespace sagitta::study {

enum class Quantity { spot_rms, wavefront_rms, zernike };
inline constexpr std::array quantities{Quantity::spot_rms, Quantity::wavefront_rms, Quantity::zernike};

const char* name_of(Quantity quantity);  // "spot RMS"
const char* unit_of(Quantity quantity);  // "µm", "waves", "µm"
const Answer& answer_of(const Answers& answers, Quantity quantity);
const std::string& reason_of(const Answers& answers, Quantity quantity);  // why there is none
// Below it an answer is not judged in percent; infinite for Zernike coefficients.
double negligible(Quantity quantity, double wavelength_um);

// The worst of the fields and wavelengths; NaN where none is judged that way.
struct Worst {
  double percent = std::numeric_limits<double>::quiet_NaN();
  double absolute = std::numeric_limits<double>::quiet_NaN();  // in the quantity's unit

  // What a plot or a target is of.
  double main() const { return percent == percent ? percent : absolute; }
};

struct Step {
  const Run* run = nullptr;
  double count = 0;               // rays that were launched, of the first field and wavelength
  std::vector<double> errors, worst, bounds;  // e, w and b; by field, then wavelength, in the quantity's unit; NaN where the truth has no answer
  Worst error, bound;
};

// One answer by one pattern.
struct Curve {
  Quantity quantity = Quantity::spot_rms;
  std::string pattern;
  std::vector<Truth> truths;  // by field, then wavelength
  std::vector<Step> steps;
  Worst uncertainty;          // of the truths
  Order order;                // of the errors' main(), in the number of rays
};

// Spots by pattern, all against the finest of the first; then wavefronts and coefficients. Curves point into the sampling. An answer
// that no field and wavelength has is left out.
std::vector<Curve> curves_of(const Sampling& sampling);

// The run that gives an answer, of one interpolation or tolerance.
template <class AnyRun>
const Run& run_of(const AnyRun& run, Quantity quantity) { return quantity == Quantity::spot_rms ? run.spots : run.wavefronts; }

// What another interpolation changes, from the first of its surface, c1, which is the finest; NaN where there is none to compare.
struct CloudChange {
  const CloudRun *run = nullptr, *finest = nullptr;
  double time_ratio = std::numeric_limits<double>::quiet_NaN();  // of a ray through the whole system
  std::array<Worst, quantities.size()> change;
};
std::vector<CloudChange> changes_of(const Sampling& sampling);

// What another tolerance in gradients changes, from the first, which is the tightest.
struct ToleranceChange {
  const ToleranceRun* run = nullptr;
  double time_ratio = std::numeric_limits<double>::quiet_NaN();  // to the system's own, of a ray through the whole system
  std::array<Worst, quantities.size()> change;
};
std::vector<ToleranceChange> tolerance_changes_of(const Sampling& sampling);

}  // namespace sagitta::study
