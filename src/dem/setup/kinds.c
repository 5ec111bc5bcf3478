/* Kinds of a definition, and the coefficients of their contacts. */
#include <stdlib.h>
#include <string.h>

#include "dem/setup/definition.h"

rp_status dem_pair_prefix(const dem_definition *def, size_t k, rp_status status)
{
    const size_t n = def->n_kinds, row = k / n;
    const char *name = def->kinds[k % n].name;
    return row < n ? rp_prefix(status, "kinds \"%s\" and \"%s\": ", def->kinds[row].name, name)
                   : rp_prefix(status, "kind \"%s\" at wall %zu: ", name, row - n + 1);
}

rp_status dem_kinds_check(const dem_definition *def)
{
    const size_t n = def->n_kinds;
    if (n > (def->pairs ? DEM_MOST_MIXED : DEM_MOST_KINDS))
        return rp_fail(RP_BAD_INPUT, "%zu kinds: at most %d, and %d with coefficients of their own", n,
                       DEM_MOST_KINDS, DEM_MOST_MIXED);
    if ((n > 0 && !def->kinds) || (n < 2 && def->pairs)) return rp_fail(RP_BAD_INPUT, "kinds: NULL");
    for (size_t i = 0; i < def->n_grains; i++)
        if (def->grains[i].kind > 0 && def->grains[i].kind >= n)
            return rp_fail(RP_BAD_INPUT, "particle %zu: kind = %u: there are %zu", i + 1, def->grains[i].kind,
                           n);
    for (size_t k = 0; def->pairs && k < n * n; k++)
        if (memcmp(&def->pairs[k], &def->pairs[k % n * n + k / n], sizeof *def->pairs) != 0)
            return dem_pair_prefix(def, k, rp_fail(RP_BAD_INPUT, "differ by their order"));
    return RP_OK;
}

rp_status dem_kinds_alloc(dem_definition *def, bool pairs)
{
    def->kinds = calloc(def->n_kinds + 1, sizeof *def->kinds);
    def->pairs = pairs ? calloc(dem_pair_count(def), sizeof *def->pairs) : NULL;
    return def->kinds && (def->pairs || !pairs) ? RP_OK : rp_fail(RP_NO_MEMORY, "kinds: out of memory");
}

rp_status dem_kinds_copy(const dem_definition *of, dem_definition *def)
{
    const bool pairs = of->pairs != NULL;
    RP_TRY(dem_kinds_alloc(def, pairs));
    if (of->kinds) memcpy((dem_kind *)def->kinds, of->kinds, of->n_kinds * sizeof *of->kinds);
    if (pairs) memcpy((dem_material *)def->pairs, of->pairs, dem_pair_count(of) * sizeof *of->pairs);
    return RP_OK;
}

void dem_kinds_free(dem_definition *def)
{
    free((dem_kind *)def->kinds), free((dem_material *)def->pairs);
    def->kinds = NULL, def->pairs = NULL;
}
