// Recording of the formulas of a mechanical system.
// SPDX-License-Identifier: BSD-3-Clause
#include "c_api/record_multibody.h"

#include <string>
#include <vector>

#include "c_api/recording.h"
#include "linalg/index.h"
#include "multibody/multibody_callbacks.h"
#include "multibody/multibody_recorded.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

std::vector<sfdae_expression> zeros(int rows, int columns = 1) {
  return std::vector<sfdae_expression>(index(rows) * index(columns), plain(0.0));
}

std::vector<sfdae_expression> unknowns(sfdae_record& record, int first, int count) {
  std::vector<sfdae_expression> expressions;
  for (int j = 0; j < count; ++j) expressions.push_back(in(&record, record.recorder.unknown(first + j)));
  return expressions;
}

// Names of the formulas in messages.
struct Shape {
  const char* name;
  int rows;
  bool is_matrix;
  std::string entry(std::size_t place) const {
    const int row = static_cast<int>(place) % rows, column = static_cast<int>(place) / rows;
    return is_matrix ? format("%s(%d, %d)", name, row, column) : format("%s[%d]", name, row);
  }
};

std::vector<int> nodes_of(sfdae_record& record, const std::vector<sfdae_expression>& formulas, const Shape& shape) {
  std::vector<int> nodes(formulas.size(), record.recorder.constant(0.0));
  for (std::size_t place = 0; place < formulas.size() && record.status == SFDAE_OK; ++place)
    if (!is_plain_zero(formulas[place])) nodes[place] = node_of(record, formulas[place], shape.entry(place));
  check_record(record);
  return nodes;
}

// Flags, by node.
std::vector<char> depends_on_velocities(const Recorder& recorder, int first_velocity) {
  std::vector<char> depends(index(recorder.num_nodes()), 0);
  for (int i = 0; i < recorder.num_nodes(); ++i) {
    const Node& node = recorder.node(i);
    if (node.operation == Operation::unknown && node.a >= first_velocity) depends[index(i)] = 1;
    const Operands operands = recorder.operands(i);
    for (int k = 0; k < operands.size(); ++k)
      if (depends[index(operands[k])] != 0) depends[index(i)] = 1;
  }
  return depends;
}

}  // namespace

std::unique_ptr<RecordedMultibody> record_multibody(const sfdae_multibody_problem& problem) {
  const MultibodySizes sizes = sizes_of(problem);
  const int nq = sizes.positions, nv = sizes.velocities, nl = sizes.holonomic, nk = sizes.nonholonomic;
  sfdae_record record(nq + nv, false);
  const std::vector<sfdae_expression> q = unknowns(record, 0, nq), v = unknowns(record, nq, nv);
  const sfdae_expression t = in(&record, record.recorder.time());
  std::vector<sfdae_expression> M = zeros(nv, nv), f = zeros(nv), g = zeros(nl), S = zeros(nq, nv), H = zeros(nk, nv),
                                h = zeros(nk);
  for (int j = 0; nq == nv && j < nv; ++j) S[index(j) * index(nq + 1)] = plain(1.0);
  const sfdae_multibody_formulas places{M.data(), f.data(), g.data(), S.data(), H.data(), h.data()};
  check_outcome(record, problem.equations(&record, t, q.data(), v.data(), &places, problem.user));
  const MultibodyFormulas formulas{sizes,
                                   nodes_of(record, M, {"M", nv, true}),
                                   nodes_of(record, f, {"f", nv, false}),
                                   nodes_of(record, g, {"g", nl, false}),
                                   nodes_of(record, S, {"S", nq, true}),
                                   nodes_of(record, H, {"H", nk, true}),
                                   nodes_of(record, h, {"h", nk, false})};
  const std::vector<char> depends = depends_on_velocities(record.recorder, nq);
  const auto demand_independence = [&](const std::vector<int>& nodes, const Shape& shape) {
    for (std::size_t place = 0; place < nodes.size(); ++place)
      if (depends[index(nodes[place])] != 0)
        throw Failure(SFDAE_ILLEGAL_ARGUMENT, "recording of equations: " + shape.entry(place) +
                                                  " depends on v. Only f may: M, g, S, H and h depend on t and q.");
  };
  demand_independence(formulas.M, {"M", nv, true});
  demand_independence(formulas.g, {"g", nl, false});
  demand_independence(formulas.S, {"S", nq, true});
  demand_independence(formulas.H, {"H", nk, true});
  demand_independence(formulas.h, {"h", nk, false});
  return std::make_unique<RecordedMultibody>(record.recorder, formulas);
}

}  // namespace sfdae::core
