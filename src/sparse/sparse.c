/* Stiffness matrix and its factorisation; see sparse.h.
 *
 * The lower triangle is kept by columns. Columns 2a and 2a + 1 hold disk a's own block, then the blocks of
 * its bonds in their order, so that the index of every entry follows from its bond. */
#include "sparse/sparse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <suitesparse/cholmod.h>

struct rp_stiffness {
    size_t n;
    size_t *first; /* [n + 1] first bond of each disk as its lower end */
    int *row;      /* [2 n] index of each unknown in L */
    cholmod_common common;
    cholmod_sparse *A;
    cholmod_factor *S, *L; /* supernodal analysis of large piles; the factor */
    double *work;          /* [2 n] of a factorisation or solution; then of conjugate gradients, */
    double *left, *solved; /* what is left of the right side, and its solution, */
    cholmod_dense *p, *q;  /* direction, matrix times it */
};

/* Number of disks from which nested dissection and supernodes are faster for a single factorisation. */
enum { LARGE = 20000, PART = 1000 };

static const double NEAR = 0.1; /* residual of the conjugate gradients, relative to the right side */
enum { ITERATIONS = 8 };        /* at most so many iterations, which cost less than a factorisation */

static rp_status no_memory(size_t n)
{
    return rp_fail(RP_NO_MEMORY, "stiffness matrix of %zu disks: out of memory", n);
}

/* Nested dissection into parts of at most PART disks, each in order of minimum degree. */
static bool order_by_dissection(rp_stiffness *m, cholmod_sparse *graph, int *order)
{
    int *parent = malloc(2 * m->n * sizeof *parent);
    m->common.method[0].nd_small = PART;
    const bool good =
        parent && cholmod_nested_dissection(graph, NULL, 0, order, parent, parent + m->n, &m->common) >= 0;
    free(parent);
    return good;
}

/* Order of elimination that keeps L sparse. The graph of the disks suffices: a quarter of the matrix. */
static bool order_disks(rp_stiffness *m, size_t n_bonds, const rp_pair *bonds, bool often, int *order)
{
    cholmod_sparse *G =
        cholmod_allocate_sparse(m->n, m->n, n_bonds, true, true, -1, CHOLMOD_PATTERN, &m->common);
    if (!G) return false;
    int *p = G->p, *rows = G->i;
    for (size_t a = 0; a <= m->n; a++) p[a] = (int)m->first[a];
    for (size_t k = 0; k < n_bonds; k++) rows[k] = (int)bonds[k].b;
    const bool good = m->n >= LARGE ? cholmod_metis(G, NULL, 0, true, order, &m->common)
                      : often       ? order_by_dissection(m, G, order)
                                    : cholmod_amd(G, NULL, 0, order, &m->common);
    cholmod_free_sparse(&G, &m->common);
    return good;
}

static void set_pattern(rp_stiffness *m, const rp_pair *bonds)
{
    int *p = m->A->p, *rows = m->A->i, at = 0;
    for (size_t a = 0; a < m->n; a++)
        for (int axis = 0; axis < 2; axis++) {
            p[2 * a + axis] = at;
            for (int own = axis; own < 2; own++) rows[at++] = (int)(2 * a) + own;
            for (size_t k = m->first[a]; k < m->first[a + 1]; k++)
                for (int other = 0; other < 2; other++) rows[at++] = (int)(2 * bonds[k].b) + other;
        }
    p[2 * m->n] = at;
}

static bool analyse(rp_stiffness *m, size_t n_bonds, const rp_pair *bonds, bool often, int *order)
{
    cholmod_common *c = &m->common;
    c->print = 0;
    c->supernodal = m->n < LARGE ? CHOLMOD_SIMPLICIAL : CHOLMOD_SUPERNODAL;
    c->final_asis = c->final_super = c->final_ll = false; /* in either case L D L' by columns */
    c->quick_return_if_not_posdef = true;
    c->nmethods = 1;
    c->method[0].ordering = CHOLMOD_GIVEN;
    m->A =
        cholmod_allocate_sparse(2 * m->n, 2 * m->n, 3 * m->n + 4 * n_bonds, true, true, -1, CHOLMOD_REAL, c);
    m->p = cholmod_zeros(2 * m->n, 1, CHOLMOD_REAL, c);
    m->q = cholmod_zeros(2 * m->n, 1, CHOLMOD_REAL, c);
    if (!m->A || !m->p || !m->q) return false;
    if (!order_disks(m, n_bonds, bonds, often, order)) return false;
    set_pattern(m, bonds);
    /* from the last disk on, as nothing may be overwritten before it is read */
    for (size_t a = m->n; a-- > 0;) {
        order[2 * a + 1] = 2 * order[a] + 1;
        order[2 * a] = 2 * order[a];
    }
    cholmod_factor *found = cholmod_analyze_p(m->A, order, NULL, 0, c);
    if (!found) return false;
    for (size_t j = 0; j < 2 * m->n; j++) m->row[((const int *)found->Perm)[j]] = (int)j;
    *(found->is_super ? &m->S : &m->L) = found;
    return true;
}

rp_status rp_stiffness_create(size_t n, size_t n_bonds, const rp_pair *bonds, bool often,
                              rp_stiffness **matrix)
{
    rp_stiffness *m = calloc(1, sizeof *m);
    if (!m) return no_memory(n);
    m->n = n;
    cholmod_start(&m->common);
    m->first = calloc(n + 2, sizeof *m->first);
    m->row = malloc(2 * n * sizeof *m->row);
    m->work = calloc(6 * n + 1, sizeof *m->work);
    m->left = m->work + 2 * n, m->solved = m->work + 4 * n;
    int *order = malloc(2 * n * sizeof *order);
    bool good = m->first && m->row && m->work && order;
    if (good) {
        for (size_t k = 0; k < n_bonds; k++) m->first[bonds[k].a + 1]++;
        for (size_t a = 0; a < n; a++) m->first[a + 1] += m->first[a];
        good = analyse(m, n_bonds, bonds, often, order);
    }
    free(order);
    if (!good) {
        rp_stiffness_free(m);
        return no_memory(n);
    }
    *matrix = m;
    return RP_OK;
}

void rp_stiffness_free(rp_stiffness *m)
{
    if (!m) return;
    cholmod_free_sparse(&m->A, &m->common);
    cholmod_free_factor(&m->S, &m->common);
    cholmod_free_factor(&m->L, &m->common);
    cholmod_dense **const dense[] = {&m->p, &m->q};
    for (size_t k = 0; k < sizeof dense / sizeof *dense; k++) cholmod_free_dense(dense[k], &m->common);
    cholmod_finish(&m->common);
    free(m->first);
    free(m->row);
    free(m->work);
    free(m);
}

void rp_stiffness_clear(rp_stiffness *m, double shift)
{
    double *v = m->A->x;
    memset(v, 0, m->A->nzmax * sizeof *v);
    for (size_t a = 0; a < m->n; a++) rp_stiffness_add_site(m, a, shift, 0, shift);
}

/* Columns 2a and 2a + 1 of the values. */
static double *columns_of(rp_stiffness *m, size_t a, double **second)
{
    const int *p = m->A->p;
    double *v = m->A->x;
    *second = v + p[2 * a + 1];
    return v + p[2 * a];
}

void rp_stiffness_add_site(rp_stiffness *m, size_t a, double xx, double xy, double yy)
{
    double *y, *x = columns_of(m, a, &y);
    x[0] += xx;
    x[1] += xy;
    y[0] += yy;
}

void rp_stiffness_add_bond(rp_stiffness *m, size_t k, rp_pair ends, double xx, double xy, double yy)
{
    const uint32_t disks[] = {ends.b, ends.a};
    double *y = NULL, *x = NULL;
    for (int e = 0; e < 2; e++) {
        x = columns_of(m, disks[e], &y);
        x[0] += xx;
        x[1] += xy;
        y[0] += yy;
    }
    x += 2 + 2 * (k - m->first[ends.a]);
    y += 1 + 2 * (k - m->first[ends.a]);
    x[0] -= xx;
    x[1] -= xy;
    y[0] -= xy;
    y[1] -= yy;
}

static void read_pivots(const rp_stiffness *m, rp_pivots *pivots)
{
    const int *p = m->L->p, *order = m->L->Perm;
    const double *v = m->L->x;
    *pivots = (rp_pivots){.smallest = INFINITY};
    for (size_t j = 0; j < m->L->minor; j++) {
        double d = v[p[j]];
        pivots->negative += d < 0;
        if (!(fabs(d) >= pivots->smallest)) {
            pivots->smallest = fabs(d);
            pivots->disk = (size_t)order[j] / 2;
        }
    }
    if (m->L->minor < m->L->n) *pivots = (rp_pivots){pivots->negative, 0, (size_t)order[m->L->minor] / 2};
}

/* Supernodal L L', converted to L D L'; false if the matrix is not positive, or out of memory. */
static bool factorise_by_supernodes(rp_stiffness *m)
{
    cholmod_common *c = &m->common;
    cholmod_free_factor(&m->L, c);
    m->L = cholmod_copy_factor(m->S, c);
    if (m->L && cholmod_factorize(m->A, m->L, c) && m->L->minor == m->L->n) return true;
    if (m->L) cholmod_change_factor(CHOLMOD_PATTERN, false, false, true, true, m->L, c);
    return false;
}

/* L D L' row after row (Davis 2005, ACM Trans. Math. Softw. 31), with the same bits on every processor. */
static bool factorise_by_rows(rp_stiffness *m)
{
    cholmod_common *c = &m->common;
    cholmod_factor *L = m->L;
    const int n = (int)(2 * m->n);
    if (!L || (L->xtype == CHOLMOD_PATTERN &&
               !cholmod_change_factor(CHOLMOD_REAL, false, false, false, true, L, c)))
        return false;
    cholmod_sparse *upper = cholmod_ptranspose(m->A, 1, L->Perm, NULL, 0, c);
    int *parent = malloc((size_t)(3 * n + 1) * sizeof *parent), *seen = parent + n, *stack = seen + n;
    const int *at = L->p, *first = upper ? upper->p : NULL, *of = upper ? upper->i : NULL;
    int *rows = L->i, *nz = L->nz, k = 0;
    double *y = m->work, *l = L->x;
    memset(y, 0, (size_t)n * sizeof *y);
    for (double pivot = 1.0; upper && parent && k < n && pivot != 0.0; k++) {
        int top = n;
        parent[k] = -1, seen[k] = k;
        for (int e = first[k]; e < first[k + 1]; e++) {
            int depth = 0;
            y[of[e]] += ((const double *)upper->x)[e];
            for (int i = of[e]; seen[i] != k; i = parent[i]) {
                if (parent[i] < 0) parent[i] = k;
                seen[i] = k, stack[depth++] = i;
            }
            while (depth > 0) stack[--top] = stack[--depth];
        }
        pivot = y[k], y[k] = 0.0;
        for (; top < n; top++) {
            const int i = stack[top], end = at[i] + nz[i]++;
            const double value = y[i], part = value / l[at[i]];
            y[i] = 0.0;
            for (int e = at[i] + 1; e < end; e++) y[rows[e]] -= l[e] * value;
            pivot -= part * value;
            rows[end] = k, l[end] = part;
        }
        rows[at[k]] = k, nz[k] = 1, l[at[k]] = pivot;
        L->minor = (size_t)(k + (pivot != 0.0));
    }
    const bool good = upper && parent;
    cholmod_free_sparse(&upper, c);
    free(parent);
    return good;
}

rp_status rp_stiffness_factorise(rp_stiffness *m, rp_pivots *pivots)
{
    if (!(m->S && factorise_by_supernodes(m)) && !factorise_by_rows(m)) return no_memory(m->n);
    read_pivots(m, pivots);
    return RP_OK;
}

rp_status rp_stiffness_update(rp_stiffness *m, bool add, size_t n_bonds, const rp_pair *bonds,
                              const double (*direction)[2], rp_pivots *pivots)
{
    if (n_bonds == 0) return RP_OK;
    cholmod_sparse *C =
        cholmod_allocate_sparse(2 * m->n, n_bonds, 4 * n_bonds, false, true, 0, CHOLMOD_REAL, &m->common);
    if (!C) return no_memory(m->n);
    int *p = C->p, *rows = C->i, at = 0;
    double *v = C->x;
    for (size_t k = 0; k < n_bonds; k++) {
        p[k] = at;
        for (int i = 0; i < (bonds[k].a == bonds[k].b ? 2 : 4); i++, at++) {
            rows[at] = m->row[2 * (i < 2 ? bonds[k].a : bonds[k].b) + i % 2];
            v[at] = i < 2 ? direction[k][i % 2] : -direction[k][i % 2];
        }
    }
    p[n_bonds] = at;
    const bool good = cholmod_sort(C, &m->common) && cholmod_updown(add, C, m->L, &m->common);
    cholmod_free_sparse(&C, &m->common);
    if (!good) return no_memory(m->n);
    read_pivots(m, pivots);
    return RP_OK;
}

rp_status rp_stiffness_solve(rp_stiffness *m, const double *b, double *x)
{
    const int *at = m->L->p, *rows = m->L->i, *nz = m->L->nz, *order = m->L->Perm, n = (int)(2 * m->n);
    const double *l = m->L->x;
    double *y = m->work;
    for (int j = 0; j < n; j++) y[j] = b[order[j]];
    for (int j = 0; j < n; j++)
        for (int e = at[j] + 1; e < at[j] + nz[j]; e++) y[rows[e]] -= l[e] * y[j];
    for (int j = n; j-- > 0;) {
        y[j] /= l[at[j]];
        for (int e = at[j] + 1; e < at[j] + nz[j]; e++) y[j] -= l[e] * y[rows[e]];
    }
    for (int j = 0; j < n; j++) x[order[j]] = y[j];
    return RP_OK;
}

static double product(const double *a, const double *b, size_t n)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

rp_status rp_stiffness_solve_near(rp_stiffness *m, const double *b, double *x, bool *found)
{
    const size_t n = 2 * m->n;
    double *r = m->left, *z = m->solved, *p = m->p->x, *q = m->q->x, one[] = {1, 0}, zero[] = {0, 0},
           last = INFINITY;
    const double enough = NEAR * NEAR * product(b, b, n);
    memcpy(r, b, n * sizeof *b);
    memset(x, 0, n * sizeof *x);
    memset(p, 0, n * sizeof *p);
    *found = false;
    for (int k = 0; k < ITERATIONS && !*found; k++) {
        RP_TRY(rp_stiffness_solve(m, r, z));
        const double now = product(r, z, n);
        for (size_t i = 0; i < n; i++) p[i] = z[i] + now / last * p[i];
        last = now;
        if (!cholmod_sdmult(m->A, false, one, zero, m->p, m->q, &m->common)) return no_memory(m->n);
        const double curvature = product(p, q, n);
        if (!(curvature > 0)) return RP_OK;
        for (size_t i = 0; i < n; i++) {
            x[i] += now / curvature * p[i];
            r[i] -= now / curvature * q[i];
        }
        *found = product(r, r, n) <= enough;
    }
    return RP_OK;
}
