/* What protocols share, whatever they are; see protocol.h. */
#include "table/columns.h"
#include "sweeps/engine/protocol.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "core/file.h"
#include "dem/scene/scene.h"

void sweep_result_clear(sweep_result *result)
{
    *result = (sweep_result){.status = ""};
    for (int i = 0; i < SWEEP_MAX_OUTPUTS; i++) result->values[i] = NAN;
}

bool sweep_is_aborted(const char *status)
{
    char quoted[32];
    snprintf(quoted, sizeof quoted, "'%s'", status);
    return strstr(RP_MACHINE_STATUS, quoted) != NULL;
}

rp_status sweep_conclude(sweep_result *result, const char *status, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    snprintf(result->status, sizeof result->status, "%s", status);
    if (format) vsnprintf(result->message, sizeof result->message, format, args);
    va_end(args);
    return rp_is_result(status) ? RP_OK : RP_NO_RESULT;
}

rp_status sweep_table_open(const sweep_tables *t, rp_units units, const char *name, sweep_file *file)
{
    *file = (sweep_file){.out = NULL};
    RP_TRY(rp_path(&file->memory, &file->path, "%s/%s", t->directory, name));
    const rp_status status = rp_file_open(file->path, true, &file->out);
    if (status) return rp_arena_release(&file->memory, NULL), status;
    t->header(t->context, units, file->out);
    return RP_OK;
}

rp_status sweep_table_close(sweep_file *file, rp_status keep)
{
    const rp_status status = rp_file_close(file->path, file->out, keep);
    file->out = NULL;
    rp_arena_release(&file->memory, NULL);
    return status;
}

uint64_t sweep_outputs_hash(const sweep_output outputs[])
{
    XXH64_hash_t hash = 0;
    for (const sweep_output *o = outputs; o->name; o++)
        hash = XXH3_64bits_withSeed(sweep_output_stored(o), strlen(sweep_output_stored(o)), hash);
    return hash;
}

size_t sweep_count_outputs(const sweep_protocol *protocol)
{
    size_t n = 0;
    while (protocol->outputs[n].name) n++;
    return n;
}

const char *const sweep_statistics[SWEEP_STATISTICS] = {"mean", "sd", "se", "lo95", "hi95", "n"};

bool sweep_column_is_statistic(const char *name, const char *output)
{
    const size_t n = strlen(output);
    bool is = false;
    for (int k = 0; k < SWEEP_STATISTICS; k++)
        is |=
            strncmp(name, output, n) == 0 && name[n] == '_' && strcmp(name + n + 1, sweep_statistics[k]) == 0;
    return is;
}
