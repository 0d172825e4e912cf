// A recording under way.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>

#include "expression/recorder.h"
#include "sfdae/sfdae.h"

// Mistakes are remembered, the first one counts, and recording goes on.
struct sfdae_record {
  explicit sfdae_record(int num_unknowns) : recorder(num_unknowns) {}

  void remember(int mistake_status, std::string mistake) {
    if (status != SFDAE_OK) return;
    status = mistake_status;
    message = std::move(mistake);
  }

  sfdae::core::Recorder recorder;
  int status = SFDAE_OK;
  std::string message;
};

namespace sfdae::core {

// Marks in place of a node.
constexpr int not_set = -1, mistaken = -2;

inline sfdae_expression plain(double value) { return {nullptr, value, 0}; }
inline sfdae_expression in(sfdae_record* record, int node) { return {record, 0.0, node}; }

// The operand's node; `mistaken` after remembering what is wrong with it.
int node_of(sfdae_record& record, const sfdae_expression& operand, const std::string& where);

// Failure, with a public status, for mistakes that have been remembered; and for what the user's function returned.
void check_record(const sfdae_record& record);
void check_outcome(const sfdae_record& record, int returned);

}  // namespace sfdae::core
