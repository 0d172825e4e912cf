/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Operations of formulas: one table for recording and replaying. */
#ifndef SFDAE_OPERATIONS_H
#define SFDAE_OPERATIONS_H

#include <sfdae/expression.h>

/* Operations whose operands are not nodes only, then those that sfdae_operations names. */
enum { OP_DEAD, OP_VARIABLE, OP_NUMBER, OP_PARAMETER, OP_TABLE, OP_NEGATE, OP_ADD, OP_SUBTRACT, OP_MULTIPLY };

typedef struct sfdae_operation {
  const char* name;
  int num_operands; /**< that are nodes */
  sfdae_expression (*unary)(sfdae_expression);
  sfdae_expression (*binary)(sfdae_expression, sfdae_expression);
  sfdae_expression (*ternary)(sfdae_expression, sfdae_expression, sfdae_expression);
} sfdae_operation;

extern const sfdae_operation sfdae_operations[];
extern const int sfdae_num_operations;

/** The number of an operation, -1 if there is none of this name. */
int find_operation(const char* name);

#endif
