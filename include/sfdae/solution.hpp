// SPDX-License-Identifier: BSD-3-Clause

// Recorded solution of a whole run (dense output), for C++17 and later. Included by sfdae.hpp.
#ifndef SFDAE_SOLUTION_HPP
#define SFDAE_SOLUTION_HPP

#include <sfdae/solution.h>
#include <sfdae/results.hpp>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace sfdae {

/// The solution over a whole run, recorded by Solver::record, see sfdae_solution. Movable; one moved from can only be
/// assigned to or destroyed.
class Solution {
 public:
  Solution() { checked(sfdae_create_solution(&solution_), "a solution"); }
  Solution(Solution&& other) noexcept : solution_(std::exchange(other.solution_, nullptr)) {}
  Solution& operator=(Solution&& other) noexcept {
    std::swap(solution_, other.solution_);
    return *this;
  }
  ~Solution() { sfdae_destroy_solution(&solution_); }

  /// n; Error with SFDAE_NOT_STARTED if nothing was recorded.
  int num_unknowns() const { return range().num_unknowns; }
  /// Start of the recording; Error with SFDAE_NOT_STARTED if nothing was recorded.
  double start() const { return range().start; }
  /// The end of the last step recorded; Error with SFDAE_NOT_STARTED if nothing was.
  double end() const { return range().end; }

  /// x and x' at t between start and end, else an Error.
  Point operator()(double t) const {
    const auto n = static_cast<std::size_t>(num_unknowns());
    Point point{t, std::vector<double>(n), std::vector<double>(n)};
    const int status = sfdae_evaluate_solution(solution_, t, point.x.data(), point.xdot.data());
    if (status < 0)
      throw Error(status, "t = " + std::to_string(t) + " is outside of what was recorded, " +
                              std::to_string(start()) + " to " + std::to_string(end()));
    return point;
  }

  /// The largest expected difference from the integrator's own values, in tolerances, and its time, see
  /// sfdae_get_solution_accuracy.
  struct Accuracy {
    double in_tolerances, t;
  };
  Accuracy accuracy() const {
    Accuracy result{};
    checked(sfdae_get_solution_accuracy(solution_, &result.in_tolerances, &result.t), "nothing was recorded");
    return result;
  }

  /// Discards the recording after t, between start and end, else an Error.
  void cut(double t) { checked(sfdae_cut_solution(solution_, t), "the solution cannot end there"); }

  /// The solution as numbers, to be stored or written to a file.
  std::vector<double> save() const {
    std::size_t length = 0;
    checked(sfdae_get_solution_length(solution_, &length), "the solution");
    std::vector<double> values(length);
    checked(sfdae_save_solution(solution_, values.data(), length), "the solution");
    return values;
  }

  /// Loads a saved solution; Error if it is damaged or no solution.
  static Solution load(const std::vector<double>& values) {
    const double nothing = 0;  // an empty vector may have no address
    Solution solution;
    checked(sfdae_load_solution(solution.solution_, values.empty() ? &nothing : values.data(), values.size()),
            "this is not a solution, or it is damaged");
    return solution;
  }

  /// The C handle.
  sfdae_solution* get() const noexcept { return solution_; }

 private:
  struct Range {
    int num_unknowns;
    double start, end;
  };
  Range range() const {
    Range range{};
    checked(sfdae_get_solution_range(solution_, &range.num_unknowns, &range.start, &range.end),
            "nothing was recorded");
    return range;
  }
  static void checked(int status, const char* what) {
    if (status < 0) throw Error(status, std::string(what) + ": " + sfdae_status_name(status));
  }

  sfdae_solution* solution_ = nullptr;
};

}  // namespace sfdae

#endif
