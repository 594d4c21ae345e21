// SPDX-License-Identifier: Apache-2.0
// What a sampling (sampling.h) says to somebody who has to choose: lines of text. Errors are what may be claimed (convergence.h), rounded up:
// of the counts that were measured from there on, and no more.
#pragma once

#include <string>
#include <vector>

#include "lib/study/settled.h"

namespace sagitta::study {

// "1e4 rays give the spot RMS to 0.3 % in 2 ms; 1e3 to 3 % in 0.3 ms": those that `trace` takes unless asked, then the fewest for 1 % and
// 0.1 %, in the first of its patterns, and what that takes in the others; likewise the samples of wavefronts; then what each
// interpolation changes; of gradients the steps of a ray and what they leave, at the system's own tolerance and at the loosest that changes no RMS by more than 0.01 %.
std::vector<std::string> advice(const std::vector<Curve>& curves, const std::vector<CloudChange>& changes, const std::vector<ToleranceChange>& tolerances = {});

// What the truth is, how far it may be off, and that it is not independent.
std::string truth_note(const std::vector<Curve>& curves, const std::vector<CloudChange>& changes);

// "no wavefront RMS for 2 of 9 fields and wavelengths: the chief ray is lost ..."; none where every answer is there.
std::vector<std::string> missing_answers(const Sampling& sampling);

// The texts of their parts: 300, 1e4 or 64 x 64; 0.28 % rounded up, with what is said where there are no percents; 2.1 ms.
std::string text_of(const Run& run);
std::string text_of(const Worst& worst, Quantity quantity);
std::string text_of_seconds(double seconds);

}  // namespace sagitta::study
