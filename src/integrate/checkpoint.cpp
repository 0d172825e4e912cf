// An integration with its system, saved and restored.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/checkpoint.h"

#include <optional>
#include <utility>

#include "integrate/events.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// First of all: the layout, the length in doubles and a checksum of all that follows.
constexpr int layout = 8;
constexpr std::size_t header_size = 2;

struct Header {
  int version = layout;
  int m = 0, n = 0;
  SystemForm form = SystemForm::reduced;
  long length = 0;

  void archive(Archive& archive) {
    archive.small(version, m, n);
    long number = static_cast<long>(form);
    archive.counts(length, number);
    if (number < 0 || number > static_cast<long>(SystemForm::extension)) throw DamagedArchive();
    form = static_cast<SystemForm>(number);
  }
};

void archive_all(DaeSystem& system, Integration& integration, Archive& archive) {
  system.archive(archive);
  integration.archive(archive);
}

// Cut to the 52 bits that a double holds.
double checksum(const double* values, std::size_t count) {
  WordHash hash;
  hash.add(values, count);
  return static_cast<double>(hash.value() >> 12);
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
  Header header{layout, system.equations(), system.unknowns(), system.form(), static_cast<long>(length)};
  header.archive(archive);
  double sum = 0.0;
  archive.real(sum);
  archive_all(system, integration, archive);
  to[header_size] = checksum(to + header_size + 1, length - header_size - 1);
}

namespace {

// The doubles behind the header, which are those of a checkpoint of such a problem. Throws Failure or DamagedArchive.
Archive checked_content(Model& model, const double* from, std::size_t length) {
  Archive start = Archive::reader(from, length);
  Header header;
  header.archive(start);
  double sum = 0.0;
  start.real(sum);
  if (header.version != layout || header.length <= 0 || static_cast<std::size_t>(header.length) > length)
    throw DamagedArchive();
  if (header.m != model.m() || header.n != model.n())
    throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                  format("the checkpoint is that of a problem with %d equations in %d unknowns, "
                         "not %d in %d.",
                         header.m, header.n, model.m(), model.n()));
  const std::size_t total = static_cast<std::size_t>(header.length);
  if (sum != checksum(from + start.size(), total - start.size())) throw DamagedArchive();
  // Last: from here on the model waits for what the archive has.
  if (!model.expect(header.form)) throw DamagedArchive();
  return Archive::reader(from + start.size(), total - start.size());
}

// The model and the events are as they were before when this ends, unless it is told otherwise.
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

}  // namespace

std::unique_ptr<Integration> restore_checkpoint(Model& model, const ModelOptions& model_options,
                                                const IntegrationOptions& options, const double* from,
                                                std::size_t length) {
  try {
    Undo undo(model, options.events);
    Archive archive = checked_content(model, from, length);
    model.restore(model_options, archive);
    undo.note_restored();
    auto integration = std::make_unique<Integration>(*model.system(), model.change_watch(), options, archive);
    if (!archive.has_ended()) throw DamagedArchive();
    undo.finish();
    return integration;
  } catch (const DamagedArchive&) {
    throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                  "this is not a checkpoint, or it was made with other options or is damaged.");
  }
}

}  // namespace sfdae::core
