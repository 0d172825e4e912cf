// One declared name of a model and the variables created for it; parts of Symbols.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modelica/symbols.h"

namespace sfdae::cli {

// The scalars [first, first + count) of the model's variables, with the modifications that give them attributes.
struct Symbols::Leaf {
  int first = 0;
  std::vector<int> dims;        // of the declaration itself
  std::vector<int> outer_dims;  // of the enclosing arrays of records
  size_t outer_position = 0;    // index of the enclosing record in those
  std::vector<std::pair<const std::vector<syntax::Modification>*, bool>> modifications;  // with: of the package
};

// The binding `= expression` of one declaration or modification.
struct Symbols::Binding {
  Value target;  // scalars: variables
  const syntax::Expression* expression = nullptr;
  bool is_of_package = false;   // written in a record or type: only constants are visible
  std::vector<int> outer_dims;  // as in Leaf
  size_t outer_position = 0;
  Location at;
};

// Arguments for the instantiation of one declaration, or of a field of a record.
struct Symbols::Instance {
  std::string name;
  const syntax::Declaration* declaration = nullptr;
  bool is_field = false;                                   // of a record: what the declaration says is of the package
  bool has_binding = false;                                // an enclosing record has one
  std::vector<const syntax::Modification*> modifications;  // from outside, for this field
  std::vector<int> outer_dims;
  size_t outer_position = 0;
  int depth = 0;
};

struct Symbols::Symbol {
  const syntax::Declaration* declaration = nullptr;
  bool is_global = false;
  bool has_texts = false;
  Stage declaring = Stage::none, attributes = Stage::none, binding_stage = Stage::none;
  std::shared_ptr<Value> value;
  std::vector<Leaf> leaves;
  std::vector<Binding> bindings;

  bool is_constant() const { return is_global || declaration->prefix == syntax::Prefix::constant; }
};

}  // namespace sfdae::cli
