// Instruction sets with code of their own.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace sfdae::core {

enum class InstructionSet { portable, avx2, avx512 };

// True if the processor has the set: AVX2 with FMA; AVX-512 F and DQ in addition.
bool has_instruction_set(InstructionSet set);

// The best that the processor has, or less if the environment variable SFDAE_INSTRUCTIONS says so: portable, avx2.
InstructionSet best_instruction_set();

}  // namespace sfdae::core
