// Checkpoints: saving and restoring an integration with its system.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/checkpoint.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "linalg/index.h"
#include "problem/failure.h"
#include "watch/events.h"

namespace sfdae::core {

namespace {

// The header has the layout version and the length in doubles; a checksum of the rest follows.
constexpr int layout = 14;
constexpr std::size_t header_size = 2;

struct Header {
  int version = layout;
  int m = 0, n = 0;
  SystemForm form = SystemForm::reduced;
  bool has_sensitivities = false;
  long length = 0;

  void archive(Archive& archive) {
    archive.small(version, m, n);
    constexpr long forms = static_cast<long>(SystemForm::extension) + 1;
    long number = static_cast<long>(form) + (has_sensitivities ? forms : 0);
    archive.counts(length, number);
    if (number < 0 || number >= 2 * forms) throw DamagedArchive();
    has_sensitivities = number >= forms;
    form = static_cast<SystemForm>(number % forms);
  }
};

// Parameter numbers, -1 for none.
void archive_parameters(Archive& archive, std::vector<int>& parameters) {
  long count = static_cast<long>(parameters.size()), unused = 0;
  archive.counts(count, unused);
  if (archive.is_reading()) {
    if (count <= 0 || static_cast<std::size_t>(count) > archive.rest()) throw DamagedArchive();
    parameters.resize(static_cast<std::size_t>(count));
  }
  for (int& number : parameters) {
    double value = number;
    archive.real(value);
    if (!(value >= -1.0 && value < 1e9) || value != std::floor(value)) throw DamagedArchive();
    number = static_cast<int>(value);
  }
}

void archive_all(DaeSystem& system, Integration& integration, Archive& archive) {
  if (const Sensitivities* carried = integration.sensitivities()) {
    std::vector<int> parameters = carried->parameters();
    archive_parameters(archive, parameters);
  }
  system.archive(archive);
  integration.archive(archive);
  integration.archive_sensitivities(archive);
}

double checksum(const double* values, std::size_t count) {
  WordHash hash;
  hash.add(values, count);
  return hash.value_as_real();
}

}  // namespace

std::size_t checkpoint_size(DaeSystem& system, Integration& integration) {
  Archive counter = Archive::counter();
  archive_all(system, integration, counter);
  return header_size + 1 + counter.size();
}

void save_checkpoint(DaeSystem& system, Integration& integration, double* to) {
  const std::size_t length = checkpoint_size(system, integration);
  Archive archive = Archive::writer(to, length);
  Header header{layout,
                system.equations(),
                system.unknowns(),
                system.form(),
                integration.sensitivities() != nullptr,
                static_cast<long>(length)};
  header.archive(archive);
  double sum = 0.0;
  archive.real(sum);
  archive_all(system, integration, archive);
  to[header_size] = checksum(to + header_size + 1, length - header_size - 1);
}

namespace {

std::string names_of(const std::vector<int>& parameters, const Record* equations) {
  constexpr std::size_t most_named = 8;
  std::string names;
  for (std::size_t j = 0; j < std::min(parameters.size(), most_named); ++j) {
    if (j > 0) names += ", ";
    const std::size_t number = index(std::max(parameters[j], 0));
    if (parameters[j] < 0) names += "start values";
    else if (equations != nullptr && number < equations->parameters().size())
      names += equations->parameters()[number].name;
    else names += "one that these equations do not have";
  }
  return parameters.size() > most_named ? names + ", ..." : names;
}

// Throws Failure unless the sensitivities of the checkpoint are those wanted.
void demand_sensitivities(bool are_there, Model& model, const WantedSensitivities* wanted, Archive& content) {
  if (!are_there && wanted == nullptr) return;
  if (!are_there)
    throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                  "the checkpoint has no sensitivities: call sfdae_set_sensitivities with count = 0 first.");
  std::vector<int> parameters;
  archive_parameters(content, parameters);
  if (wanted != nullptr && parameters == wanted->parameters) return;
  const TaylorEvaluator* const evaluator = model.evaluator();
  throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                format("the checkpoint has %zu sensitivities, by ", parameters.size()) +
                    names_of(parameters, evaluator != nullptr ? &evaluator->record() : nullptr) +
                    ": call sfdae_set_sensitivities with these first.");
}

// Contents after the header, after checks that they belong to such a problem. Throws Failure or DamagedArchive.
Archive checked_content(Model& model, const SavedCheckpoint& saved, const WantedSensitivities* wanted) {
  const auto [from, length] = saved;
  Archive start = Archive::reader(from, length);
  Header header;
  header.archive(start);
  double sum = 0.0;
  start.real(sum);
  if (header.version != layout || header.length < static_cast<long>(start.size()) ||
      static_cast<std::size_t>(header.length) > length)
    throw DamagedArchive();
  if (header.m != model.m() || header.n != model.n())
    throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                  format("the checkpoint is that of a problem with %d equations in %d unknowns, "
                         "not %d in %d.",
                         header.m, header.n, model.m(), model.n()));
  const std::size_t total = static_cast<std::size_t>(header.length);
  if (sum != checksum(from + start.size(), total - start.size())) throw DamagedArchive();
  Archive content = Archive::reader(from + start.size(), total - start.size());
  demand_sensitivities(header.has_sensitivities, model, wanted, content);
  // Last step: from here on the model expects the contents of the archive.
  if (!model.expect(header.form, wanted != nullptr)) throw DamagedArchive();
  return content;
}

// Scope that restores the previous model and events at its end, unless finish() was called.
class Undo {
 public:
  Undo(Model& model, Events* events) : model_(model), events_(events) {
    if (events_ != nullptr) events_before_ = *events_;
  }
  Undo(const Undo&) = delete;
  Undo& operator=(const Undo&) = delete;
  ~Undo() {
    if (has_finished_) return;
    if (has_restored_) model_.undo_restore();
    if (events_ != nullptr) *events_ = std::move(*events_before_);
  }
  void note_restored() { has_restored_ = true; }
  void finish() {
    model_.finish_restore();
    has_finished_ = true;
  }

 private:
  Model& model_;
  Events* events_;
  std::optional<Events> events_before_;
  bool has_restored_ = false, has_finished_ = false;
};

// Without values, which are read next.
std::unique_ptr<Sensitivities> sensitivities_of(Model& model, const WantedSensitivities& wanted) {
  std::unique_ptr<SensitivitySystem> system = model.sensitivities(wanted.parameters);
  if (!system) throw DamagedArchive();
  std::vector<double> S(system->size());
  return std::make_unique<Sensitivities>(std::move(system), wanted.options, std::move(S));
}

}  // namespace

std::unique_ptr<Integration> restore_checkpoint(Model& model, const ModelOptions& model_options,
                                                const IntegrationOptions& options, const SavedCheckpoint& saved,
                                                const WantedSensitivities* wanted) {
  try {
    Undo undo(model, options.events);
    Archive archive = checked_content(model, saved, wanted);
    model.restore(model_options, archive);
    undo.note_restored();
    auto integration = std::make_unique<Integration>(*model.system(), model.change_watch(), options, archive);
    if (wanted != nullptr) integration->carry_archived(sensitivities_of(model, *wanted), archive);
    if (!archive.has_ended()) throw DamagedArchive();
    undo.finish();
    return integration;
  } catch (const DamagedArchive&) {
    throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                  "this is not a checkpoint, or it was made with other options or is damaged.");
  }
}

}  // namespace sfdae::core
