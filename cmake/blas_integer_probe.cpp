// Returns 0 if the integers of BLAS have 32 bits.
//
// n stands in memory as the 32-bit integers 3, -1. Read with 32 bits it is 3, and the largest of three entries is
// the third. Read with 64 bits (little endian) it is negative, and isamax returns 0.

#include <cstdint>

extern "C" {
std::int32_t isamax_(const void* n, const float* x, const void* incx);
void dgetrf_(const void* m, const void* n, double* a, const void* lda, void* ipiv, void* info);
}

int main() {
  alignas(8) const std::int32_t n[2] = {3, -1};
  alignas(8) const std::int32_t one[2] = {1, 0};
  const float x[3] = {1.0F, 2.0F, 3.0F};
  if (isamax_(n, x, one) != 3) return 1;

  double a = 2.0;
  alignas(8) std::int32_t pivot[2] = {0, 0};
  alignas(8) std::int32_t info[2] = {-1, 0};
  dgetrf_(one, one, &a, one, pivot, info);
  return info[0] == 0 && pivot[0] == 1 ? 0 : 2;
}
