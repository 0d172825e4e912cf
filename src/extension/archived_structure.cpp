// Replaced equations in checkpoints.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/archived_structure.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace sfdae::core {

namespace {

using Row = std::vector<Signature::Entry>;

// When reading, each line has at most `most` parts.
template <class Part, class ArchivePart>
void archive_parts(std::vector<Part>& parts, int most, Archive& archive, ArchivePart archive_part) {
  int count = static_cast<int>(parts.size());
  archive.small(count);
  if (archive.is_reading() && (count < 0 || count > most)) throw DamagedArchive();
  parts.resize(index(count));
  for (Part& part : parts) archive_part(part);
}

void archive_equation(std::vector<EquationTerm>& terms, Row& row, int n, Archive& archive) {
  constexpr int highest_order = 64;  // far above those of equations that are replaced
  const auto check = [&](int place, int order) {
    if (place < 0 || place >= n || order < 0 || order > highest_order) throw DamagedArchive();
  };
  archive_parts(terms, n * highest_order, archive, [&](EquationTerm& term) {
    archive.small(term.equation, term.order);
    archive.real(term.factor);
    check(term.equation, term.order);
  });
  archive_parts(row, n, archive, [&](Signature::Entry& entry) {
    int unknown = entry.unknown, order = entry.order;
    archive.small(unknown, order);
    check(unknown, order);
    entry = {unknown, order};
  });
}

// True if the row has each unknown at most once, with a derivative that the terms may contain.
bool is_row_of(const std::vector<EquationTerm>& terms, const Row& row, const Signature& recorded) {
  std::vector<int> highest(index(recorded.size()), -1);
  for (const EquationTerm& term : terms)
    for (const Signature::Entry& entry : recorded.row(term.equation))
      highest[index(entry.unknown)] = std::max(highest[index(entry.unknown)], entry.order + term.order);
  return std::all_of(row.begin(), row.end(), [&](const Signature::Entry& entry) {
    return entry.order <= std::exchange(highest[index(entry.unknown)], -1);
  });
}

}  // namespace

void archive_structure(const Structure& structure, Archive& archive) {
  const int n = structure.signature.size();
  int count = structure.equations.num_replaced();
  archive.small(count);
  for (int i = 0; i < n; ++i) {
    if (!structure.equations.is_replaced(i)) continue;
    const auto of_equation = structure.equations.of(i);
    const auto of_row = structure.signature.row(i);
    std::vector<EquationTerm> terms(of_equation.begin(), of_equation.end());
    Row row(of_row.begin(), of_row.end());
    archive.small(i);
    archive_equation(terms, row, n, archive);
  }
}

std::shared_ptr<const Structure> archived_structure(const Structure& recorded, Archive& archive) {
  const int n = recorded.signature.size();
  int count = 0;
  archive.small(count);
  if (count < 0 || count > n) throw DamagedArchive();
  EquationTerms equations(n);
  std::vector<Row> rows;
  for (int i = 0; i < n; ++i) rows.emplace_back(recorded.signature.row(i).begin(), recorded.signature.row(i).end());
  for (int k = 0; k < count; ++k) {
    int i = 0;
    archive.small(i);
    if (i < 0 || i >= n) throw DamagedArchive();
    std::vector<EquationTerm> terms;
    archive_equation(terms, rows[index(i)], n, archive);
    if (equations.is_replaced(i) || !is_row_of(terms, rows[index(i)], recorded.signature)) throw DamagedArchive();
    equations.replace(i, std::move(terms));
  }
  const Signature signature(rows);
  const Transversal transversal = highest_transversal(signature);
  if (!transversal.exists()) throw DamagedArchive();
  return std::make_shared<const Structure>(signature, transversal, std::move(equations));
}

}  // namespace sfdae::core
