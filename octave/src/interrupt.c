/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Ctrl-C while a solver runs. The signal asks the solver to stop at its next step or callback, and the run returns what
 * it has reached. Octave's own reaction, an exception within the function that runs, would leave the library by force;
 * a second Ctrl-C causes it, for functions that do not return.
 *
 * Octave blocks SIGINT in its main thread and waits for it in another one. It is unblocked here while a solver runs. */
#include <signal.h>

#include "sfdae_mex.h"

#define MAX_DEPTH 32 /* of runs within functions of other runs; deeper ones do not react */

static sfdae_solver* volatile running[MAX_DEPTH];
static volatile int depth = 0;
static volatile sig_atomic_t num_signals = 0;

#if defined(_WIN32)
static void (*previous)(int);
#else
static struct sigaction previous;
static sigset_t previous_mask;
#endif

static void request_stops(void) {
  int i;
  for (i = 0; i < depth && i < MAX_DEPTH; ++i) sfdae_request_stop(running[i]);
}

static void on_interrupt(int number) {
  ++num_signals;
  if (num_signals == 1) {
    request_stops();
    return;
  }
#if defined(_WIN32)
  if (previous != SIG_DFL && previous != SIG_IGN) previous(number);
#else
  if (!(previous.sa_flags & SA_SIGINFO) && previous.sa_handler != SIG_DFL && previous.sa_handler != SIG_IGN) {
    previous.sa_handler(number);
  }
#endif
}

void begin_interruptible(sfdae_solver* solver) {
  if (depth < MAX_DEPTH) running[depth] = solver;
  if (depth++ > 0) return;
  num_signals = 0;
#if defined(_WIN32)
  previous = signal(SIGINT, on_interrupt);
#else
  {
    struct sigaction action;
    sigset_t mask;
    action.sa_handler = on_interrupt;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, &previous);
    sigemptyset(&mask);
    sigaddset(&mask, SIGINT);
    pthread_sigmask(SIG_UNBLOCK, &mask, &previous_mask);
  }
#endif
}

int was_interrupted(void) { return num_signals > 0; }

int end_interruptible(void) {
  if (depth > 0 && --depth == 0) {
#if defined(_WIN32)
    signal(SIGINT, previous);
#else
    pthread_sigmask(SIG_SETMASK, &previous_mask, NULL);
    sigaction(SIGINT, &previous, NULL);
#endif
  }
  return was_interrupted();
}
