// A recording in progress.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "expression/external_function.h"
#include "expression/recorder.h"
#include "expression/spline.h"
#include "sfdae/sfdae.h"

// Mistakes are stored, the first one counts, and recording goes on.
struct sfdae_record {
  // has_derivatives: x' is a variable of the formulas.
  explicit sfdae_record(int num_unknowns, bool with_derivatives = true)
      : recorder(num_unknowns), has_derivatives(with_derivatives) {}

  void remember(int mistake_status, std::string mistake) {
    if (status != SFDAE_OK) return;
    status = mistake_status;
    message = std::move(mistake);
  }

  sfdae::core::Recorder recorder;
  bool has_derivatives;
  // Functions in use, so that equal ones are shared.
  std::vector<std::shared_ptr<const sfdae::core::Spline>> splines;
  std::vector<std::shared_ptr<const sfdae::core::ExternalFunction>> functions;
  // The derivatives of the last differentiated node, by the leaves present then.
  int differentiated = -1;
  std::map<int, int> derivatives;
  int status = SFDAE_OK;
  std::string message;
};

namespace sfdae::core {

// Marks in place of a node.
constexpr int not_set = -1, mistaken = -2;

inline sfdae_expression plain(double value) { return {nullptr, value, 0}; }
inline sfdae_expression in(sfdae_record* record, int node) { return {record, 0.0, node}; }

// Most entries of large matrices are plain zeros: they need neither a node of their own nor a name for messages.
inline bool is_plain_zero(const sfdae_expression& operand) {
  return operand.record == nullptr && operand.value == 0.0;
}

// The operand's node; `mistaken` after an error in it has been stored.
int node_of(sfdae_record& record, const sfdae_expression& operand, const std::string& where);

// Throws Failure, with a public status, for stored mistakes, and for an error that the user's function returned.
void check_record(const sfdae_record& record);
void check_outcome(const sfdae_record& record, int returned);

}  // namespace sfdae::core
