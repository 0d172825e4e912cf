// SPDX-License-Identifier: BSD-3-Clause
#include "expression/parameter_unknowns.h"

#include <algorithm>

#include "expression/recorder.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

class Transcription {
 public:
  Transcription(const Record& record, const std::vector<int>& parameters)
      : record_(record), parameters_(parameters), recorder_(record.n() + static_cast<int>(parameters.size())) {
    for (const Parameter& parameter : record.parameters()) recorder_.parameter(parameter.name, parameter.value);
    for (int i = 0; i < record.num_nodes(); ++i) nodes_.push_back(transcribe(i));
  }

  std::shared_ptr<const Record> finish() {
    std::vector<int> residuals;
    for (int i = 0; i < record_.m(); ++i) residuals.push_back(nodes_[index(record_.residual(i))]);
    return recorder_.finish(std::move(residuals), record_.equation_names());
  }

 private:
  int parameter(int which) {
    const auto place = std::find(parameters_.begin(), parameters_.end(), which);
    if (place != parameters_.end())
      return recorder_.unknown(record_.n() + static_cast<int>(place - parameters_.begin()));
    const Parameter& parameter = record_.parameters()[index(which)];
    return recorder_.parameter(parameter.name, parameter.value);
  }

  int transcribe(int i) {
    const Node& node = record_.node(i);
    switch (node.operation) {
      case Operation::constant: return recorder_.constant(record_.constant(node.a));
      case Operation::parameter: return parameter(node.a);
      case Operation::time: return recorder_.time();
      case Operation::unknown: return recorder_.unknown(node.a);
      case Operation::derivative: return recorder_.derivative(node.a);
      default: break;
    }
    const Operands operands = record_.operands(i);
    std::vector<int> to;
    for (int k = 0; k < operands.size(); ++k) to.push_back(nodes_[index(operands[k])]);
    if (node.operation == Operation::function) {
      FunctionCall call = record_.call(i);
      call.arguments = std::move(to);
      return recorder_.call(call);
    }
    to.resize(3, -1);
    return recorder_.apply(node.operation, to[0], to[1], to[2]);
  }

  const Record& record_;
  const std::vector<int>& parameters_;
  Recorder recorder_;
  std::vector<int> nodes_;  // of the transcript, by those of the record
};

}  // namespace

std::shared_ptr<const Record> with_parameters_as_unknowns(const Record& record, const std::vector<int>& parameters) {
  return Transcription(record, parameters).finish();
}

}  // namespace sfdae::core
