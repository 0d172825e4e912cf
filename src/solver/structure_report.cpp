// Structural analysis in the diagnostics report.
// SPDX-License-Identifier: BSD-3-Clause
#include "solver/structure_report.h"

#include <algorithm>
#include <span>
#include <vector>

#include "linalg/format.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Maximum size of a system whose signature matrix is shown; maximum numbers of blocks and states listed.
constexpr int most_equations = 12, most_blocks = 12, most_states = 12;

std::string derivative(int unknown, int order) {
  return format("x[%d]", unknown) + (order > 2 ? format("^(%d)", order) : std::string(index(order), '\''));
}

template <class Item, class Name>
std::string listed(std::span<const Item> items, int most, Name name) {
  std::string text;
  for (std::size_t k = 0; k < items.size() && k < index(most); ++k) text += (k > 0 ? ", " : "") + name(items[k]);
  return items.size() > index(most) ? text + format(", ... (%zu)", items.size()) : text;
}

// sigma_ij, followed by '*' in the assignment; c_i at the right, d_j below.
std::string signature_table(const Structure& structure, const Record& record) {
  constexpr int width = 6, name_width = 16;
  const int n = structure.signature.size();
  std::string text = format("  %-*s", name_width, "equation");
  for (int j = 0; j < n; ++j) text += format("%*s", width, derivative(j, 0).c_str());
  text += "     c\n";
  for (int i = 0; i < n; ++i) {
    std::vector<std::string> entries(index(n), ".");
    for (const Signature::Entry& entry : structure.signature.row(i))
      entries[index(entry.unknown)] =
          format("%d%s", entry.order, structure.transversal.unknown_of[index(i)] == entry.unknown ? "*" : "");
    const std::string name = record.name(i).substr(0, index(name_width - 2));
    text += format("  %-*s", name_width, (name + (structure.equations.is_replaced(i) ? "+" : "")).c_str());
    for (const std::string& entry : entries) text += format("%*s", width, entry.c_str());
    text += format("%6d\n", structure.offsets.c[index(i)]);
  }
  text += format("  %-*s", name_width, "d");
  for (int d : structure.offsets.d) text += format("%*d", width, d);
  return text + "\n";
}

std::string block_list(const Structure& structure, const Record& record) {
  std::string text;
  for (int block = 0; block < std::min(structure.blocks.count(), most_blocks); ++block) {
    const auto equations = structure.blocks.equations(block), unknowns = structure.blocks.unknowns(block);
    text +=
        format("  block %d: ", block) + listed(equations, most_states, [&record](int i) { return record.name(i); }) +
        " determine" + (equations.size() == 1 ? "s " : " ") +
        listed(unknowns, most_states, [&structure](int j) { return derivative(j, structure.offsets.d[index(j)]); }) +
        "\n";
  }
  if (structure.blocks.count() > most_blocks) text += format("  ... (%d blocks)\n", structure.blocks.count());
  return text;
}

}  // namespace

std::string structure_report(const Model::Extension& extension, const Record& record) {
  const Structure& structure = *extension.structure;
  const int n = structure.signature.size(), replaced = structure.equations.num_replaced();
  const auto& c = structure.offsets.c;
  std::string text = format(
      "Structure: equations differentiated up to %d times, %d free values; blocks: %d, the largest of %d equations\n",
      *std::max_element(c.begin(), c.end()), structure.offsets.freedom(), structure.blocks.count(),
      structure.blocks.largest());
  if (replaced > 0)
    text += format("  %d equation%s replaced by sums with derivatives of others%s\n", replaced,
                   replaced > 1 ? "s were" : " was", n <= most_equations ? ", marked + below" : "");
  if (n <= most_equations) text += signature_table(structure, record);
  text += block_list(structure, record);
  text += format("  %d equations for %d unknowns and derivatives, %zu entries; %zu in the factors\n", extension.rows,
                 extension.columns, extension.entries, extension.fill);
  const std::span<const int> states(extension.states);
  text += "  states: ";
  text += states.empty() ? "none" : listed(states, most_states, [](int j) { return derivative(j, 0); });
  return text + "\n";
}

}  // namespace sfdae::core
