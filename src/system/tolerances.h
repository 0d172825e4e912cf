// Accuracy requirements of users: tolerances of the components, and contradictions of redundant equations.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <utility>
#include <vector>

namespace sfdae::core {

// A number for each component, stored once if it is the same for all.
class PerComponent {
 public:
  PerComponent() = default;
  static PerComponent same(std::size_t size, double all) {
    PerComponent result;
    result.size_ = size;
    result.all_ = all;
    return result;
  }
  PerComponent(std::vector<double> each) : size_(each.size()), each_(std::move(each)) {}
  PerComponent(std::initializer_list<double> each) : PerComponent(std::vector<double>(each)) {}

  std::size_t size() const { return size_; }
  double operator[](std::size_t i) const { return each_.empty() ? all_ : each_[i]; }
  // One that stands for all, where they are the same, or each.
  std::vector<double> different() const { return each_.empty() && size_ > 0 ? std::vector<double>{all_} : each_; }
  void push_back(double value) {
    if (each_.empty()) each_.assign(size_, all_);
    each_.push_back(value);
    ++size_;
  }
  template <class Function>
  PerComponent mapped(Function function) const {
    PerComponent result = *this;
    result.all_ = function(all_);
    for (double& value : result.each_) value = function(value);
    return result;
  }
  bool operator==(const PerComponent& other) const {
    if (size_ != other.size_) return false;
    for (std::size_t i = 0; i < (each_.empty() && other.each_.empty() ? std::min(size_, std::size_t(1)) : size_); ++i)
      if ((*this)[i] != other[i]) return false;
    return true;
  }

 private:
  std::size_t size_ = 0;
  double all_ = 0.0;
  std::vector<double> each_;  // or none
};

struct Tolerances {
  PerComponent rtol, atol;  // n each
  bool operator==(const Tolerances&) const = default;
};

// For consistent values and for integrations.
struct Acceptance {
  Tolerances tolerances;
  bool ignore_inconsistency = false;
  double consistency_tol = 1e-8;  // relative size of a contradiction that counts
};

}  // namespace sfdae::core
