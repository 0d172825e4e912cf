// Vector loops over arrays of any length and alignment; kernel_loops.h includes this.
// SPDX-License-Identifier: BSD-3-Clause

namespace sfdae::core::kernels {

namespace {

double size_of(double x) { return x < 0.0 ? -x : x; }
double larger_of(double a, double b) { return a > b ? a : b; }

double largest_size(const double* x, int count) {
  // Two maxima: one alone would wait for itself.
  V first = Lanes::zero(), second = first;
  int i = 0;
  for (; i + 2 * width <= count; i += 2 * width) {
    first = Lanes::larger(Lanes::size(Lanes::load_anywhere(x + i)), first);
    second = Lanes::larger(Lanes::size(Lanes::load_anywhere(x + i + width)), second);
  }
  double largest = Lanes::largest(Lanes::larger(first, second));
  for (; i < count; ++i) largest = larger_of(size_of(x[i]), largest);
  return largest;
}

bool all_finite(const double* x, size_t count) {
  Lanes::Carries carries = Lanes::no_carries();
  size_t i = 0;
  for (; i + width <= count; i += width) carries = Lanes::add_carries(x + i, carries);
  double last[width] = {};
  for (int k = 0; i < count; ++i, ++k) last[k] = x[i];
  return !Lanes::has_carry(Lanes::add_carries(last, carries));
}

double scale_entries(double* x, const double* factors, int count) {
  V most = Lanes::zero();
  int i = 0;
  for (; i + width <= count; i += width) {
    const V scaled = Lanes::product(Lanes::load_anywhere(x + i), Lanes::load_anywhere(factors + i));
    Lanes::store_anywhere(x + i, scaled);
    most = Lanes::larger(Lanes::size(scaled), most);
  }
  double largest = Lanes::largest(most);
  for (; i < count; ++i) {
    x[i] *= factors[i];
    largest = larger_of(size_of(x[i]), largest);
  }
  return largest;
}

void raise_sizes(const double* x, double unit, int count, double* sizes) {
  const V units = Lanes::all(unit);
  int i = 0;
  for (; i + width <= count; i += width) {
    const V size = Lanes::product(units, Lanes::size(Lanes::load_anywhere(x + i)));
    Lanes::store_anywhere(sizes + i, Lanes::larger(size, Lanes::load_anywhere(sizes + i)));
  }
  for (; i < count; ++i) sizes[i] = larger_of(unit * size_of(x[i]), sizes[i]);
}

// Products are rounded before they are subtracted: differences that vanish do so with every instruction set.
void subtract(const double* x, double s, const double* y, int count, double* difference) {
  const V factor = Lanes::all(-s);
  int i = 0;
  for (; i + width <= count; i += width)
    Lanes::store_anywhere(difference + i, Lanes::product(Lanes::load_anywhere(y + i), factor));
  for (; i < count; ++i) difference[i] = -s * y[i];
  for (i = 0; i + width <= count; i += width)
    Lanes::store_anywhere(difference + i,
                          Lanes::sum(Lanes::load_anywhere(x + i), Lanes::load_anywhere(difference + i)));
  for (; i < count; ++i) difference[i] = x[i] + difference[i];
}

}  // namespace

}  // namespace sfdae::core::kernels
