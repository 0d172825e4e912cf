/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Solvers that exist. A run may be within a function that another run calls, so there can be several. If Octave leaves
 * a call by force, for example when memory ends, its solver stays behind and is destroyed at the next call. */
#include <string.h>

#include "sfdae_mex.h"

#define MAX_SOLVERS 64

static struct {
  sfdae_solver* solver;
  calls state; /* of its problem */
} open_solvers[MAX_SOLVERS];
static int num_open = 0;

int open_solver(problem* p, const sfdae_options* options, sfdae_solver** solver) {
  int status;
  *solver = NULL;
  close_abandoned_solvers();
  if (num_open == MAX_SOLVERS)
    refuse("%d runs are within each other: a function that sfdae calls solves itself", num_open);
  p->calls = &open_solvers[num_open].state;
  memset(p->calls, 0, sizeof *p->calls);
  status = create_solver(p, options, solver);
  if (status < 0) return status;
  open_solvers[num_open++].solver = *solver;
  if (!mexIsLocked()) mexLock(); /* functions of the user may clear functions */
  begin_interruptible(*solver);
  return status;
}

void close_solver(sfdae_solver** solver) {
  if (*solver == NULL) return;
  end_interruptible();
  if (num_open > 0) --num_open;
  if (num_open == 0 && mexIsLocked()) mexUnlock();
  sfdae_destroy(solver);
}

/* A solver whose function is running has called this function: it is in use, and so are those before it. */
void close_abandoned_solvers(void) {
  while (num_open > 0 && !open_solvers[num_open - 1].state.is_calling) {
    sfdae_solver* solver = open_solvers[num_open - 1].solver;
    close_solver(&solver);
  }
}
