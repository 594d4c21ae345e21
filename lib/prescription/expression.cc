// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/expression.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "lib/prescription/diagnostics.h"
#include "lib/prescription/utf8.h"

namespace sagitta::prescription {
namespace {

constexpr std::size_t most_bytes = 1000, longest_name = 64;
constexpr int most_depth = 50;

double radians(double degrees) { return degrees * (std::numbers::pi / 180); }

using Arguments = std::vector<double>;

// By whole quarters of a turn and a rest of 45 degrees at most, so that sin 180 is 0, cos 60 is 1/2 to rounding and tan 90 is no number.
double sine_of_quarters(double degrees, int more_quarters) {
  if (!std::isfinite(degrees)) return std::numeric_limits<double>::quiet_NaN();
  int quarters = 0;
  const double rest = radians(std::remquo(degrees, 90.0, &quarters));
  switch (static_cast<unsigned>(quarters + more_quarters) % 4) {  // remquo tells three bits of the quotient, and its sign
    case 0: return std::sin(rest) + 0.0;
    case 1: return std::cos(rest);
    case 2: return 0.0 - std::sin(rest);
    default: return -std::cos(rest);
  }
}
double sin_deg(const Arguments& x) { return sine_of_quarters(x[0], 0); }
double cos_deg(const Arguments& x) { return sine_of_quarters(x[0], 1); }
double tan_deg(const Arguments& x) { return sin_deg(x) / cos_deg(x); }

struct Function {
  std::string_view name;
  bool takes_several;
  double (*of)(const Arguments&);
};
constexpr std::array functions{
    Function{"abs", false, [](const Arguments& x) { return std::abs(x[0]); }},
    Function{"exp", false, [](const Arguments& x) { return std::exp(x[0]); }},
    Function{"ln", false, [](const Arguments& x) { return std::log(x[0]); }},
    Function{"sqrt", false, [](const Arguments& x) { return std::sqrt(x[0]); }},
    Function{"sin_deg", false, sin_deg},
    Function{"cos_deg", false, cos_deg},
    Function{"tan_deg", false, tan_deg},
    Function{"min", true, [](const Arguments& x) { return *std::min_element(x.begin(), x.end()); }},
    Function{"max", true, [](const Arguments& x) { return *std::max_element(x.begin(), x.end()); }}};

const Function* function_named(std::string_view name) {
  const auto* found = std::find_if(functions.begin(), functions.end(), [&](const Function& one) { return one.name == name; });
  return found == functions.end() ? nullptr : found;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool goes_on(char c) { return is_letter(c) || is_digit(c) || c == '_'; }

std::string function_hint(const std::string& name) {
  if (name == "log") return "the natural logarithm is ln";
  if (name == "sin" || name == "cos" || name == "tan") return fmt::format("write {}_deg: angles are in degrees", name);
  const std::vector<std::string> names = function_names();
  const std::string meant = nearest_name(name, names);
  return meant.empty() ? "the functions are: " + listed(names) : fmt::format("did you mean '{}'?", meant);
}

// Reads and computes in one pass; after the first fault nothing is read any more.
class Reader {
 public:
  Reader(std::string_view text, const std::vector<ParameterValue>& parameters, bool look_for_hints)
      : text_(text), parameters_(parameters), look_for_hints_(look_for_hints) {}

  Evaluation whole() {
    if (text_.size() > most_bytes) {
      refuse(0, fmt::format("an expression of {} bytes is longer than {}", text_.size(), most_bytes));
      return std::move(result_);
    }
    result_.value = sum();
    if (!result_.fault && next() != '\0') refuse_next();
    return std::move(result_);
  }

 private:
  double refuse(std::size_t at, std::string what, std::string hint = {}) {
    if (!result_.fault) result_.fault = ExpressionFault{at, std::move(what), std::move(hint)};
    return std::numeric_limits<double>::quiet_NaN();
  }

  // The byte that comes next behind blanks; 0 at the end and after a fault.
  char next() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n')) ++at_;
    return at_ < text_.size() && !result_.fault ? text_[at_] : '\0';
  }
  bool take(char c) {
    const bool is_next = next() == c;
    at_ += is_next;
    return is_next;
  }

  double refuse_next() {
    const char c = next();
    if (c == '\0') return refuse(at_, "the expression ends where a value should stand");
    const std::size_t length = std::max<std::size_t>(utf8_length(text_.substr(at_)), 1);
    const bool is_behind_digit = at_ > 0 && is_digit(text_[at_ - 1]);
    return refuse(at_, fmt::format("'{}' cannot stand here", excerpt(std::string(text_.substr(at_, length)))),
                  c == '*'                                         ? "a power is written ^"
                  : c == ',' && is_behind_digit                    ? "decimals are written with a point"
                  : is_letter(c) || is_digit(c) || c == '(' || c == '.' ? "a product is written with *"
                                                                   : "");
  }

  double finite(double value, std::size_t at, const std::string& what) {
    return result_.fault || std::isfinite(value) ? value : refuse(at, what + " is no finite number");
  }

  double sum() {
    double value = product();
    while (next() == '+' || next() == '-') {
      const std::size_t at = at_;
      const double sign = text_[at_++] == '-' ? -1 : 1, right = product();
      value = finite(value + sign * right, at, fmt::format("{} {} {}", value, sign < 0 ? '-' : '+', right));
    }
    return value;
  }

  double product() {
    double value = with_sign();
    while (next() == '*' || next() == '/') {
      const std::size_t at = at_;
      const bool divides = text_[at_++] == '/';
      const double right = with_sign();
      if (divides && right == 0) return refuse(at, "a division by 0");
      value = finite(divides ? value / right : value * right, at, fmt::format("{} {} {}", value, divides ? '/' : '*', right));
    }
    return value;
  }

  double with_sign() {
    if (++depth_ > most_depth) return refuse(at_, fmt::format("nested more than {} deep", most_depth));
    const double value = take('-') ? -with_sign() : take('+') ? with_sign() : power();
    --depth_;
    return value;
  }

  double power() {
    const double base = operand();
    if (next() != '^') return base;
    const std::size_t at = at_++;
    const double exponent = with_sign();
    return finite(std::pow(base, exponent), at, fmt::format("({})^({})", base, exponent));
  }

  double operand() {
    const char c = next();
    if (is_letter(c)) return named();
    if (is_digit(c) || (c == '.' && at_ + 1 < text_.size() && is_digit(text_[at_ + 1]))) return number();
    if (c != '(') return refuse_next();
    const std::size_t at = at_++;
    const double value = sum();
    if (!take(')')) return refuse_open(at);
    return value;
  }

  double refuse_open(std::size_t at) {
    if (next() != '\0') return refuse_next();
    return refuse(at, "this '(' has no ')'", hint_of_open_parenthesis);
  }

  double number() {
    double value = 0;
    const auto [end, status] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (status != std::errc{}) return refuse(at_, "a number beyond the range of numbers");
    at_ = static_cast<std::size_t>(end - text_.data());
    return value;
  }

  double named() {
    const std::size_t at = at_;
    while (at_ < text_.size() && goes_on(text_[at_])) ++at_;
    const std::string name(text_.substr(at, at_ - at));
    if (next() == '(') return call(name, at);
    const auto found = std::find_if(parameters_.begin(), parameters_.end(), [&](const ParameterValue& one) { return one.name == name; });
    if (found == parameters_.end()) return refuse(at, unknown(name), parameter_hint(name));
    result_.used.insert(name);
    return found->value;
  }

  static std::string unknown(const std::string& name) {
    return function_named(name) ? fmt::format("{} needs its argument in ( )", name) : fmt::format("there is no parameter '{}'", excerpt(name));
  }

  std::string parameter_hint(const std::string& name) const {
    if (!look_for_hints_ || function_named(name)) return {};
    std::vector<std::string> names;
    for (const ParameterValue& one : parameters_) names.push_back(one.name);
    const std::string meant = nearest_name(name, names);
    if (!meant.empty()) return fmt::format("did you mean '{}'?", meant);
    return names.empty() ? "the system declares none; parameters: {NAME: VALUE} does" : "the parameters are: " + listed(names);
  }

  double call(const std::string& name, std::size_t at) {
    const Function* function = function_named(name);
    if (!function) return refuse(at, fmt::format("there is no function '{}'", excerpt(name)), look_for_hints_ ? function_hint(name) : "");
    const std::size_t open = at_++;
    Arguments arguments;
    do arguments.push_back(sum());
    while (take(','));
    if (!take(')')) return refuse_open(open);
    if (arguments.size() > 1 && !function->takes_several) return refuse(at, fmt::format("{} takes one argument, not {}", name, arguments.size()));
    return finite(function->of(arguments), at, fmt::format("{}({})", name, fmt::join(arguments, ", ")));
  }

  std::string_view text_;
  const std::vector<ParameterValue>& parameters_;
  bool look_for_hints_;
  std::size_t at_ = 1;  // behind the '='
  int depth_ = 0;
  Evaluation result_;
};

}  // namespace

Evaluation evaluate(std::string_view text, const std::vector<ParameterValue>& parameters, bool look_for_hints) {
  return Reader(text, parameters, look_for_hints).whole();
}

std::vector<std::string> function_names() {
  std::vector<std::string> names;
  for (const Function& one : functions) names.emplace_back(one.name);
  return names;
}

bool is_parameter_name(std::string_view name) {
  return !name.empty() && name.size() <= longest_name && is_letter(name.front()) && std::all_of(name.begin(), name.end(), goes_on) && !function_named(name);
}

}  // namespace sagitta::prescription
