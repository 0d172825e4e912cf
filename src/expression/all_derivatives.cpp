// Derivatives of recorded equations by all that they contain.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/all_derivatives.h"

#include <string>
#include <utility>

#include "expression/node_copies.h"
#include "expression/recorder.h"
#include "expression/symbolic_gradient.h"
#include "linalg/index.h"

namespace sfdae::core {

std::shared_ptr<const Record> all_derivatives(const Record& record, const Tape& tape,
                                              const std::vector<int>& parameters, std::size_t most) {
  Recorder recorder(record.n());
  const std::vector<int> copies = copy_nodes(record, recorder);
  std::vector<int> of_parameters, formulas, by_parameters;
  for (int j : parameters) {
    const Parameter& parameter = record.parameters()[index(j)];
    of_parameters.push_back(recorder.parameter(parameter.name, parameter.value));
  }
  const int zero = recorder.constant(0.0);
  for (int i = 0; i < record.m(); ++i) {
    std::vector<int> leaves;
    for (std::size_t e = tape.first_target[index(i)]; e < tape.first_target[index(i + 1)]; ++e) {
      const int unknown = tape.targets[e].unknown;
      leaves.push_back(tape.targets[e].derivative ? recorder.derivative(unknown) : recorder.unknown(unknown));
    }
    const std::size_t entries = leaves.size();
    leaves.insert(leaves.end(), of_parameters.begin(), of_parameters.end());
    const std::vector<int> gradient = symbolic_gradient(recorder, copies[index(record.residual(i))], leaves);
    for (std::size_t k = 0; k < gradient.size(); ++k)
      if (k < entries) formulas.push_back(gradient[k]);
      else if (gradient[k] != zero) by_parameters.push_back(gradient[k]);
    if (index(recorder.num_nodes()) > most) return nullptr;
  }
  formulas.insert(formulas.end(), by_parameters.begin(), by_parameters.end());
  std::vector<std::string> names(formulas.size(), "a derivative");
  return recorder.excerpt(record.n(), std::move(formulas), std::move(names));
}

}  // namespace sfdae::core
