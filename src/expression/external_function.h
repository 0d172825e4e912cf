// User-supplied functions in recorded equations.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "expression/point_function.h"
#include "sfdae/sfdae.h"

namespace sfdae::core {

class ExternalFunction : public PointFunction {
 public:
  ExternalFunction(const std::string& name, int num_arguments, sfdae_external_function function, void* user)
      : PointFunction(name, num_arguments), function_(function), user_(user) {}

  bool is(sfdae_external_function function, void* user, int num_arguments) const {
    return function_ == function && user_ == user && this->num_arguments() == num_arguments;
  }
  int derivatives(int order, const double* arguments, double* values) const override {
    return function_(order, arguments, values, user_);
  }

 private:
  sfdae_external_function function_;
  void* user_;
};

}  // namespace sfdae::core
