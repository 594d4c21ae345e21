// SPDX-License-Identifier: Apache-2.0
#include "lib/study/advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>

#include "lib/analysis/job.h"

namespace sagitta::study {
namespace {

// Of µm or waves: beside percents, what is less is not worth saying.
constexpr double next_to_nothing = 1e-3;

// Two digits, decimal from 0.0001 to 999999.
std::string two_digits(double value) {
  if (!std::isfinite(value)) return "an unknown amount";
  if (value == 0) return "0";
  const std::string scientific = fmt::format("{:.1e}", value);
  const int exponent = std::stoi(scientific.substr(scientific.find('e') + 1));
  if (exponent < -4 || exponent > 5) return fmt::format("{:.2g}e{}", std::stod(scientific.substr(0, scientific.find('e'))), exponent);
  return fmt::format("{}", std::stod(scientific));
}

// A claim holds for what it is rounded to. A part in 1e9 is rounding, not a digit.
std::string up(double value) {
  if (!(value > 0) || !std::isfinite(value)) return two_digits(value);
  const double step = std::pow(10, std::floor(std::log10(value)) - 1);
  return two_digits(std::ceil(value / step * (1 - 1e-9)) * step);
}

std::string text_of_count(std::int64_t count) {
  int exponent = 0;
  std::int64_t digits = count;
  for (; digits % 10 == 0 && digits > 0; digits /= 10) ++exponent;
  return exponent < 3 || digits > 9 ? fmt::format("{}", count) : fmt::format("{}e{}", digits, exponent);
}

bool meets(const Worst& bound, double target, bool is_percent) { return (is_percent ? bound.percent : bound.absolute) <= target; }

// The fewest rays for a target; null where all are too few.
const Step* fewest(const Curve& curve, double target, bool is_percent) {
  const auto found = std::find_if(curve.steps.begin(), curve.steps.end(), [&](const Step& step) { return meets(step.bound, target, is_percent); });
  return found == curve.steps.end() ? nullptr : &*found;
}

bool is_in_percent(const Curve& curve) { return !std::isnan(curve.steps.back().bound.percent); }

// Twice: what is generous, and what is tight.
std::array<double, 2> targets_of(const Curve& curve) {
  if (is_in_percent(curve)) return {1, .1};
  return curve.quantity == Quantity::wavefront_rms ? std::array{.01, .001} : std::array{.1, .01};
}

std::string target_text(const Curve& curve, double target) { return fmt::format("{} {}", target, is_in_percent(curve) ? "%" : unit_of(curve.quantity)); }

bool is_default(const Run& run) {
  const analysis::JobRequest usual;
  return run.grid > 0 ? run.grid == usual.wavefront.size : run.rays == usual.ray_count;
}

std::string line_of(const Curve& curve) {
  const bool is_percent = is_in_percent(curve);
  std::vector<const Step*> chosen;
  const auto choose = [&](const Step& step) {
    if (std::find(chosen.begin(), chosen.end(), &step) == chosen.end()) chosen.push_back(&step);
  };
  for (const Step& step : curve.steps)
    if (is_default(*step.run)) choose(step);
  std::string too_few;
  for (const double target : targets_of(curve))
    if (const Step* step = fewest(curve, target, is_percent)) choose(*step);
    else if (too_few.empty()) too_few = fmt::format("; {} are too few for {}", text_of(*curve.steps.back().run), target_text(curve, target));
  if (chosen.empty()) choose(curve.steps.back());
  std::string line;
  for (const Step* step : chosen) {
    const Run& run = *step->run;
    if (line.empty())
      line = fmt::format("{} {} give {}{} to", text_of(run), run.grid > 0 ? "samples" : "rays", curve.quantity == Quantity::zernike ? "every " : "the ",
                         curve.quantity == Quantity::zernike ? "Zernike coefficient" : name_of(curve.quantity));
    else
      line += fmt::format("; {} to", text_of(run));
    line += fmt::format(" {} in {}", text_of(step->bound, curve.quantity), text_of_seconds(run.processor_s.median));
  }
  return line + too_few;
}

// The patterns of one quantity side by side; empty where there is one.
std::string line_of_patterns(std::span<const Curve> curves) {
  const Curve& first = curves.front();
  if (curves.size() < 2) return {};
  const bool is_percent = is_in_percent(first);
  double target = targets_of(first)[1];
  if (!fewest(first, target, is_percent)) target = targets_of(first)[0];
  std::vector<std::string> words;
  for (const Curve& curve : curves) {
    const Step* step = fewest(curve, target, is_percent);
    words.push_back(fmt::format("{}{} rays of {}", step ? "" : "more than ", text_of(step ? *step->run : *curve.steps.back().run), curve.pattern));
  }
  return fmt::format("the {} to {} takes {}", name_of(first.quantity), target_text(first, target), fmt::join(words, ", "));
}

// "the spot RMS by 0.3 %, a Zernike coefficient by 2e-3 um"; empty where there is no answer.
std::string text_of(const std::array<Worst, quantities.size()>& change) {
  std::vector<std::string> words;
  for (const Quantity quantity : quantities) {
    const Worst& worst = change[static_cast<std::size_t>(quantity)];
    if (std::isnan(worst.main())) continue;
    words.push_back(fmt::format("{} by {}", quantity == Quantity::zernike ? "a Zernike coefficient" : fmt::format("the {}", name_of(quantity)), text_of(worst, quantity)));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

std::string line_of(const CloudChange& change) {
  const CloudRun &run = *change.run, &finest = *change.finest;
  const std::string where = run.surface.empty() ? fmt::format("surface {}", run.surface_number) : fmt::format("'{}'", run.surface);
  if (!run.reason.empty()) return fmt::format("{} at {}: {}", run.interpolation, where, run.reason);
  const std::string words = text_of(change.change);
  if (words.empty()) return fmt::format("{} at {}: there is no answer of {} to compare with", run.interpolation, where, finest.interpolation);
  return fmt::format("{}{} in place of {} at {} changes {}; a ray takes {} times as long", run.interpolation, run.is_given ? ", as given," : "", finest.interpolation, where,
                     words, two_digits(change.time_ratio));
}

constexpr double next_to_no_percent = 0.01;

// The system's own tolerance and the loosest that changes next to nothing; the truth is the first.
std::vector<std::string> lines_of(const std::vector<ToleranceChange>& changes) {
  std::vector<const ToleranceChange*> told;
  for (const ToleranceChange& change : changes)
    if (change.run->is_given) told.push_back(&change);
  const auto loosest = std::find_if(changes.rbegin(), changes.rend(), [](const ToleranceChange& change) {
    return std::all_of(change.change.begin(), change.change.end(), [](const Worst& worst) { return !(worst.percent > next_to_no_percent); });
  });
  if (loosest != changes.rend() && !loosest->run->is_given) told.push_back(&*loosest);
  std::vector<std::string> lines;
  for (const ToleranceChange* change : told) {
    const std::string words = text_of(change->change), steps = fmt::format("{:.3g} steps of a ray in gradients", change->run->steps);
    lines.push_back(fmt::format("tolerance_mm {:g}{}: {}{}", change->run->tolerance_mm, change->run->is_given ? ", as given" : "", steps,
                                words.empty() ? "" : fmt::format("; against {:g} it changes {}", changes.front().run->tolerance_mm, words)));
    if (!change->run->is_given) lines.back() += fmt::format("; a ray takes {} times as long", two_digits(change->time_ratio));
  }
  return lines;
}

}  // namespace

std::string text_of(const Run& run) { return run.grid > 0 ? fmt::format("{} x {}", run.grid, run.grid) : text_of_count(run.rays); }

std::string text_of(const Worst& worst, Quantity quantity) {
  if (!std::isfinite(worst.main())) return "an unknown amount";
  const std::string absolute = fmt::format("{} {}", up(worst.absolute), unit_of(quantity));
  if (std::isnan(worst.percent)) return absolute;
  const std::string percent = up(worst.percent) + " %";
  return worst.absolute >= next_to_nothing ? fmt::format("{} ({} where it is next to nothing)", percent, absolute) : percent;
}

std::string text_of_seconds(double seconds) {
  if (seconds < .995e-3) return two_digits(seconds * 1e6) + " µs";
  if (seconds < .995) return two_digits(seconds * 1e3) + " ms";
  return two_digits(seconds) + " s";
}

std::vector<std::string> advice(const std::vector<Curve>& curves, const std::vector<CloudChange>& changes, const std::vector<ToleranceChange>& tolerances) {
  std::vector<std::string> lines;
  for (auto first = curves.begin(); first != curves.end();) {
    const auto end = std::find_if(first, curves.end(), [&](const Curve& curve) { return curve.quantity != first->quantity; });
    lines.push_back(line_of(*first));
    if (const std::string patterns = line_of_patterns({first, end}); !patterns.empty()) lines.push_back(patterns);
    first = end;
  }
  for (const CloudChange& change : changes)
    if (change.run != change.finest || !change.run->reason.empty()) lines.push_back(line_of(change));
  for (std::string& line : lines_of(tolerances)) lines.push_back(std::move(line));
  return lines;
}

std::string truth_note(const std::vector<Curve>& curves, const std::vector<CloudChange>& changes) {
  std::vector<std::string> finest, off;
  for (const Curve& curve : curves) {
    const Run& run = *curve.steps.back().run;
    if (curve.pattern != curves.front().pattern && !curve.pattern.empty()) continue;  // the truth is of the first pattern
    const std::string text = run.grid > 0 ? fmt::format("{} samples", text_of(run)) : fmt::format("{} {} rays", text_of(run), curve.pattern);
    if (finest.empty() || finest.back() != text) finest.push_back(text);
    off.push_back(fmt::format("{} ({})", text_of(curve.uncertainty, curve.quantity), curve.quantity == Quantity::zernike ? "a Zernike coefficient" : name_of(curve.quantity)));
  }
  if (finest.empty()) return {};
  std::string note = fmt::format("The truth here is the finest itself, {}, by the same double-precision code: it is not independent. By its own convergence it may be off by {}, which every figure includes. A figure is the worst of "
                                 "the counts measured from there on, those between included, and the largest rise of the error from one of them to the next: what was measured, no bound.",
                                 fmt::join(finest, " and "), fmt::join(off, ", "));
  if (!changes.empty()) note += fmt::format(" Of points it is {}, which does not know what lies between them.", changes.front().run->interpolation);
  return note;
}

std::vector<std::string> missing_answers(const Sampling& sampling) {
  std::vector<std::string> lines;
  for (const Quantity quantity : quantities) {
    const std::vector<Answers>& answers = quantity == Quantity::spot_rms ? sampling.spots.front().back().answers : sampling.wavefronts.back().answers;
    std::map<std::string, int> reasons;
    for (const Answers& one : answers)
      if (const std::string& reason = reason_of(one, quantity); !reason.empty() && (quantity != Quantity::zernike || reason != one.no_wavefront)) ++reasons[reason];
    for (const auto& [reason, count] : reasons) lines.push_back(fmt::format("no {} for {} of {} fields and wavelengths: {}", name_of(quantity), count, answers.size(), reason));
  }
  return lines;
}

}  // namespace sagitta::study
