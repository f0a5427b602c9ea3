/* Matrices in double: products, points, inverses. */
#include "gl_context.h"
#include "space/matrix.h"
#include "vector.h"

#include <float.h>
#include <string.h>

static pni_matrix random_matrix(uint64_t *seed) {
  pni_matrix a;
  for (int i = 0; i < 16; i++) a.m[i] = random_in(seed, -1, 1);
  return a;
}

static double norm(const pni_matrix *a) { /* the largest row sum */
  double largest = 0;
  for (int r = 0; r < 4; r++) {
    double sum = 0;
    for (int c = 0; c < 4; c++) sum += fabs(a->m[4 * c + r]);
    largest = fmax(largest, sum);
  }
  return largest;
}

/* Gauss-Jordan with pivoting leaves a residual |a * inverse - 1| of some rounding units times the condition number;
 * growth of the pivots is below 8 for 4 x 4, and there are 4 steps of 2 roundings. */
static double residual_bound(const pni_matrix *a, const pni_matrix *inverse) {
  return 8 * 8 * DBL_EPSILON * norm(a) * norm(inverse);
}

static void assert_inverse(const pni_matrix *a) {
  pni_matrix inverse;
  assert_true(pni_matrix_invert(a, &inverse));
  pni_matrix products[2] = {pni_matrix_multiply(a, &inverse), pni_matrix_multiply(&inverse, a)};
  double bound = residual_bound(a, &inverse);
  for (int i = 0; i < 32; i++) assert_true(fabs(products[i / 16].m[i % 16] - (i % 16 % 5 == 0)) <= bound);
}

static void test_inverse_times_itself(void **state) {
  (void)state;
  uint64_t seed = 1;
  for (int i = 0; i < 2000; i++) {
    pni_matrix a = random_matrix(&seed);
    assert_inverse(&a);
  }
}

/* diag(row) a diag(column) has the inverse diag(1/column) inverse(a) diag(1/row), exactly when the factors are powers
 * of two. Other factors lead to other pivots and other rounding, so what is bounded is the residual of the inverse with
 * the factors taken out again; scaling rows and columns to a largest entry of 1 changes the condition by less than its
 * own square. */
static void test_badly_scaled(void **state) {
  (void)state;
  uint64_t seed = 2;
  for (int i = 0; i < 500; i++) {
    pni_matrix a = random_matrix(&seed), scaled = a, plain, inverse;
    double row[4], column[4];
    for (int k = 0; k < 4; k++) {
      row[k] = ldexp(1, (int)random_in(&seed, -60, 60));
      column[k] = ldexp(1, (int)random_in(&seed, -60, 60));
    }
    for (int k = 0; k < 16; k++) scaled.m[k] *= row[k % 4] * column[k / 4];
    assert_true(pni_matrix_invert(&a, &plain));
    assert_true(pni_matrix_invert(&scaled, &inverse));
    for (int k = 0; k < 16; k++) inverse.m[k] *= column[k % 4] * row[k / 4];
    pni_matrix product = pni_matrix_multiply(&inverse, &a);
    double bound = residual_bound(&a, &plain) * norm(&a) * norm(&plain);
    for (int k = 0; k < 16; k++) assert_true(fabs(product.m[k] - (k % 5 == 0)) <= bound);
  }
}

/* A camera that looks at a planet from a metre away, in metres. */
static void test_far_perspective(void **state) {
  (void)state;
  double near = 1e-3, far = 1e9;
  pni_matrix a = {
      {1.5, 0, 0, 0, 0, 2, 0, 0, 0, 0, (near + far) / (near - far), -1, 0, 0, 2 * near * far / (near - far), 0}};
  assert_inverse(&a);
}

static void test_singular(void **state) {
  (void)state;
  pni_matrix a, out, zero = {{0}};
  assert_false(pni_matrix_invert(&zero, &out));
  for (int i = 0; i < 4; i++) { /* a row of zeros, a column of zeros, two equal rows, two equal columns */
    a = pni_matrix_identity();
    a.m[5 * i] = 0;
    assert_false(pni_matrix_invert(&a, &out));
    a = (pni_matrix){{1, 2, 3, 4, 0, 1, 5, 6, 0, 0, 1, 7, 0, 0, 0, 1}};
    for (int k = 0; k < 4; k++) a.m[4 * k + (i + 1) % 4] = a.m[4 * k + i];
    assert_false(pni_matrix_invert(&a, &out));
    a = (pni_matrix){{1, 2, 3, 4, 0, 1, 5, 6, 0, 0, 1, 7, 0, 0, 0, 1}};
    memcpy(a.m + 4 * ((i + 1) % 4), a.m + 4 * i, 4 * sizeof *a.m);
    assert_false(pni_matrix_invert(&a, &out));
  }
}

/* Rounding leaves something tiny where a pivot should be zero; an inverse made of it would be noise. */
static void test_nearly_singular(void **state) {
  (void)state;
  uint64_t seed = 3;
  for (int i = 0; i < 500; i++) {
    pni_matrix a = random_matrix(&seed), out;
    double share = random_in(&seed, 0.1, 0.9), row = ldexp(1, (int)random_in(&seed, -60, 60));
    double largest = 0;
    for (int c = 0; c < 4; c++) {
      a.m[4 * c + 3] = share * a.m[4 * c] + (1 - share) * a.m[4 * c + 1];
      largest = fmax(largest, fabs(a.m[4 * c + 3]));
      a.m[4 * c + 3] *= row;
    }
    if (largest < 0.25) continue; /* terms that cancel make the row itself noise */
    assert_false(pni_matrix_invert(&a, &out));
  }
}

static void test_not_finite(void **state) {
  (void)state;
  const double bad[] = {NAN, INFINITY, -INFINITY};
  for (int i = 0; i < 16; i++)
    for (int k = 0; k < 3; k++) {
      pni_matrix a = pni_matrix_identity(), out;
      a.m[i] = bad[k];
      assert_false(pni_matrix_invert(&a, &out));
    }
  float values[4] = {0, 1, 2, 3};
  assert_true(pni_floats_finite(values, 4));
  values[3] = NAN;
  assert_true(pni_floats_finite(values, 3));
  assert_false(pni_floats_finite(values, 4));
}

static void test_apply(void **state) {
  (void)state;
  /* 90 degrees about z, then 2 along x: columns, and b first in a product a * b. */
  const pni_matrix turn = {{0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
  const pni_matrix move = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 2, 0, 0, 1}};
  pni_matrix both = pni_matrix_multiply(&move, &turn);
  double p[3] = {3, 4, 5}, q[4] = {3, 4, 5, 0}, want[3] = {-2, 3, 5}, direction[4] = {-4, 3, 5, 0};
  pni_matrix_point(&both, p, p); /* in place */
  assert_memory_equal(p, want, sizeof want);
  pni_matrix_apply(&both, q, q);
  assert_memory_equal(q, direction, sizeof direction);
  float floats[16];
  pni_matrix_to_floats(&both, floats);
  pni_matrix back = pni_matrix_from_floats(floats);
  assert_memory_equal(&back, &both, sizeof both);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_inverse_times_itself),
      cmocka_unit_test(test_badly_scaled),
      cmocka_unit_test(test_far_perspective),
      cmocka_unit_test(test_singular),
      cmocka_unit_test(test_nearly_singular),
      cmocka_unit_test(test_not_finite),
      cmocka_unit_test(test_apply),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
