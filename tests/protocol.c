#include "tests/protocol.h"

#include "dem/scene/scene.h"
#include "sweeps/engine/experiment.h"
#include "tests/program.h"

const sweep_protocol *protocol_of(const sweep_protocol *protocol)
{
    static struct {
        const sweep_protocol *of, *open;
    } kept[8];
    size_t k = 0;
    while (kept[k].of && kept[k].of != protocol) k++;
    if (kept[k].of) return kept[k].open;
    CHECK_OK(sweep_protocol_open(protocol, NULL, NULL, &kept[k].open));
    kept[k].of = protocol;
    return kept[k].open;
}

void *protocol_params(const sweep_protocol *protocol, const char *const changes[])
{
    void *params = calloc(1, protocol->params_size);
    CU_ASSERT_PTR_NOT_NULL_FATAL(params);
    rp_params_defaults(protocol->schema, RP_CGS, params);
    if (protocol->context) memcpy(params, &protocol->context, sizeof(void *)); /* of a text */
    for (; *changes; changes++)
        for (const char *c = *changes; *c; c += strspn(c, " ")) {
            char name[32], value[64];
            int length = 0;
            CU_ASSERT_FATAL(sscanf(c, "%31[^=]=%63[^ ]%n", name, value, &length) == 2 && length > 0);
            sweep_protocol_also(protocol, name);
            const rp_param *param = rp_params_find(protocol->schema, name);
            CU_ASSERT_PTR_NOT_NULL_FATAL(param);
            CHECK_OK(rp_params_set_text(param, RP_CGS, params, value));
            c += length;
        }
    return params;
}

static void no_header(const void *context, rp_units units, FILE *table)
{
    (void)context, (void)units, (void)table;
}

void protocol_trace(const sweep_protocol *protocol, const void *params, long every, sweep_result *result)
{
    const char *folder = path_of("t");
    SHELL("rm -rf t && mkdir t");
    CHECK_OK(protocol->check(params));
    exp_plan *plan;
    run_driver d;
    bool resumed;
    CHECK_OK(sweep_protocol_plan(protocol, params, &plan));
    if (!plan) CHECK_OK(protocol->run(params, 1993, 0, &(sweep_tables){folder, no_header}, result));
    if (!plan) return;
    CHECK_OK(run_start(plan, 1993, 0, &d));
    CHECK_OK(run_open(&d, &(run_sinks){folder, true, .every = {[RUN_ENERGY] = every}, .header = no_header},
                      &resumed));
    CHECK_OK(run_finish(&d));
    CHECK_OK(run_sync(&d));
    sweep_result_of(&d, result);
    run_free(&d);
    exp_free(plan);
}

void protocol_box(double W, double H, long run, const double steps[2], dem_sim **sim)
{
    dem_fill fill = {lround(W * H / 0.04), W, 2.0 * H, 0.1, 0.02, 0.07, 0.13, 1.0};
    dem_scene scene = {
        .def = dem_definition_default(), .n_fills = 1, .fills = &fill, .seed = 1993, .run = run};
    dem_physics physics = dem_physics_default(RP_CGS);
    physics.tangential = DEM_SPRING, physics.damping = DEM_DAMPING_OUTSIDE;
    physics.mu = 0.2;
    dem_physics_apply(&physics, &scene.def);
    const dem_material wall = dem_wall_material(RP_CGS, &dem_material_auto, &physics);
    dem_box_walls(&scene.def, W, &wall);
    scene.def.x_max = 3.0 * W;
    CHECK_OK(dem_scene_start(&scene, sim));
    CHECK_OK(dem_run(*sim, lround(steps[0])));
    dem_wall_open(*sim, DEM_BOX_RIGHT, INFINITY);
    CHECK_OK(dem_run(*sim, lround(steps[1])));
}

double protocol_output(const sweep_protocol *protocol, const sweep_result *result, const char *name)
{
    for (size_t i = 0; protocol->outputs[i].name; i++)
        if (strcmp(protocol->outputs[i].name, name) == 0) return result->values[i];
    fprintf(stderr, "protocol %s: no output %s\n", protocol->name, name);
    CU_FAIL("no such output");
    return NAN;
}

char *protocol_export(const char *folder, const sweep_protocol *const *protocols, unsigned what)
{
    char *text = NULL;
    size_t size = 0;
    FILE *table = open_memstream(&text, &size);
    const rp_status status = sweep_export(folder, protocols, what, "the command", NULL, table);
    fclose(table);
    if (status) *text = '\0';
    return text;
}
