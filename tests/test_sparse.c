/* Sparse stiffness matrices: factorised, updated and solved, against plain matrices. */
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_math.h>

#include "sparse/sparse.h"
#include "tests/check.h"
#include "tests/numbers.h"

enum { CHAIN = 40 };

/* A chain of disks along y, held at its ends, with springs of stiffness `along`; all held with stiffness
 * `held`, the first one with `first` more in x. */
static void assemble_chain(rp_stiffness *m, const rp_pair *bonds, const double stiffness[3])
{
    const double along = stiffness[0], held = stiffness[1], first = stiffness[2];
    rp_stiffness_clear(m, held);
    for (size_t k = 0; k + 1 < CHAIN; k++) rp_stiffness_add_bond(m, k, bonds[k], 0, 0, along);
    rp_stiffness_add_site(m, 0, first, 0, along);
    rp_stiffness_add_site(m, CHAIN - 1, 0, 0, along);
}

/* Solution with the factor of another matrix: at once if the matrices differ by a scale only; to a tenth if
 * they are close; none if they are far apart, or if the matrix is not positive. */
static void near_factor(void)
{
    rp_pair bonds[CHAIN - 1];
    double load[2 * CHAIN] = {3}, x[2 * CHAIN]; /* the first unknown counts too */
    for (uint32_t k = 0; k + 1 < CHAIN; k++) bonds[k] = (rp_pair){k, k + 1};
    for (size_t i = 0; i < CHAIN; i++) load[2 * i + 1] = i % 2 == 0;
    rp_stiffness *m = NULL;
    rp_pivots pivots;
    bool found;
    CHECK_OK(rp_stiffness_create(CHAIN, CHAIN - 1, bonds, false, &m));
    for (int way = 0; way < 4; way++) {
        static const double from[][3] = {{2, 0.5, 2}, {1, 0.4, 1}, {0, 1, 0}, {1, 1.5, 0}};
        static const double to[][3] = {{1, 0.25, 1}, {1, 0.02, 20}, {1, 1e-4, 0}, {1, -3, 0}};
        assemble_chain(m, bonds, from[way]);
        CHECK_OK(rp_stiffness_factorise(m, &pivots));
        assemble_chain(m, bonds, to[way]);
        CHECK_OK(rp_stiffness_solve_near(m, load, x, &found));
        CU_ASSERT(found == (way < 2));
        double left = 0, all = 0;
        for (size_t i = 0; found && i < CHAIN; i++) {
            const double below = i > 0 ? x[2 * i - 1] : 0, above = i + 1 < CHAIN ? x[2 * i + 3] : 0;
            const double force = to[way][1] * x[2 * i + 1] + to[way][0] * (2 * x[2 * i + 1] - below - above);
            const double across = (to[way][1] + (i == 0 ? to[way][2] : 0)) * x[2 * i];
            left += gsl_pow_2(across - load[2 * i]) + gsl_pow_2(force - load[2 * i + 1]);
            all += gsl_pow_2(load[2 * i]) + gsl_pow_2(load[2 * i + 1]);
        }
        CU_ASSERT(left <= (way == 0 ? 1e-24 : 0.01) * all);
    }
    rp_stiffness_free(m);
}

/* A stiffness of so many disks as a plain matrix. */
enum { DENSE = 10 };
typedef double dense_matrix[2 * DENSE][2 * DENSE];

/* Add `sign` times [xx xy; xy yy] of a spring between disks a and b, or with a = b to the ground. */
static void add_dense(dense_matrix K, rp_pair ends, double sign, double xx, double xy, double yy)
{
    const double block[2][2] = {{xx, xy}, {xy, yy}};
    for (int r = 0; r < 2; r++)
        for (int c = 0; c < 2; c++) {
            K[2 * ends.a + r][2 * ends.a + c] += sign * block[r][c];
            if (ends.a == ends.b) continue;
            K[2 * ends.b + r][2 * ends.b + c] += sign * block[r][c];
            K[2 * ends.a + r][2 * ends.b + c] -= sign * block[r][c];
            K[2 * ends.b + r][2 * ends.a + c] -= sign * block[r][c];
        }
}

/* The matrix times the solution is the load; as many pivots are negative as eigenvalues. */
static void check_solution(rp_stiffness *m, const rp_pivots *pivots, size_t n, dense_matrix K, gsl_rng *rng)
{
    double b[2 * DENSE], x[2 * DENSE];
    gsl_matrix *A = gsl_matrix_alloc(2 * n, 2 * n);
    gsl_vector *values = gsl_vector_alloc(2 * n);
    gsl_eigen_symm_workspace *work = gsl_eigen_symm_alloc(2 * n);
    for (size_t i = 0; i < 2 * n; i++)
        for (size_t j = 0; j < 2 * n; j++) gsl_matrix_set(A, i, j, K[i][j]);
    gsl_eigen_symm(A, values, work);
    size_t negative = 0;
    double least = INFINITY;
    for (size_t i = 0; i < 2 * n; i++) {
        negative += gsl_vector_get(values, i) < 0;
        least = fmin(least, fabs(gsl_vector_get(values, i)));
    }
    CU_ASSERT_EQUAL(pivots->negative, negative);
    for (size_t i = 0; i < 2 * n; i++) b[i] = gsl_rng_uniform(rng) - 0.5;
    CHECK_OK(rp_stiffness_solve(m, b, x));
    for (size_t i = 0; i < 2 * n; i++) {
        double sum = -b[i];
        for (size_t j = 0; j < 2 * n; j++) sum += K[i][j] * x[j];
        CHECK_NEAR(sum, 0, 1e-10 / least); /* without pivoting, of numbers up to 20 */
    }
    gsl_matrix_free(A), gsl_vector_free(values), gsl_eigen_symm_free(work);
}

/* Random networks, in either order of elimination: factorised, then updated by bonds and springs to the
 * ground, which are added and removed. */
static void dense(void)
{
    scoped_rng *rng = gsl_rng_alloc(gsl_rng_mt19937);
    for (size_t trial = 0; trial < 60; trial++) {
        const size_t n = 1 + trial % DENSE;
        dense_matrix K = {{0}};
        rp_pair bonds[DENSE * DENSE], more[DENSE];
        double along[DENSE][2];
        size_t n_bonds = 0;
        for (uint32_t a = 0; a < n; a++)
            for (uint32_t b = a + 1; b < n; b++)
                if (gsl_rng_uniform(rng) < 0.4) bonds[n_bonds++] = (rp_pair){a, b};
        rp_stiffness *m = NULL;
        rp_pivots pivots;
        CHECK_OK(rp_stiffness_create(n, n_bonds, bonds, trial % 2, &m));
        rp_stiffness_clear(m, 0.3);
        for (uint32_t a = 0; a < n; a++) {
            const double xx = 3 * gsl_rng_uniform(rng) - 1, xy = gsl_rng_uniform(rng) - 0.5,
                         yy = gsl_rng_uniform(rng);
            rp_stiffness_add_site(m, a, xx, xy, yy);
            add_dense(K, (rp_pair){a, a}, 1, 0.3 + xx, xy, 0.3 + yy);
        }
        for (size_t k = 0; k < n_bonds; k++) {
            const double xx = gsl_rng_uniform(rng), xy = gsl_rng_uniform(rng) - 0.5,
                         yy = gsl_rng_uniform(rng);
            rp_stiffness_add_bond(m, k, bonds[k], xx, xy, yy);
            add_dense(K, bonds[k], 1, xx, xy, yy);
        }
        CHECK_OK(rp_stiffness_factorise(m, &pivots));
        check_solution(m, &pivots, n, K, rng);
        for (int add = 1; add >= 0; add--) {
            size_t n_more = 0;
            for (size_t k = 0; k < n_bonds && n_more < DENSE / 2; k += 2) more[n_more++] = bonds[k];
            more[n_more++] = (rp_pair){(uint32_t)n - 1, (uint32_t)n - 1};
            for (size_t k = 0; k < n_more; k++) {
                if (add) along[k][0] = gsl_rng_uniform(rng), along[k][1] = gsl_rng_uniform(rng) - 0.5;
                add_dense(K, more[k], add ? 1 : -1, along[k][0] * along[k][0], along[k][0] * along[k][1],
                          along[k][1] * along[k][1]);
            }
            CHECK_OK(rp_stiffness_update(m, add, n_more, more, (const double(*)[2])along, &pivots));
            check_solution(m, &pivots, n, K, rng);
        }
        rp_stiffness_free(m);
    }
}

/* Without bonds the pivots are the springs: the smallest, its disk, how many are negative; one that is 0. */
static void pivots_alone(void)
{
    for (size_t k = 0; k < 12; k++) {
        rp_stiffness *m = NULL;
        rp_pivots pivots;
        CHECK_OK(rp_stiffness_create(6, 0, NULL, false, &m));
        rp_stiffness_clear(m, 0);
        for (size_t a = 0; a < 6; a++) {
            const double own = a % 2 ? -3 - (double)a : 3 + (double)a;
            rp_stiffness_add_site(m, a, 2 * a == k ? -0.5 : own, 0, 2 * a + 1 == k ? 0.25 : own + 0.5);
        }
        CHECK_OK(rp_stiffness_factorise(m, &pivots));
        CU_ASSERT(pivots.disk == k / 2 && pivots.smallest == (k % 2 ? 0.25 : 0.5));
        CU_ASSERT_EQUAL(pivots.negative, k % 4 == 0 ? 7 : k % 4 == 3 ? 5 : 6);
        rp_stiffness_clear(m, 1);
        rp_stiffness_add_site(m, k / 2, k % 2 ? 0 : -1, 0, k % 2 ? -1 : 0);
        CHECK_OK(rp_stiffness_factorise(m, &pivots));
        CU_ASSERT(pivots.smallest == 0 && pivots.disk == k / 2 && pivots.negative == 0);
        rp_stiffness_free(m);
    }
}

CHECK_SUITE(sparse, "sparse", dense, pivots_alone, near_factor)
