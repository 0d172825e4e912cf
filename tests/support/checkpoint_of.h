// SPDX-License-Identifier: BSD-3-Clause
#ifndef SFDAE_TESTS_CHECKPOINT_OF_H
#define SFDAE_TESTS_CHECKPOINT_OF_H

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "sfdae/sfdae.h"

namespace sfdae_test {

inline std::vector<double> checkpoint_of(sfdae_solver* solver) {
  std::size_t length = 0;
  EXPECT_EQ(sfdae_get_checkpoint_length(solver, &length), SFDAE_OK) << sfdae_message(solver);
  std::vector<double> checkpoint(length);
  EXPECT_EQ(sfdae_save_checkpoint(solver, checkpoint.data(), length), SFDAE_OK) << sfdae_message(solver);
  return checkpoint;
}

}  // namespace sfdae_test

#endif
