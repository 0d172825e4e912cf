/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Checked conversion of arguments. Memory is that of mxMalloc, which Octave and MATLAB free after each call. */
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "sfdae_mex.h"

void refuse(const char* format, ...) {
  char text[400];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  mexErrMsgIdAndTxt("sfdae:illegal_argument", "%s", text);
}

const mxArray* field_of(const mxArray* from, const char* name) {
  const mxArray* value;
  if (from == NULL || !mxIsStruct(from) || mxGetNumberOfElements(from) != 1) refuse("sfdae_mex needs a struct");
  value = mxGetField(from, 0, name);
  return value == NULL || mxIsEmpty(value) ? NULL : value;
}

static const mxArray* real_field(const mxArray* from, const char* name) {
  const mxArray* value = field_of(from, name);
  if (value != NULL && (!mxIsDouble(value) || mxIsComplex(value) || mxIsSparse(value))) {
    refuse("%s has to be real and of class double, not of class %s", name, mxGetClassName(value));
  }
  return value;
}

size_t length_of(const mxArray* from, const char* name) {
  const mxArray* value = field_of(from, name);
  return value == NULL ? 0 : (size_t)mxGetNumberOfElements(value);
}

double number_in(const mxArray* from, const char* name, double missing) {
  const mxArray* value = real_field(from, name);
  if (value == NULL) return missing;
  if (mxGetNumberOfElements(value) != 1) {
    refuse("%s has %lu elements; it has to be one number", name, (unsigned long)mxGetNumberOfElements(value));
  }
  return mxGetPr(value)[0];
}

/* A whole number that fits into an int. */
static int as_integer(double value, const char* name) {
  if (!(value >= INT_MIN && value <= INT_MAX) || floor(value) != value) {
    refuse("%s contains %g; it has to be a whole number", name, value);
  }
  return (int)value;
}

long integer_in(const mxArray* from, const char* name, long missing) {
  return as_integer(number_in(from, name, (double)missing), name);
}

double* numbers_in(const mxArray* from, const char* name, size_t count) {
  const mxArray* value = real_field(from, name);
  double* copy;
  if (value == NULL) return NULL;
  if (mxGetNumberOfElements(value) != count) {
    refuse("%s has %lu elements; %lu are needed", name, (unsigned long)mxGetNumberOfElements(value),
           (unsigned long)count);
  }
  copy = (double*)mxMalloc((count + 1) * sizeof(double));
  memcpy(copy, mxGetPr(value), count * sizeof(double));
  return copy;
}

int* integers_in(const mxArray* from, const char* name, size_t count, int offset) {
  const double* numbers = numbers_in(from, name, count);
  int* copy;
  size_t i;
  if (numbers == NULL) return NULL;
  copy = (int*)mxMalloc((count + 1) * sizeof(int));
  for (i = 0; i < count; ++i) copy[i] = as_integer(numbers[i] - offset, name);
  return copy;
}

const mxArray* handle_in(const mxArray* from, const char* name) {
  const mxArray* value = field_of(from, name);
  if (value != NULL && !mxIsClass(value, "function_handle")) refuse("%s has to be a function handle", name);
  return value;
}

static char* as_text(const mxArray* value, const char* name) {
  char* text = value != NULL && mxIsChar(value) ? mxArrayToString(value) : NULL;
  if (text == NULL) refuse("%s has to be text", name);
  return text;
}

char* text_in(const mxArray* from, const char* name) {
  const mxArray* value = field_of(from, name);
  return value == NULL ? (char*)mxCalloc(1, 1) : as_text(value, name);
}

const char** texts_in(const mxArray* from, const char* name, int* count) {
  const mxArray* value = field_of(from, name);
  const char** texts;
  int i;
  *count = 0;
  if (value == NULL) return NULL;
  if (!mxIsCell(value)) refuse("%s has to be a cell array of texts", name);
  *count = as_integer((double)mxGetNumberOfElements(value), name);
  texts = (const char**)mxMalloc(((size_t)*count + 1) * sizeof(char*));
  for (i = 0; i < *count; ++i) {
    const mxArray* text = mxGetCell(value, i);
    texts[i] = text == NULL || mxIsEmpty(text) ? "" : as_text(text, name);
  }
  return texts;
}
