// Products of matrices of moderate size; kernel_loops.h includes this.
//
// A tile of C, up to three vectors high and up to eight columns wide, stays in registers while the inner dimension is
// traversed in order, as in BLAS: below a few hundred it matters most that nothing is copied first.
// SPDX-License-Identifier: BSD-3-Clause

namespace sfdae::core::kernels {

namespace {

// Operands of a tile: rows of op(A), column after column, and columns of op(B), entry (k, j) at k b_down + j b_right.
struct Tile {
  int inner;
  const double* a;
  ptrdiff_t lda;
  const double* b;
  ptrdiff_t b_down, b_right;
  double alpha, beta;
  double* c;
  ptrdiff_t ldc;
  int rows;  // of the last vector
};

// alpha sum + beta C. Sums of BLAS begin with a zero, too: otherwise zeros could differ in sign.
inline V updated(const Tile& of, V sum, V before) {
  const V change = Lanes::product(Lanes::all(of.alpha), sum);
  if (of.beta == 0.0) return Lanes::sum(Lanes::zero(), change);
  return Lanes::sum(of.beta == 1.0 ? before : Lanes::product(Lanes::all(of.beta), before), change);
}

// is_whole: all rows of the last vector belong to C.
template <int vectors, int cols, bool is_whole>
inline void multiply_tile(const Tile& of) {
  V sums[cols][vectors];
#pragma GCC unroll 8
  for (int j = 0; j < cols; ++j) {
#pragma GCC unroll 8
    for (int v = 0; v < vectors; ++v) sums[j][v] = Lanes::zero();
  }
  const double *a = of.a, *b = of.b;
  for (int k = 0; k < of.inner; ++k, a += of.lda, b += of.b_down) {
    V x[vectors];
#pragma GCC unroll 8
    for (int v = 0; v < vectors; ++v)
      x[v] = is_whole || v + 1 < vectors ? Lanes::load_anywhere(a + v * width)
                                         : Lanes::load_first(a + v * width, of.rows);
#pragma GCC unroll 8
    for (int j = 0; j < cols; ++j) {
      const V factor = Lanes::all(b[j * of.b_right]);
#pragma GCC unroll 8
      for (int v = 0; v < vectors; ++v) sums[j][v] = Lanes::add_product(x[v], factor, sums[j][v]);
    }
  }
  const bool reads = of.beta != 0.0;
#pragma GCC unroll 8
  for (int j = 0; j < cols; ++j) {
#pragma GCC unroll 8
    for (int v = 0; v < vectors; ++v) {
      double* c = of.c + j * of.ldc + v * width;
      if (is_whole || v + 1 < vectors) {
        const V before = reads ? Lanes::load_anywhere(c) : Lanes::zero();
        Lanes::store_anywhere(c, updated(of, sums[j][v], before));
      } else {
        const V before = reads ? Lanes::load_first(c, of.rows) : Lanes::zero();
        Lanes::store_first(c, of.rows, updated(of, sums[j][v], before));
      }
    }
  }
}

template <int vectors, bool is_whole>
inline void multiply_columns(Tile of, int cols) {
  // Single vectors need more columns at once, as sums have to wait for themselves.
  constexpr int most = vectors == 1 ? 8 : 4;
  const auto go_on = [&of](int done) {
    of.b += done * of.b_right;
    of.c += done * of.ldc;
  };
  for (; cols >= most && cols != most + 1; cols -= most, go_on(most)) multiply_tile<vectors, most, is_whole>(of);
  if (vectors == 1 && cols >= 4 && cols != 5) {
    multiply_tile<vectors, 4, is_whole>(of);
    go_on(4);
    cols -= 4;
  }
  for (; cols >= 3; cols -= 3, go_on(3)) multiply_tile<vectors, 3, is_whole>(of);
  if (cols == 2) multiply_tile<vectors, 2, is_whole>(of);
  if (cols == 1) multiply_tile<vectors, 1, is_whole>(of);
}

template <int vectors>
inline void multiply_rows(const Tile& of, int cols) {
  if (of.rows == width) multiply_columns<vectors, true>(of, cols);
  else multiply_columns<vectors, false>(of, cols);
}

// Rows of A^T, A having `inner` rows and as many columns as there are rows of the tile: column after column, ld apart.
void transpose_rows(const double* a, ptrdiff_t lda, int rows, int inner, double* to, int ld) {
  int i = 0;
  for (; i + 4 <= rows; i += 4, a += 4 * lda) {
    int k = 0;
    for (; k + 4 <= inner; k += 4) Lanes::transpose_four(a + k, lda, to + i + k * ld, ld);
    for (; k < inner; ++k)
      for (int p = 0; p < 4; ++p) to[i + p + k * ld] = a[k + p * lda];
  }
  for (; i < rows; ++i, a += lda)
    for (int k = 0; k < inner; ++k) to[i + k * ld] = a[k];
}

void multiply(const Product& of) {
  constexpr int most_rows = 3 * width;
  alignas(64) double transposed[most_rows * most_transposed];
  Tile tile{of.inner,
            nullptr,
            of.a.ld,
            of.b.data,
            of.b.is_transposed ? of.b.ld : 1,
            of.b.is_transposed ? 1 : of.b.ld,
            of.alpha,
            of.beta,
            nullptr,
            of.ldc,
            0};
  for (int first = 0; first < of.rows;) {
    const int left = of.rows - first;
    // Four vectors are two and two, not three and one.
    const int most = left > 3 * width && left <= 4 * width ? 2 * width : most_rows;
    const int rows = left < most ? left : most;
    tile.c = of.c + first;
    tile.rows = (rows - 1) % width + 1;
    if (of.a.is_transposed) {
      transpose_rows(of.a.data + first * of.a.ld, of.a.ld, rows, of.inner, transposed, most_rows);
      tile.a = transposed;
      tile.lda = most_rows;
    } else {
      tile.a = of.a.data + first;
    }
    if (rows > 2 * width) multiply_rows<3>(tile, of.cols);
    else if (rows > width) multiply_rows<2>(tile, of.cols);
    else multiply_rows<1>(tile, of.cols);
    first += rows;
  }
}

}  // namespace

}  // namespace sfdae::core::kernels
