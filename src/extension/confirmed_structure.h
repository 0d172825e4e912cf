// Certificates of the structure of an extension at the points of a solution, and the distance of its system Jacobian
// from singular matrices.
//
// A point is certified once in a while, as ranks are elsewhere; a system Jacobian that does not depend on the point is
// certified once for all points with the same parameters.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "extension/minimal_extension.h"
#include "structure/structure.h"
#include "system/jet.h"
#include "system/strangeness_free_system.h"

namespace sfdae::core {

class ConfirmedStructure {
 public:
  // The extension has to outlive this object.
  ConfirmedStructure(MinimalExtension& extension, double rank_tol);

  enum class Certificates { kept, not_kept };
  // noise: rounding error bounds of the jet, or empty. Not ok: the error, or `changed`, which about_change() explains.
  PointStatus certify(const Jet& jet, const std::vector<double>& noise, CallbackError& error,
                      Certificates certificates = Certificates::not_kept);
  // Like certify(), without an effect on when the next point is due.
  PointStatus certify_aside(const Jet& jet, const std::vector<double>& noise, CallbackError& error);
  // Counts one more point; true if it has to be certified.
  bool is_due() { return ++points_ >= points_between_certificates; }
  // Frees the memory that certificates need, once one holds at all points.
  void forget_what_certifies();

  bool is_certified() const { return is_certified_; }
  double smallest_kept() const { return smallest_kept_; }
  // The certificate that was kept, once: it has a decision for each block.
  Certificate take_certificate() { return std::exchange(certificate_, {}); }
  const std::string& about_change() const { return about_change_; }
  void set_about_change(std::string about) { about_change_ = std::move(about); }
  std::string describe_block(int block) const;
  int& points() { return points_; }  // since one was certified

 private:
  bool is_known(Certificates certificates) const;

  // Chosen, not measured.
  static constexpr int points_between_certificates = 20;

  MinimalExtension& extension_;
  RecordedProblem& problem_;
  double rank_tol_;
  StructureJudge judge_;
  Certificate certificate_;
  bool is_certified_ = false;
  // The system Jacobian does not depend on the point; the version of the parameters when it was certified.
  bool has_constant_blocks_;
  long certified_parameters_ = -1;
  double smallest_kept_ = 1.0;
  std::string about_change_;
  int points_ = 0;
};

}  // namespace sfdae::core
