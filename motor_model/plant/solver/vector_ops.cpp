#include "motor_model/plant/solver/vector_ops.hpp"

#include <nvector/nvector_serial.h>

#include <cmath>
#include <cstring>

#include "sim/base/check.hpp"

namespace vinv::plant {

namespace {

// z may be any of the inputs. The sum is built aside, so that the compiler need not fear that it is.
int linear_combination(int count, realtype* c, N_Vector* x, N_Vector z) {
  const auto n = static_cast<int>(NV_LENGTH_S(z));
  double sum[kLongestVector];
  const double* x0 = NV_DATA_S(x[0]);
  const double c0 = c[0];
  int next = 1;
  if (count >= 4) {
    const double *x1 = NV_DATA_S(x[1]), *x2 = NV_DATA_S(x[2]), *x3 = NV_DATA_S(x[3]);
    const double c1 = c[1], c2 = c[2], c3 = c[3];
    for (int i = 0; i < n; ++i) sum[i] = c0 * x0[i] + c1 * x1[i] + c2 * x2[i] + c3 * x3[i];
    next = 4;
  } else if (count == 3) {
    const double *x1 = NV_DATA_S(x[1]), *x2 = NV_DATA_S(x[2]);
    const double c1 = c[1], c2 = c[2];
    for (int i = 0; i < n; ++i) sum[i] = c0 * x0[i] + c1 * x1[i] + c2 * x2[i];
    next = 3;
  } else if (count == 2) {
    const double* x1 = NV_DATA_S(x[1]);
    const double c1 = c[1];
    for (int i = 0; i < n; ++i) sum[i] = c0 * x0[i] + c1 * x1[i];
    next = 2;
  } else {
    for (int i = 0; i < n; ++i) sum[i] = c0 * x0[i];
  }
  for (; next < count; ++next) {
    const double* xn = NV_DATA_S(x[next]);
    const double cn = c[next];
    for (int i = 0; i < n; ++i) sum[i] += cn * xn[i];
  }
  std::memcpy(NV_DATA_S(z), sum, static_cast<std::size_t>(n) * sizeof(double));
  return 0;
}

void linear_sum(realtype a, N_Vector x, realtype b, N_Vector y, N_Vector z) {
  realtype c[2] = {a, b};
  N_Vector parts[2] = {x, y};
  linear_combination(2, c, parts, z);
}

void scale(realtype c, N_Vector x, N_Vector z) {
  const auto n = static_cast<int>(NV_LENGTH_S(z));
  if (c == 1) {
    if (x != z) std::memcpy(NV_DATA_S(z), NV_DATA_S(x), static_cast<std::size_t>(n) * sizeof(double));
    return;
  }
  linear_combination(1, &c, &x, z);
}

realtype wrms_norm(N_Vector x, N_Vector w) {
  const auto n = static_cast<int>(NV_LENGTH_S(x));
  const double *xs = NV_DATA_S(x), *ws = NV_DATA_S(w);
  double even = 0, odd = 0;
  int i = 0;
  for (; i + 1 < n; i += 2) {
    const double a = xs[i] * ws[i], b = xs[i + 1] * ws[i + 1];
    even += a * a;
    odd += b * b;
  }
  if (i < n) even += xs[i] * ws[i] * xs[i] * ws[i];
  return std::sqrt((even + odd) / n);
}

}  // namespace

void use_short_vector_operations(_generic_N_Vector* v) {
  VINV_CHECK(NV_LENGTH_S(v) <= kLongestVector);
  v->ops->nvlinearcombination = linear_combination;
  v->ops->nvlinearsum = linear_sum;
  v->ops->nvscale = scale;
  v->ops->nvwrmsnorm = wrms_norm;
}

}  // namespace vinv::plant
