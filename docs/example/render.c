/* SPDX-License-Identifier: MIT */
/* render.c: a particle file as a picture, through the installed library: render FILE PICTURE.png [gl|cpu] */
#include <math.h>
#include <ssfr.h>
#include <stdio.h>
#include <string.h>

/* Passes an error up to the single exit; the library has said on stderr what went wrong. */
#define TRY(call)                        \
    do {                                 \
        result = (call);                 \
        if (result != SSFR_OK) goto end; \
    } while (0)

/* From the front and above, far enough away to see all particles; they lie on the floor. */
static ssfr_result look(ssfr_scene *scene)
{
    static const double up[3] = {0, 1, 0}, way[3] = {0.35, 0.4, 1}; /* from the middle to the eye */
    const double fov = 45 * acos(-1) / 180;
    double lo[3], hi[3], eye[3], middle[3], diagonal = 0;
    ssfr_particles_bounds(scene->particles, lo, hi);
    for (int k = 0; k < 3; k++) diagonal += (hi[k] - lo[k]) * (hi[k] - lo[k]);
    const double radius = sqrt(diagonal) / 2 + scene->particles->radius; /* of a sphere around all of them */
    for (int k = 0; k < 3; k++) {
        middle[k] = (lo[k] + hi[k]) / 2;
        eye[k] = middle[k] + way[k] * radius / sin(fov / 2);
    }
    scene->floor = lo[1] - scene->particles->radius;
    return ssfr_camera_look(&scene->camera, eye, middle, up, fov, 640, 360);
}

static ssfr_result render(const char *file, const char *picture, ssfr_gl *gl)
{
    ssfr_result result = SSFR_OK;
    ssfr_particles *particles = NULL;
    ssfr_graph *graph = NULL;
    ssfr_field *color = NULL;
    ssfr_scene scene = {0};
    TRY(ssfr_particles_load(&particles, file, NULL));
    scene.particles = particles;
    TRY(look(&scene));
    TRY(ssfr_graph_create(&graph, ssfr_pipeline_find("vanderlaan2009"), gl));
    TRY(ssfr_graph_set(graph, "curvature_flow.iterations", "60"));
    TRY(ssfr_graph_set(graph, "medium.absorption_r", "3.5"));
    TRY(ssfr_graph_run(graph, &scene, NULL));
    TRY(ssfr_graph_read(graph, "color", &color));
    TRY(ssfr_png_save(picture, color));
    printf("%s: %zu particles, %.1f ms\n", picture, particles->n, ssfr_graph_report(graph)->wall_ms);
end:
    ssfr_field_destroy(&color);
    ssfr_graph_destroy(&graph);
    ssfr_particles_destroy(&particles);
    return result;
}

int main(int argc, char **argv)
{
    const char *backend = argc > 3 ? argv[3] : "gl";
    const int on_cpu = strcmp(backend, "cpu") == 0;
    ssfr_result result = SSFR_OK;
    ssfr_gl *gl = NULL;
    if (argc < 3 || argc > 4 || (!on_cpu && strcmp(backend, "gl") != 0)) {
        fprintf(stderr, "usage: %s FILE PICTURE.png [gl|cpu]\n", argv[0]);
        return 2;
    }
    if (!on_cpu) TRY(ssfr_gl_create(&gl, SSFR_GL_OWN)); /* without one the graph runs the twins on the CPU */
    TRY(render(argv[1], argv[2], gl));
end:
    ssfr_gl_destroy(&gl);
    return result == SSFR_OK ? 0 : 1;
}
