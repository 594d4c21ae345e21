// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/arithmetic.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <utility>

#include "lib/prescription/value_reader.h"

namespace sagitta::prescription {
namespace {

constexpr const char* parameters_key = "parameters";

std::vector<std::string> names_of(const std::vector<ParameterValue>& parameters) {
  std::vector<std::string> names;
  for (const ParameterValue& one : parameters) names.push_back(one.name);
  return names;
}

std::vector<ParameterValue> read_parameters(const YamlNode& node, Findings& findings) {
  std::vector<ParameterValue> parameters;
  if (node.kind != YamlNode::Kind::mapping || node.entries.size() > std::size_t{most_parameters}) {
    refuse(node, parameters_key, fmt::format("a mapping {{NAME: VALUE, ...}} of at most {}", most_parameters), findings);
    return parameters;
  }
  for (const YamlNode::Entry& entry : node.entries) {
    if (!is_parameter_name(entry.key))
      findings.error(entry.key_place, fmt::format("'{}' cannot be the name of a parameter", excerpt(entry.key)),
                     "a letter, then letters, digits and _; not the name of a function");
    // With a value that is not legal, too, it is declared: what uses it is no error.
    parameters.push_back({entry.key, read_number(*entry.value, fmt::format("the parameter {}", excerpt(entry.key)), numerics::any_number, findings).value_or(1)});
  }
  return parameters;
}

void set(std::vector<ParameterValue>& parameters, const Settings& settings, const std::string& file, Findings& findings) {
  for (const ParameterValue& setting : settings) {
    const auto found = std::find_if(parameters.begin(), parameters.end(), [&](const ParameterValue& one) { return one.name == setting.name; });
    if (!(std::abs(setting.value) <= largest_number)) {
      findings.error(place_of_setting(setting.name), fmt::format("a parameter must be at most {:g} in size, not {}", largest_number, setting.value));
    } else if (found != parameters.end()) {
      found->value = setting.value;
    } else {
      const std::vector<std::string> names = names_of(parameters);
      const std::string meant = nearest_name(setting.name, names);
      findings.error(place_of_setting(setting.name), fmt::format("{} declares no such parameter", file),
                     !meant.empty()  ? fmt::format("did you mean '{}'?", excerpt(meant))
                     : names.empty() ? "it declares none"
                                     : "its parameters are: " + listed(names));
    }
  }
}

class Computation {
 public:
  explicit Computation(const std::vector<ParameterValue>& parameters) : parameters_(parameters) {}

  // The same node where nothing is computed in it.
  YamlNode::Pointer computed(const YamlNode::Pointer& node) {
    if (node->kind == YamlNode::Kind::scalar && node->text.starts_with('=')) return with_value(*node);
    std::shared_ptr<YamlNode> changed;
    const auto change = [&](const YamlNode::Pointer& old, const auto& put) {
      YamlNode::Pointer child = computed(old);
      if (child == old) return;
      if (!changed) changed = std::make_shared<YamlNode>(*node);
      put(std::move(child));
    };
    for (std::size_t i = 0; i < node->items.size(); ++i)
      change(node->items[i], [&](YamlNode::Pointer child) { changed->items[i] = std::move(child); });
    for (std::size_t i = 0; i < node->entries.size(); ++i)
      change(node->entries[i].value, [&](YamlNode::Pointer child) { changed->entries[i].value = std::move(child); });
    return changed ? changed : node;
  }

  bool uses(const std::string& name) const { return used_.contains(name); }
  bool has_faults() const { return fault_count_ > 0; }

 private:
  YamlNode::Pointer with_value(const YamlNode& node) {
    Evaluation evaluation = evaluate(node.text, parameters_, fault_count_ < most_told_errors);
    used_.merge(evaluation.used);
    auto result = std::make_shared<YamlNode>(node);
    auto arithmetic = std::make_shared<YamlNode::Arithmetic>();
    arithmetic->value = evaluation.value;
    if (evaluation.fault) {
      ++fault_count_;
      Place place = node.place;
      if (node.text_column > 0) place.column = node.text_column + static_cast<int>(evaluation.fault->at);
      arithmetic->fault = Finding{std::move(place), Severity::error, std::move(evaluation.fault->what), std::move(evaluation.fault->hint)};
    }
    result->arithmetic = std::move(arithmetic);
    return result;
  }

  const std::vector<ParameterValue>& parameters_;
  std::set<std::string> used_;
  int fault_count_ = 0;
};

void refuse_unused(const YamlNode* declared, const std::string& file, const Settings& settings, const Computation& computation, Findings& findings) {
  if (!declared || computation.has_faults()) return;  // a fault may have kept one from being used
  for (const YamlNode::Entry& entry : declared->entries)
    if (entry.key_place.file == file && is_parameter_name(entry.key) && !computation.uses(entry.key))
      findings.error(entry.key_place, fmt::format("nothing uses the parameter '{}'", excerpt(entry.key)),
                     fmt::format("use it in a value, as in = 2 * {}, or leave it out", excerpt(entry.key)));
  for (const ParameterValue& setting : settings) {
    const auto is_set = [&](const YamlNode::Entry& one) { return one.key == setting.name && one.key_place.file != file; };
    if (std::any_of(declared->entries.begin(), declared->entries.end(), is_set) && !computation.uses(setting.name))
      findings.error(place_of_setting(setting.name), fmt::format("nothing in {} uses this parameter any more", file), "what it extends declares it");
  }
}

}  // namespace

Place place_of_setting(const std::string& name) { return {"--set " + excerpt(name), -1, 0}; }

ComputedTree with_arithmetic(const YamlNode::Pointer& root, const std::string& file, const Settings& settings, Findings& findings) {
  ComputedTree result{root, {}};
  const YamlNode::Pointer declared = root->find(parameters_key);
  if (declared) result.parameters = read_parameters(*declared, findings);
  set(result.parameters, settings, file, findings);
  Computation computation(result.parameters);
  result.root = computation.computed(root);
  refuse_unused(declared.get(), file, settings, computation, findings);
  return result;
}

}  // namespace sagitta::prescription
