// Source text of an exported system: C99, or a module of Fortran 2008, that needs nothing else.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "expression/equation_names.h"
#include "expression/source_code.h"
#include "extension/exported_system.h"
#include "reduction/index_analysis.h"

namespace sfdae::core {

struct SourceRequest {
  Language language;
  std::string name;             // prefix of the names of functions
  CharacteristicValues values;  // of the equations as they are recorded
  EquationNames equation_names;
};

// Reason why a name is not allowed; "" if it is.
std::string complaint_about_name(const std::string& name);

std::string source_of(const ExportedSystem& system, const SourceRequest& request);

}  // namespace sfdae::core
