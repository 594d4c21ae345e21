// SPDX-License-Identifier: Apache-2.0
#include "lib/medium/formulas.h"

#include <fmt/format.h>

#include <utility>

#include "lib/medium/cauchy.h"
#include "lib/medium/cornu.h"
#include "lib/medium/exotic.h"
#include "lib/medium/gases.h"
#include "lib/medium/herzberger.h"
#include "lib/medium/navarro.h"
#include "lib/medium/polynomial.h"
#include "lib/medium/refractiveindex_info.h"
#include "lib/medium/retro.h"
#include "lib/medium/sellmeier.h"
#include "lib/medium/sellmeier_2.h"

namespace sagitta::medium {
namespace {

constexpr Formula all_formulas[] = {
    sellmeier, sellmeier_2, polynomial, refractiveindex_info, cauchy, gases, herzberger, retro, exotic, cornu, navarro,
};

class FormulaDispersion : public Dispersion {
 public:
  FormulaDispersion(const Formula& formula, std::vector<double> coefficients)
      : formula_(formula), coefficients_(std::move(coefficients)) {}

  double index(double wavelength_um) const override {
    return formula_.index(coefficients_, wavelength_um);
  }
  std::string kind() const override { return title_of(formula_); }

 private:
  Formula formula_;
  std::vector<double> coefficients_;
};

}  // namespace

std::span<const Formula> formulas() { return all_formulas; }

const Formula* find_formula(int number) {
  for (const Formula& formula : all_formulas) {
    if (formula.number == number && number > 0) return &formula;
  }
  return nullptr;
}

const Formula* find_formula(std::string_view number_or_name) {
  for (const Formula& formula : all_formulas) {
    if (number_or_name == (formula.number > 0 ? fmt::format("{}", formula.number) : std::string(formula.name))) return &formula;
  }
  return nullptr;
}

std::string title_of(const Formula& formula) {
  return formula.number > 0 ? fmt::format("formula {} ({})", formula.number, formula.name) : fmt::format("formula {}", formula.name);
}

Medium from_formula(std::string name, const Formula& formula, std::vector<double> coefficients, double shortest_um,
                    double longest_um) {
  return {std::move(name), std::make_shared<FormulaDispersion>(formula, std::move(coefficients)), shortest_um,
          longest_um};
}

}  // namespace sagitta::medium
