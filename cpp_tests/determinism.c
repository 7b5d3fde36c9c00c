/* The outputs of tests/determinism.rs, made through the C API by a program of any compiler: determinism FILE compares their hashes with
 * those of the file, tests/determinism.txt. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "wellspaced.h"

static void done(wsp_status status, const char *call) {
    if (status != WSP_DONE && status != WSP_UNREFINED) {
        fprintf(stderr, "%s: %s: %s\n", call, wsp_status_string(status), wsp_last_error());
        exit(1);
    }
}
#define DONE(call) done(call, #call)

static uint64_t state;

static double next(void) {
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(state >> 11) * (1.0 / 9007199254740992.0);
}

static double *room(size_t points) {
    double *xyz = malloc((points ? points : 1) * 3 * sizeof *xyz);
    if (!xyz) exit(1);
    return xyz;
}

static double *scattered(size_t count) {
    double *xyz = room(4 * count + 1);
    state = 7;
    for (size_t i = 0; i < 3 * count; ++i) xyz[i] = next();
    return xyz;
}

static double *grid(size_t n, double step) {
    double *xyz = room(n * n * n);
    for (size_t i = 0; i < n * n * n; ++i) {
        xyz[3 * i] = (double)(i % n) * step;
        xyz[3 * i + 1] = (double)(i / n % n) * step;
        xyz[3 * i + 2] = (double)(i / n / n) * step;
    }
    return xyz;
}

static wsp_triangulation *delaunay(const double *xyz, size_t n, uint32_t threads) {
    wsp_triangulation_options options;
    wsp_triangulation *t = NULL;
    DONE(wsp_triangulation_options_init(&options, sizeof options));
    options.threads = threads;
    DONE(wsp_triangulation_new(&options, &t));
    DONE(wsp_triangulation_insert(t, xyz, n, NULL, NULL));
    return t;
}

static wsp_triangulation *refined_in(double low, double high, size_t n, double radius_edge, wsp_rule rule, wsp_sparsify sparsify,
                                     uint32_t threads) {
    /* The box as Plc::boxed has it. */
    const uint32_t sides[24] = {0, 1, 3, 2, 4, 5, 7, 6, 0, 1, 5, 4, 2, 3, 7, 6, 0, 2, 6, 4, 1, 3, 7, 5};
    const size_t starts[7] = {0, 4, 8, 12, 16, 20, 24};
    double corners[24];
    wsp_triangulation_options how;
    wsp_refine_options options;
    wsp_triangulation *t = NULL;
    wsp_plc *plc = NULL;
    double *xyz = scattered(n);
    DONE(wsp_plc_new(&plc));
    for (int i = 0; i < 24; ++i) corners[i] = i / 3 >> i % 3 & 1 ? high : low;
    DONE(wsp_plc_add_points(plc, corners, 8, NULL, NULL));
    DONE(wsp_plc_add_points(plc, xyz, n, NULL, NULL));
    DONE(wsp_plc_add_facets(plc, sides, starts, 6, NULL, 6, NULL, NULL));
    DONE(wsp_triangulation_options_init(&how, sizeof how));
    how.threads = threads;
    DONE(wsp_triangulation_from_plc(plc, &how, NULL, &t));
    DONE(wsp_refine_options_init(&options, sizeof options));
    options.radius_edge = radius_edge;
    options.rule = rule;
    options.sparsify = sparsify;
    DONE(wsp_refine(t, &options, NULL, NULL));
    wsp_plc_free(plc);
    free(xyz);
    return t;
}

static wsp_triangulation *refined(size_t n, double radius_edge, wsp_rule rule, wsp_sparsify sparsify, uint32_t threads) {
    return refined_in(-1, 2, n, radius_edge, rule, sparsify, threads);
}

static wsp_triangulation *mesh(const char *name, uint32_t threads) {
    wsp_triangulation *t;
    double *xyz;
    size_t n;
    if (strcmp(name, "sparse") == 0) return refined(1000, 2.0, WSP_RULE_SPARSE, WSP_SPARSIFY_QUICK, threads);
    if (strcmp(name, "full") == 0) return refined_in(0, 1, 1000, 1.5, WSP_RULE_SPARSE, WSP_SPARSIFY_MOVES, threads);
    if (strcmp(name, "thorough") == 0) return refined(300, 1.5, WSP_RULE_SPARSE, WSP_SPARSIFY_THOROUGH, threads);
    if (strcmp(name, "paper") == 0) return refined(1000, 2.0, WSP_RULE_PAPER, WSP_SPARSIFY_OFF, threads);
    if (strcmp(name, "circumcenter") == 0) return refined(1000, 1.5, WSP_RULE_CIRCUMCENTER, WSP_SPARSIFY_OFF, threads);
    if (strcmp(name, "scattered") == 0) {
        xyz = scattered(n = 20000);
    } else if (strcmp(name, "many") == 0) {
        xyz = scattered(n = 150000);
    } else if (strcmp(name, "grid") == 0) {
        xyz = grid(20, 1.0);
        n = 8000;
    } else if (strcmp(name, "tenths") == 0) {
        xyz = grid(14, 0.1);
        n = 2744;
    } else if (strcmp(name, "duplicates") == 0) {
        xyz = scattered(500);
        for (size_t i = 1500; i < 6000; ++i) xyz[i] = xyz[i - 1500];
        n = 2000;
    } else if (strcmp(name, "sphere") == 0) {
        xyz = scattered(n = 5000);
        for (size_t i = 0; i < n; ++i) {
            double *p = xyz + 3 * i, length;
            for (int k = 0; k < 3; ++k) p[k] = p[k] * 2.0 - 1.0;
            length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
            for (int k = 0; k < 3; ++k) p[k] /= length;
        }
    } else if (strcmp(name, "flat") == 0) {
        xyz = scattered(3000);
        for (size_t i = 0; i < 3000; ++i) xyz[3 * i + 2] = 0.25;
        xyz[9000] = xyz[9001] = xyz[9002] = 1;
        n = 3001;
    } else if (strcmp(name, "removed") == 0) {
        xyz = scattered(n = 2000);
    } else {
        fprintf(stderr, "%s: no such input\n", name);
        exit(1);
    }
    t = delaunay(xyz, n, threads);
    free(xyz);
    if (strcmp(name, "removed") == 0)
        for (uint32_t v = 0; v < 2000; v += 3) DONE(wsp_triangulation_remove(t, v));
    return t;
}

static uint64_t take(uint64_t hash, const void *array, size_t count, size_t size) {
    /* Little endian, as the file has them. */
    const unsigned char *bytes = array;
    const uint16_t one = 1;
    const int little = *(const unsigned char *)&one;
    for (size_t i = 0; i < count; ++i)
        for (size_t k = 0; k < size; ++k) {
            hash ^= bytes[i * size + (little ? k : size - 1 - k)];
            hash *= UINT64_C(0x100000001b3);
        }
    return hash;
}

static uint64_t hash_of(const wsp_triangulation *t) {
    wsp_mesh_view view;
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    DONE(wsp_mesh_view_init(&view, sizeof view));
    DONE(wsp_triangulation_view(t, &view));
    hash = take(hash, view.points, 3 * view.points_count, 8);
    hash = take(hash, view.tetrahedra, 4 * view.tetrahedra_count, 4);
    hash = take(hash, view.neighbours, 4 * view.tetrahedra_count, 4);
    return take(hash, view.regions, view.tetrahedra_count, 4);
}

int main(int argc, char **argv) {
    FILE *file = argc == 2 ? fopen(argv[1], "r") : NULL;
    char name[32];
    unsigned long long expected;
    int lines = 0, wrong = 0;
    if (!file) {
        fprintf(stderr, "usage: determinism FILE\n");
        return 2;
    }
    while (fscanf(file, "%31s %llx", name, &expected) == 2) {
        for (uint32_t threads = 1; threads <= 2; ++threads) {
            wsp_triangulation *t = mesh(name, threads);
            const uint64_t hash = hash_of(t);
            wsp_triangulation_free(t);
            if (hash != expected) {
                fprintf(stderr, "%s, %u threads: %016llx, expected %016llx\n", name, threads, (unsigned long long)hash, expected);
                ++wrong;
            }
        }
        ++lines;
    }
    fclose(file);
    printf("%d outputs, %d other than checked in\n", lines, wrong);
    return wrong != 0 || lines != 13;
}
