// SPDX-License-Identifier: BSD-3-Clause
#include "model/flat_model.h"

namespace sfdae::cli {

namespace {

std::string located(const std::string& file, Location at, const std::string& text) {
  if (at.line <= 0) return file + ": " + text;
  return file + ":" + std::to_string(at.line) + ":" + std::to_string(at.column) + ": " + text;
}

}  // namespace

ModelError::ModelError(const std::string& file, Location at, const std::string& text)
    : std::runtime_error(located(file, at, text)), at_(at) {}

}  // namespace sfdae::cli
