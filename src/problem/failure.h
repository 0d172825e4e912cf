// The one exception inside: something that the user of the library can cause, with its public status.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <exception>
#include <string>
#include <utility>

#include "linalg/format.h"
#include "sfdae/sfdae.h"

namespace sfdae::core {

class Failure : public std::exception {
 public:
  Failure(int status, std::string message) : status_(status), message_(std::move(message)) {}
  int status() const { return status_; }
  const char* what() const noexcept override { return message_.c_str(); }

 private:
  int status_;
  std::string message_;
};

// The user wants an end: no other way to a result is to be tried.
inline bool is_stop(const Failure& failure) {
  return failure.status() == SFDAE_STOPPED || failure.status() == SFDAE_CALLBACK_STOPPED;
}

}  // namespace sfdae::core
