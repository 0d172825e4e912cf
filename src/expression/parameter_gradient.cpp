// Derivatives of recorded equations by their parameters.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/parameter_gradient.h"

#include <string>
#include <utility>

#include "expression/node_copies.h"
#include "expression/recorder.h"
#include "expression/symbolic_gradient.h"
#include "linalg/index.h"

namespace sfdae::core {

ParameterGradient parameter_gradient(const Record& record, const std::vector<int>& parameters) {
  Recorder recorder(record.n());
  const std::vector<int> copies = copy_nodes(record, recorder);
  std::vector<int> leaves;
  for (int j : parameters) {
    const Parameter& parameter = record.parameters()[index(j)];
    leaves.push_back(recorder.parameter(parameter.name, parameter.value));
  }
  const int zero = recorder.constant(0.0);
  ParameterGradient result;
  std::vector<int> formulas;
  std::vector<std::string> names;
  for (int i = 0; i < record.m(); ++i) {
    const std::vector<int> gradient = symbolic_gradient(recorder, copies[index(record.residual(i))], leaves);
    for (std::size_t j = 0; j < leaves.size(); ++j) {
      if (gradient[j] == zero) continue;
      result.places.push_back({i, static_cast<int>(j)});
      formulas.push_back(gradient[j]);
      names.push_back("the derivative of " + record.name(i) + " by parameter \"" +
                      record.parameters()[index(parameters[j])].name + "\"");
    }
  }
  result.formulas = recorder.excerpt(record.n(), std::move(formulas), std::move(names));
  return result;
}

}  // namespace sfdae::core
