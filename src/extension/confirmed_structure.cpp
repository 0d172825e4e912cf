// Certificates of the structure of an extension at the points of a solution.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/confirmed_structure.h"

#include "linalg/format.h"
#include "linalg/index.h"
#include "structure/block_determinants.h"
#include "structure/replacement.h"

namespace sfdae::core {

ConfirmedStructure::ConfirmedStructure(MinimalExtension& extension, double rank_tol)
    : extension_(extension),
      problem_(extension.problem()),
      rank_tol_(rank_tol),
      judge_(extension.structure(), extension.leading(), extension.take_ordered_blocks()),
      has_constant_blocks_(has_constant_blocks(extension.structure(), problem_.evaluator())) {}

bool ConfirmedStructure::is_known(Certificates certificates) const {
  return has_constant_blocks_ && is_certified_ &&
         certified_parameters_ == problem_.evaluator().changes_of_parameters() &&
         (certificates == Certificates::not_kept || !certificate_.blocks.empty());
}

PointStatus ConfirmedStructure::certify(const Jet& jet, const std::vector<double>& noise, CallbackError& error,
                                        Certificates certificates) {
  points_ = 0;
  about_change_.clear();
  if (is_known(certificates)) return PointStatus::ok;
  is_certified_ = false;
  certificate_ = {};
  Certificate certificate;
  const CertifiedPoint point{jet.t, jet.x.data(), noise.empty() ? nullptr : noise.data()};
  if (!judge_.certify(problem_.evaluator(), point, rank_tol_, certificate)) {
    error = problem_.evaluation_error(jet.t);
    return PointStatus::callback_error;
  }
  smallest_kept_ = certificate.smallest_kept();
  is_certified_ = certificate.is_given();
  certified_parameters_ = problem_.evaluator().changes_of_parameters();
  const int singular = certificate.first(BlockVerdict::singular);
  const int block = singular >= 0 ? singular : certificate.first(BlockVerdict::unclear);
  if (certificates == Certificates::kept) certificate_ = std::move(certificate);
  if (!still_cancel(extension_.structure(), problem_.evaluator(), jet.t, jet.x.data())) {
    about_change_ = "equations that depended on each other do so no more.";
    return PointStatus::changed;
  }
  if (is_certified_) return PointStatus::ok;
  about_change_ = describe_block(block) + (singular >= 0 ? " is singular." : " is nearly singular.");
  return PointStatus::changed;
}

PointStatus ConfirmedStructure::certify_aside(const Jet& jet, const std::vector<double>& noise,
                                              CallbackError& error) {
  const int points = points_;
  const PointStatus status = certify(jet, noise, error);
  points_ = points;
  return status;
}

void ConfirmedStructure::forget_what_certifies() {
  if (!has_constant_blocks_ || !is_certified_) return;
  judge_.forget_order();
  extension_.leading().forget_values();
}

std::string ConfirmedStructure::describe_block(int block) const {
  return format("block %d of the system Jacobian, with ", block) +
         problem_.evaluator().record().name(extension_.structure().blocks.equations(block)[0]) + ",";
}

}  // namespace sfdae::core
