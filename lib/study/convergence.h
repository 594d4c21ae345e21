// SPDX-License-Identifier: Apache-2.0
// How an answer settles with more and more rays, where nothing but more rays is there to compare it with.
//
// A_i is the answer of N_i rays, N rising, i = 1 ... f; an answer of several numbers (Zernike coefficients) is judged by the worst
// of them, k. The finest of a trusted sequence is taken for the truth, T = A_f:
//   e_i = max_k |A_ik - T_k|                                                                                        (1)
// The law e = a N^p is fitted (order.h) to the e_i that stand clear of it, e_i > 2 e_(f-1), i < f - 1. How far T may itself be off:
//   u = max(e_(f-1), a N_f^p)                                                                                       (2)
// For A = A_inf + c N^p the truth is off by e_(f-1) / ((N_(f-1)/N_f)^p - 1), so e_(f-1) bounds it where the order -p is at least
// ln 2 / ln (N_f/N_(f-1)); the law guards against a pair of answers that agree by chance, but neither is a proof. What may be
// claimed of N_i rays, in this sequence or one of another pattern, is the worst from there on, as errors of either sign pass
// through 0:
//   b_i = max_(j >= i) e_j + u                                                                                      (3)
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

struct Truth {
  Answer value;  // empty where the finest has none
  double uncertainty = std::numeric_limits<double>::infinity();  // u of (2)
  double clear_of = std::numeric_limits<double>::infinity();     // 2 e_(f-1): errors above it tell of their own sampling
};
// Of at least one answer; the uncertainty of a single one is infinite.
Truth truth_of(std::span<const double> counts, std::span<const Answer> answers);

// e, and b of (3).
struct Settling {
  std::vector<double> error, bound;
};
Settling settling(std::span<const Answer> answers, const Truth& truth);

// The law of the errors above `clear_of`.
Order law_of(std::span<const double> counts, std::span<const double> errors, double clear_of);

}  // namespace sagitta::study
