// Identity of a checkpoint: properties that the restoring solver must share with it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "integrate/integration_options.h"
#include "linalg/archive.h"
#include "system/model.h"

namespace sfdae::core {

// These are a hash of the equations (Model::add_equations), the values of their parameters, the method, and the options
// that affect the index analysis. User-supplied functions cannot be compared.
class CheckpointIdentity {
 public:
  struct Value {
    const char* name;  // must outlive this object: owned by the model
    double value;
  };

  CheckpointIdentity(double equations, std::vector<Value> parameters, std::vector<Value> options)
      : equations_(equations), parameters_(std::move(parameters)), options_(std::move(options)) {}

  std::size_t size() const { return 2 + options_.size() + parameters_.size(); }  // in doubles
  void write(Archive& archive) const;
  // Reads the identity of a checkpoint. Throws Failure, SFDAE_ILLEGAL_ARGUMENT, with the first difference and both
  // values if it is not this one, or DamagedArchive.
  void demand_same(Archive& archive) const;

 private:
  double equations_;
  std::vector<Value> parameters_, options_;
};

CheckpointIdentity identity_of(Model& model, const ModelOptions& options, Method method);

}  // namespace sfdae::core
