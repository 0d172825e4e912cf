// SPDX-License-Identifier: BSD-3-Clause
#include "modelica/read_model.h"

namespace sfdae::cli {

FlatModel read_model(const std::string&, const std::string& file) { throw ModelError(file, {}, "cannot be read"); }

FlatModel read_model_file(const std::string& path) { return read_model("", path); }

}  // namespace sfdae::cli
