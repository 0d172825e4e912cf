// How many problems are tried, and which: by environment variables.
//
//   SFDAE_CAMPAIGN_SHARE=1      the full campaign; default 0.02
//   SFDAE_TEST_SCALE=0.05       multiplies that, as in all tests with random problems
//   SFDAE_CAMPAIGN_NUMBER=1234  this problem alone, with the report of the library
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace campaign {

// Numbers of the problems to be tried of `full` ones; at least `least` of them.
std::vector<int> problem_numbers(int full, int least = 1);

// One problem is looked at closely.
bool single_problem();

}  // namespace campaign
