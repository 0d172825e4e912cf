// Checkpoints of an integration: writing and reading.
// SPDX-License-Identifier: BSD-3-Clause
#include <utility>

#include "integrate/checkpoint.h"
#include "integrate/integration.h"
#include "integrate/step_events.h"
#include "linalg/index.h"

namespace sfdae::core {

Integration::Integration(DaeSystem& system, std::unique_ptr<ChangeWatch> watch, const IntegrationOptions& options,
                         Archive& saved)
    : options_(options),
      integrator_(system, 1.0),
      choice_{options.method},
      counts_(system),
      watch_(std::move(watch)) {
  archive(saved);
}

void Integration::archive(Archive& archive) {
  DaeSystem& system = integrator_.system;
  // Bit 0: backward; bit 1: with events; bit 2: with finite-difference derivatives; bit 3: with inputs; bit 4: with
  // conditions held.
  const bool has_events = options_.events != nullptr, is_reading = archive.is_reading();
  int kind = (integrator_.direction < 0.0 ? 1 : 0) + (has_events ? 2 : 0) +
             (integrator_.differences.has_errors() ? 4 : 0) + (options_.inputs != nullptr ? 8 : 0) +
             (conditions_.is_plain() ? 0 : 16);
  bool has_change = change_.has_value();
  archive.small(kind, integrator_.must_restart, has_change, choice_.chosen, integrator_.method, choice_.outputs);
  if (is_reading) {
    integrator_.direction = (kind & 1) != 0 ? -1.0 : 1.0;
    if (((kind & 2) != 0) != has_events) throw_events_differ(has_events);
    if (integrator_.method < Method::bdf || integrator_.method > Method::radau || choice_.chosen < Method::bdf ||
        choice_.chosen > Method::automatic)
      throw DamagedArchive();
    integrator_.create(integrator_.method, options_);
  }
  choice_.archive_rates(archive);
  IntegrationCounts all = counts();
  archive_counts(archive, all, options_.short_checkpoints);
  if (!options_.short_checkpoints) archive.real(start_);
  archive.real(integrator_.first_step);
  archive.real(last_returned_);
  if ((kind & 8) != 0) inputs_.archive(archive);
  if (!options_.short_checkpoints) inputs_.archive_account(archive);
  integrator_.stepper->archive(archive, system);
  if (!has_change && watch_) watch_->archive(archive, integrator_.direction);
  if ((kind & 4) != 0) integrator_.differences.archive(archive, index(system.unknowns()));
  if (has_events) archive_events(archive, *options_.events, index(system.unknowns()), span_);
  if (is_reading) {
    counts_.restore(all, system);
    integrator_.contradictions.largest = all.inconsistency;
    resize_workspace();
    if (has_change) change_.emplace();
    start_trail();
  }
  if (has_change) archive_change(archive);
  if ((kind & 16) != 0) conditions_.archive(archive);
}

void Integration::archive_change(Archive& archive) {
  CharacteristicValues& values = change_->new_values;
  archive.real(change_->t_before);
  archive.real(change_->t);
  archive.small(values.mu, values.d, values.a, values.u, values.v);
}

}  // namespace sfdae::core
