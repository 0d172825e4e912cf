// Functions of several arguments in recorded equations that are known by their values and partial derivatives.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "linalg/archive.h"

namespace sfdae::core {

class PointFunction {
 public:
  static constexpr int max_arguments = 16;
  // Partial derivatives of an order are k^order numbers; orders that have more count as not available.
  static constexpr std::size_t max_derivatives = 4096;

  PointFunction(std::string name, int num_arguments) : name_(std::move(name)), num_arguments_(num_arguments) {}
  virtual ~PointFunction() = default;
  PointFunction(const PointFunction&) = delete;
  PointFunction& operator=(const PointFunction&) = delete;

  // Name in messages.
  const std::string& name() const { return name_; }
  int num_arguments() const { return num_arguments_; }

  // All partial derivatives of the order at finite arguments, written to an array of k^order zeros. Returns 0, or the
  // code of a callback. Several threads may call it at a time.
  virtual int derivatives(int order, const double* arguments, double* values) const = 0;
  // Empty if the function has a value there, else the reason why not, for messages.
  virtual std::string objection(const double* /*arguments*/) const { return {}; }
  // Increasing arguments at which a derivative jumps, for functions of one argument.
  virtual const std::vector<double>& breakpoints() const {
    static const std::vector<double> none;
    return none;
  }
  // Order of the derivative that jumps there; this derivative is constant in between.
  virtual int jumping_order() const { return 0; }
  // Adds the function's data to the hash, beyond its name and its number of arguments.
  virtual void add_data(WordHash&) const {}

 private:
  std::string name_;
  int num_arguments_;
};

// One of its partial derivatives, by the arguments `by`, at nodes of a graph; none: the value.
struct FunctionCall {
  std::shared_ptr<const PointFunction> function;
  std::vector<int> arguments;
  std::vector<int> by;
  bool operator==(const FunctionCall&) const = default;
};

// Series of a call and of its derivatives by the arguments, which follow each other in steps of `stride`, like the
// arguments. slopes: null, or where the derivatives go. Coefficients that do not exist become NaN.
struct CallSeries {
  const double* arguments;
  std::ptrdiff_t stride;
  double* value;
  double* slopes;
};
void evaluate(const FunctionCall& call, const CallSeries& series, int order);

// The first order up to this one that the function does not supply, and the code that it returned; code 0 if it
// supplies all.
struct MissingOrder {
  int code = 0, order = 0;
};
MissingOrder missing_order(const FunctionCall& call, const double* arguments, int order);

}  // namespace sfdae::core
