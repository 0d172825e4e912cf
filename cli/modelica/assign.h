// Assignment to parts of values.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "modelica/elaboration.h"

namespace sfdae::cli {

// The name at the beginning of 'a'[1].'b'; fails if there is none.
const syntax::Expression& name_of(const Elaboration& e, const syntax::Expression& left);

// Sets the part of `whole` that `left` selects to `value`, if `active` holds.
void assign_part(Elaboration& e, const Environment& in, Value& whole, const syntax::Expression& left,
                 const Value& value, const Expression& active);

}  // namespace sfdae::cli
