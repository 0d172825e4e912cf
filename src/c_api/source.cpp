// Source text of models: C API.
// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <string>

#include "c_api/solver.h"
#include "sfdae/expression.h"
#include "solver/solver_source.h"

using namespace sfdae::core;

extern "C" {

int sfdae_export_source(sfdae_solver* solver, int language, const char* name, char* text, size_t length,
                        size_t* needed) {
  return guarded<Text::of_failure>(solver, [&] {
    if (language != SFDAE_SOURCE_C && language != SFDAE_SOURCE_FORTRAN)
      refuse_argument(format("language is %d, none of SFDAE_SOURCE_C, SFDAE_SOURCE_FORTRAN.", language));
    if (name == nullptr) refuse_argument("name is NULL.");
    if (text == nullptr && length > 0) refuse_argument("text is NULL.");
    if (const std::string complaint = complaint_about_name(name); !complaint.empty())
      refuse_argument(complaint + ".");
    const std::string source = source_of(*solver, language == SFDAE_SOURCE_C ? Language::C : Language::Fortran, name);
    if (length > 0) std::snprintf(text, length, "%s", source.c_str());
    if (needed != nullptr) *needed = source.size() + 1;
  });
}

}  // extern "C"
