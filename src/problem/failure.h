// The only internal exception: a failure that the user of the library can cause, with its public status.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <exception>
#include <string>
#include <utility>

#include "linalg/format.h"
#include "sfdae/sfdae.h"

namespace sfdae::core {

// Returns whether neither another point nor another method can help.
constexpr bool ends_everything(int status) {
  return status == SFDAE_STOPPED || status == SFDAE_CALLBACK_STOPPED || status == SFDAE_WRONG_PATTERN ||
         status == SFDAE_WRONG_DERIVATIVES;
}

class Failure : public std::exception {
 public:
  Failure(int status, std::string message) : status_(status), message_(std::move(message)) {}
  int status() const { return status_; }
  const char* what() const noexcept override { return message_.c_str(); }

 private:
  int status_;
  std::string message_;
};

}  // namespace sfdae::core
