// SPDX-License-Identifier: Apache-2.0
// How an answer settles with more and more rays, where nothing but more rays is there to compare it with.
//
// Answers are measured at rungs of N_i rays, N rising, i = 1 ... f, and at counts between a rung and the next. An answer of several numbers
// (Zernike coefficients) is judged by the worst of them, k. The finest rung of a trusted sequence is taken for the truth, T; of an answer A
//   e = max_k |A_k - T_k|                                                                                           (1)
// and w_i is the largest e of rung i and of those between it and the next. The law w = a N^p is fitted (order.h) to the w_i that stand clear
// of the truth, w_i > 2 w_(f-1), i < f - 1. How far T may itself be off:
//   u = max(w_(f-1), a N_f^p) / min(1, (N_f/N_(f-1))^(1/2) - 1)                                                      (2)
// For A = A_inf + c N^-q the truth is off by e_(f-1) / ((N_f/N_(f-1))^q - 1), so (2) bounds it where the order q is at least 1/2: that of a rim whose
// samples count whole, a strip as wide as their pitch. The law guards against answers that agree by chance. Neither is a proof.
//
// What may be claimed of N_i rays, in this sequence or one of another pattern: errors pass through 0 and, behind clipped rims, jump from one count to
// the next, so it is the worst of the counts measured from there on, with the largest rise of the error from one of them to the next, r_i,
// for what lies between them, and what the truth may be off by:
//   b_i = m_i + u,   m_i = max_(j >= i) w_j + r_i                                                                   (3)
// Behind the last rung with 4 counts between it and the next, l, too few are measured: there m_i is at least m_l (N_i/N_l)^s, s < 0 the order of the law
// fitted to the m of the rungs up to l that stand clear of the truth.
// That is an extrapolation of what was measured, no bound: an error that rises further between two counts than any did is above it.
//
// An answer that is not there is infinitely wrong. Units are those of the answer.
//
// Source: Roache, Verification and Validation in Computational Science and Engineering (1998), chapter 5: differences of
// successive grids as estimates of their errors.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "lib/study/order.h"

namespace sagitta::study {

using Answer = std::vector<double>;  // empty: there is none

// (1), from the answer to the truth; infinite where there is no answer, or it has another number of numbers.
double error_of(const Answer& answer, const Answer& truth);

struct Rung {
  double count = 0;             // N_i
  std::vector<Answer> answers;  // its own, then those of counts between it and the next, rising
};

struct Truth {
  Answer value;  // empty where the finest has none
  double uncertainty = std::numeric_limits<double>::infinity();  // u of (2)
  double clear_of = std::numeric_limits<double>::infinity();     // 2 w_(f-1): errors above it tell of their own sampling
};
// Of at least one rung; the uncertainty of a single one is infinite.
Truth truth_of(std::span<const Rung> rungs);

// e of the rungs themselves, w, and b of (3).
struct Settling {
  std::vector<double> error, worst, bound;
};
Settling settling(std::span<const Rung> rungs, const Truth& truth);

// The law of the errors above `clear_of`.
Order law_of(std::span<const double> counts, std::span<const double> errors, double clear_of);

}  // namespace sagitta::study
