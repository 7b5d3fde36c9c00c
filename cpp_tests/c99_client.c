/* A C99 program that uses every function of wellspaced.h and checks what it gets. Exit status 0 if all holds. */
#include <wellspaced.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int checks = 0, failures = 0;

#define CHECK(condition) check_((condition) != 0, #condition, __LINE__)
#define STATUS(expected, call) status_((expected), (call), #call, __LINE__)
#define DONE(call) STATUS(WSP_DONE, call)

static void check_(int holds, const char *text, int line) {
    ++checks;
    if (!holds) {
        ++failures;
        (void)fprintf(stderr, "line %d: does not hold: %s (last error: %s)\n", line, text, wsp_last_error());
    }
}

static void status_(wsp_status expected, wsp_status status, const char *text, int line) {
    ++checks;
    if (status != expected) {
        ++failures;
        (void)fprintf(stderr, "line %d: %s: status %ld (%s), expected %ld (%s); last error: %s\n", line, text, (long)status,
                      wsp_status_string(status), (long)expected, wsp_status_string(expected), wsp_last_error());
    }
}

/* The same numbers on each machine. */
static double next_random(void) {
    static uint32_t state = 2463534242u;
    state ^= state << 13;
    state ^= state >> 17;
    state ^= state << 5;
    return state / 4294967296.0;
}

static double *random_points(size_t n) {
    double *xyz = malloc(3 * n * sizeof *xyz);
    size_t i;
    if (xyz == NULL) abort();
    for (i = 0; i < 3 * n; ++i) xyz[i] = next_random();
    return xyz;
}

static const double low[3] = {-1, -1, -1}, high[3] = {2, 2, 2};

static double volume(const wsp_mesh_view *view, size_t t) {
    const double *p[4];
    double a[3], b[3], c[3];
    int i;
    for (i = 0; i < 4; ++i) p[i] = view->points + 3 * (size_t)view->tetrahedra[4 * t + (size_t)i];
    for (i = 0; i < 3; ++i) {
        a[i] = p[1][i] - p[0][i];
        b[i] = p[2][i] - p[0][i];
        c[i] = p[3][i] - p[0][i];
    }
    return (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
            a[2] * (b[0] * c[1] - b[1] * c[0])) / 6;
}

/* All tetrahedra positive, neighbours mutual across a common face, volumes adding up. */
static void check_view(const wsp_triangulation *t, double expected_volume) {
    wsp_mesh_view view;
    size_t i, vertices = 0;
    double sum = 0;
    int positive = 1, mutual = 1;
    DONE(wsp_mesh_view_init(&view, sizeof view));
    CHECK(view.points == NULL && view.points_count == 0 && view.tetrahedra_count == 0);
    DONE(wsp_triangulation_view(t, &view));
    DONE(wsp_triangulation_counts(t, &vertices, NULL));
    CHECK(view.points_count == vertices);
    for (i = 0; i < view.tetrahedra_count; ++i) {
        const double v = volume(&view, i);
        int slot, back;
        positive = positive && v > 0;
        sum += v;
        for (slot = 0; slot < 4; ++slot) {
            const uint32_t n = view.neighbours[4 * i + (size_t)slot];
            int found = 0;
            if (n == WSP_NONE) continue;
            if (n >= view.tetrahedra_count) {
                mutual = 0;
                continue;
            }
            for (back = 0; back < 4; ++back) found = found || view.neighbours[4 * (size_t)n + (size_t)back] == i;
            mutual = mutual && found;
        }
    }
    CHECK(positive);
    CHECK(mutual);
    CHECK(fabs(sum - expected_volume) <= 1e-9 * expected_volume);
}

static wsp_plc *boxed(size_t points) {
    wsp_plc *plc = NULL;
    double *xyz = random_points(points);
    uint32_t first = 99;
    DONE(wsp_plc_new(&plc));
    DONE(wsp_plc_add_box(plc, low, high, 1, &first));
    CHECK(first == 0);
    DONE(wsp_plc_add_points(plc, xyz, points, NULL, &first));
    CHECK(first == 8);
    free(xyz);
    return plc;
}

static void test_versions(void) {
    char expected[64];
    CHECK(snprintf(expected, sizeof expected, "%d.%d.%d", WSP_VERSION_MAJOR, WSP_VERSION_MINOR, WSP_VERSION_PATCH) > 0);
    CHECK(strcmp(wsp_version(), expected) == 0);
    CHECK(wsp_abi_version() == WSP_ABI_VERSION);
    CHECK(strcmp(wsp_status_string(WSP_DONE), "done") == 0);
    CHECK(strcmp(wsp_status_string(-12345), "unknown status") == 0);
    CHECK(wsp_last_error()[0] == '\0');
    STATUS(WSP_ERR_NULL, wsp_triangulation_new(NULL, NULL));
    CHECK(strstr(wsp_last_error(), "wsp_triangulation_new") != NULL);
}

static void test_points(void) {
    static const double xyz[] = {0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 2, 2, 0, 0};
    static const double nan_at_1[] = {5, 5, 5, 0, 0, 0, 5, 6, 7};
    static const double inside[3] = {0.25, 0.25, 0.25};
    wsp_triangulation_options options;
    wsp_triangulation *t = NULL, *copy = NULL;
    wsp_location location;
    wsp_edge edge;
    uint32_t ids[5], link[4], closed = 9, has_domain = 9;
    int32_t dimension = 9;
    size_t vertices = 0, tetrahedra = 0, count = 0;
    double p[3], bad[9];

    DONE(wsp_triangulation_options_init(&options, sizeof options));
    CHECK(options.struct_size == sizeof options && options.flags == 0 && options.threads == 1);
    options.threads = 5000;
    STATUS(WSP_ERR_OPTION, wsp_triangulation_new(&options, &t));
    options.threads = 0;
    STATUS(WSP_ERR_STRUCT_SIZE, wsp_triangulation_options_init(&options, 4));
    DONE(wsp_triangulation_new(&options, &t));
    DONE(wsp_triangulation_dimension(t, &dimension));
    CHECK(dimension == -1);
    DONE(wsp_triangulation_insert(t, xyz, 5, ids, NULL));
    CHECK(ids[0] == 0 && ids[1] == 1 && ids[2] == 2 && ids[3] == 3 && ids[4] == 1);
    DONE(wsp_triangulation_dimension(t, &dimension));
    CHECK(dimension == 3);
    DONE(wsp_triangulation_counts(t, &vertices, &tetrahedra));
    CHECK(vertices == 4 && tetrahedra == 1);
    DONE(wsp_triangulation_point(t, 3, p));
    CHECK(p[0] == 0 && p[1] == 0 && p[2] == 2);
    STATUS(WSP_ERR_NO_SUCH_VERTEX, wsp_triangulation_point(t, 4, p));

    DONE(wsp_triangulation_locate(t, inside, WSP_NONE, &location));
    CHECK(location.kind == WSP_IN_TETRAHEDRON);
    DONE(wsp_triangulation_locate(t, xyz + 6, 0, &location));
    CHECK(location.kind == WSP_AT_VERTEX && location.vertices[0] == 2 && location.vertices[1] == WSP_NONE);

    memcpy(bad, nan_at_1, sizeof bad);
    bad[4] = strtod("nan", NULL);
    STATUS(WSP_ERR_NOT_FINITE, wsp_triangulation_insert(t, bad, 3, NULL, NULL));
    CHECK(strstr(wsp_last_error(), "point 1") != NULL);
    bad[4] = 1e300;
    STATUS(WSP_ERR_OUT_OF_RANGE, wsp_triangulation_insert(t, bad, 3, NULL, NULL));
    DONE(wsp_triangulation_counts(t, &vertices, NULL));
    CHECK(vertices == 4);

    edge.vertices[0] = 0;
    edge.vertices[1] = 1;
    DONE(wsp_edge_link(t, edge, NULL, 0, &count, &closed));
    CHECK(count == 2 && closed == 0);
    STATUS(WSP_INCOMPLETE, wsp_edge_link(t, edge, link, 1, &count, NULL));
    CHECK(count == 2);
    DONE(wsp_edge_link(t, edge, link, 4, &count, &closed));
    CHECK(count == 2 && link[0] + link[1] == 5);

    DONE(wsp_triangulation_clone(t, &copy));
    DONE(wsp_triangulation_insert(copy, inside, 1, ids, NULL));
    CHECK(ids[0] == 4);
    DONE(wsp_triangulation_counts(copy, &vertices, &tetrahedra));
    CHECK(vertices == 5 && tetrahedra == 4);
    DONE(wsp_triangulation_remove(copy, 4));
    DONE(wsp_triangulation_counts(copy, &vertices, &tetrahedra));
    CHECK(vertices == 4 && tetrahedra == 1);
    STATUS(WSP_ERR_NO_SUCH_VERTEX, wsp_triangulation_remove(copy, 4));
    STATUS(WSP_ERR_NO_SUCH_VERTEX, wsp_triangulation_point(copy, 4, p));
    DONE(wsp_triangulation_remove(copy, 0));
    DONE(wsp_triangulation_dimension(copy, &dimension));
    CHECK(dimension == 2);
    DONE(wsp_triangulation_insert(copy, xyz, 1, ids, NULL));
    CHECK(ids[0] == 0);
    DONE(wsp_triangulation_insert(copy, inside, 1, ids, NULL));
    CHECK(ids[0] == 4);
    DONE(wsp_triangulation_validate(copy, WSP_VALIDATE_DELAUNAY, 0));
    DONE(wsp_triangulation_counts(copy, &vertices, &tetrahedra));
    CHECK(vertices == 5 && tetrahedra == 4);
    DONE(wsp_edge_link(copy, edge, link, 4, &count, &closed));
    CHECK(count == 3 && closed == 0);
    edge.vertices[1] = 4;
    DONE(wsp_edge_link(copy, edge, link, 4, &count, &closed));
    CHECK(count == 3 && closed == 1);
    DONE(wsp_triangulation_counts(t, &vertices, &tetrahedra));
    CHECK(vertices == 4 && tetrahedra == 1);

    DONE(wsp_triangulation_has_domain(t, &has_domain));
    CHECK(has_domain == 0);
    DONE(wsp_triangulation_use_hull_as_domain(t));
    DONE(wsp_triangulation_has_domain(t, &has_domain));
    CHECK(has_domain == 1);
    STATUS(WSP_ERR_DOMAIN, wsp_triangulation_use_hull_as_domain(t));
    DONE(wsp_triangulation_validate(t, WSP_VALIDATE_DELAUNAY, 0));
    check_view(t, 8.0 / 6);
    wsp_triangulation_free(copy);
    wsp_triangulation_free(t);
    wsp_triangulation_free(NULL);
}

/* A cube by all the pieces of a complex: points with markers, segments, facets as lists of lists. */
static void test_plc(void) {
    static const uint32_t vertices[] = {0, 2, 6, 4, 1, 3, 7, 5, 0, 1, 5, 4, 2, 3, 7, 6, 0, 1, 3, 2, 4, 5, 7, 6};
    static const size_t starts[] = {0, 4, 8, 12, 16, 20, 24};
    static const size_t each[] = {0, 1, 2, 3, 4, 5, 6};
    static const int32_t markers[] = {11, 12, 13, 14, 15, 16, 17, 18};
    static const uint32_t segments[] = {0, 1, 8, 9};
    static const uint32_t no_segments[] = {0, 1, 8, 10};
    static const double centre[3] = {0.5, 0.5, 0.5}, middles[6] = {0.25, 0.25, 0.25, 0.75, 0.75, 0.75};
    double corners[24];
    size_t i, points = 0, segment_count = 0, facets = 0;
    uint32_t first = 99;
    wsp_plc *plc = NULL, *more = NULL;
    wsp_triangulation *t = NULL;
    for (i = 0; i < 8; ++i) {
        corners[3 * i] = (double)(i & 1);
        corners[3 * i + 1] = (double)(i >> 1 & 1);
        corners[3 * i + 2] = (double)(i >> 2 & 1);
    }
    DONE(wsp_plc_new(&plc));
    DONE(wsp_plc_add_points(plc, corners, 8, markers, &first));
    DONE(wsp_plc_add_points(plc, middles, 2, NULL, &first));
    CHECK(first == 8);
    STATUS(WSP_ERR_ARGUMENT, wsp_plc_add_facets(plc, vertices, starts, 6, NULL, 5, NULL, NULL));
    DONE(wsp_plc_add_facets(plc, vertices, starts, 6, each, 6, markers, &first));
    CHECK(first == 0);
    DONE(wsp_plc_counts(plc, &points, &segment_count, &facets));
    CHECK(points == 10 && segment_count == 0 && facets == 6);
    DONE(wsp_triangulation_from_plc(plc, NULL, NULL, &t));
    wsp_plc_free(plc);
    check_view(t, 1);
    wsp_triangulation_free(t);

    DONE(wsp_plc_new(&more));
    DONE(wsp_plc_add_points(more, corners, 8, NULL, NULL));
    DONE(wsp_plc_add_points(more, middles, 2, NULL, NULL));
    DONE(wsp_plc_add_segments(more, segments, 2, markers));
    STATUS(WSP_ERR_NO_SUCH_VERTEX, wsp_plc_add_segments(more, no_segments, 2, NULL));
    DONE(wsp_plc_add_facets(more, vertices, starts, 6, NULL, 6, NULL, &first));
    DONE(wsp_plc_add_facet_hole(more, 0, corners));
    STATUS(WSP_ERR_ARGUMENT, wsp_plc_add_facet_hole(more, 6, corners));
    DONE(wsp_plc_add_hole(more, centre));
    DONE(wsp_plc_add_region(more, centre, 1, 0.5));
    STATUS(WSP_ERR_ARGUMENT, wsp_plc_add_region(more, centre, 1, -0.5));
    DONE(wsp_plc_counts(more, NULL, &segment_count, NULL));
    CHECK(segment_count == 2);
    wsp_plc_free(more);
    wsp_plc_free(NULL);
}

static void test_refine(void) {
    static const wsp_rule rules[] = {WSP_RULE_SPARSE, WSP_RULE_PAPER, WSP_RULE_CIRCUMCENTER};
    size_t i;
    for (i = 0; i < sizeof rules / sizeof *rules; ++i) {
        wsp_plc *plc = boxed(100);
        wsp_triangulation *t = NULL;
        wsp_refine_options options;
        wsp_report report;
        DONE(wsp_triangulation_from_plc(plc, NULL, NULL, &t));
        wsp_plc_free(plc);
        check_view(t, 27);
        DONE(wsp_refine_options_init(&options, sizeof options));
        CHECK(options.radius_edge == 2 && options.rule == WSP_RULE_SPARSE && options.min_edge == 0);
        DONE(wsp_report_init(&report, sizeof report));
        options.rule = 99;
        STATUS(WSP_ERR_OPTION, wsp_refine(t, &options, NULL, &report));
        options.rule = rules[i];
        DONE(wsp_triangulation_counts(t, &options.max_vertices, NULL));
        CHECK(options.max_vertices >= 108);
        options.max_vertices += 5;
        STATUS(WSP_VERTEX_LIMIT, wsp_refine(t, &options, NULL, &report));
        CHECK(report.status == WSP_VERTEX_LIMIT && report.vertices <= options.max_vertices && report.bad > 0);
        options.max_vertices = 1000000;
        DONE(wsp_refine(t, &options, NULL, &report));
        CHECK(report.bad == 0 && report.worst_radius_edge <= 2.000001 && report.min_dihedral_degrees > 0);
        CHECK(report.steiner == report.vertices - report.input_vertices);
        CHECK(report.steiner + report.removed + report.replaced >=
              report.samples + report.segment_splits + report.facet_splits);
        CHECK(report.samples > 0);
        const size_t refined = report.steiner;
        STATUS(WSP_ERR_OPTION, wsp_sparsify_mesh(t, 2, 99, NULL, &report));
        STATUS(WSP_ERR_OPTION, wsp_sparsify_mesh(t, 0.5, WSP_SPARSIFY_QUICK, NULL, &report));
        STATUS(WSP_ERR_NULL, wsp_sparsify_mesh(NULL, 2, WSP_SPARSIFY_QUICK, NULL, &report));
        DONE(wsp_sparsify_mesh(t, 2, WSP_SPARSIFY_THOROUGH, NULL, &report));
        CHECK(report.bad == 0 && report.steiner <= refined && refined - report.steiner == report.removed + report.replaced);
        DONE(wsp_triangulation_validate(t, WSP_VALIDATE_QUALITY, 2));
        check_view(t, 27);
        wsp_triangulation_free(t);
    }
}

static void test_steps(void) {
    wsp_plc *plc = boxed(30);
    wsp_triangulation *t = NULL;
    wsp_sampler_options options;
    size_t steps = 0, i;
    const int failures_before = failures;
    DONE(wsp_triangulation_from_plc(plc, NULL, NULL, &t));
    wsp_plc_free(plc);
    DONE(wsp_sampler_options_init(&options, sizeof options));
    CHECK(options.radius_edge == 2 && options.rule == WSP_RULE_SPARSE);
    for (;;) {
        wsp_edge edge;
        wsp_batch *batch = NULL;
        size_t count = 0, n, before = 0, after = 0;
        uint32_t ids[64];
        const wsp_status status = wsp_bad_short_edges(t, options.radius_edge, &edge, 1, &count);
        CHECK(status == (count > 1 ? WSP_INCOMPLETE : WSP_DONE));
        if (status < 0 || count == 0 || ++steps > 5000) break;
        DONE(wsp_steiner_batch(t, edge, &options, &batch));
        n = wsp_batch_count(batch);
        CHECK(n > 0 && n <= 64);
        CHECK(wsp_batch_edge(batch).vertices[0] == edge.vertices[0]);
        CHECK(wsp_batch_edge(batch).vertices[1] == edge.vertices[1]);
        CHECK(wsp_batch_rule(batch) == WSP_RULE_SPARSE);
        CHECK(wsp_batch_span(batch) >= wsp_batch_theta(batch) && wsp_batch_theta(batch) >= 0);
        DONE(wsp_triangulation_counts(t, &before, NULL));
        DONE(wsp_triangulation_insert_batch(t, batch, ids));
        DONE(wsp_triangulation_counts(t, &after, NULL));
        CHECK(after <= before + n);
        for (i = 0; i < n; ++i) {
            double p[3] = {0, 0, 0};
            CHECK(ids[i] == WSP_NONE || (ids[i] >= before && ids[i] < after));
            const wsp_origin origin = wsp_batch_origins(batch)[i];
            CHECK(origin.kind <= WSP_ORIGIN_SUBFACET);
            CHECK((origin.kind == WSP_ORIGIN_SAMPLE) == (origin.vertices[0] == WSP_NONE));
            if (ids[i] == WSP_NONE) continue;
            DONE(wsp_triangulation_point(t, ids[i], p));
            const double *placed = wsp_batch_points(batch) + 3 * i;
            CHECK(p[0] == placed[0] && p[1] == placed[1] && p[2] == placed[2]);
        }
        STATUS(WSP_ERR_STALE, wsp_triangulation_insert_batch(t, batch, NULL));
        wsp_batch_free(batch);
        if (failures > failures_before) break;
    }
    CHECK(steps > 0 && steps <= 5000);
    DONE(wsp_triangulation_validate(t, WSP_VALIDATE_QUALITY, 2));
    check_view(t, 27);
    wsp_triangulation_free(t);
    wsp_batch_free(NULL);
    CHECK(wsp_batch_count(NULL) == 0 && wsp_batch_points(NULL) == NULL);
}

/* The sampler with nothing but an edge and its ring: a short edge in a wide ring is bad, a long one is not. */
static void test_sampler(void) {
    static const double ring[] = {5, 0, 0.5, 0, 5, 0.5, -5, 0, 0.5, 0, -5, 0.5};
    static const double close[] = {0.6, 0, 0.5, 0, 0.6, 0.5, -0.6, 0, 0.5, 0, -0.6, 0.5};
    static const double p[3] = {0, 0, 0}, q[3] = {0, 0, 1};
    double out[3 * 16];
    size_t count = 99, all = 0, i;
    uint32_t bad = 9;
    DONE(wsp_is_bad_edge(p, q, ring, 4, 1, 2, &bad));
    CHECK(bad == 1);
    DONE(wsp_is_bad_edge(p, q, close, 4, 1, 2, &bad));
    CHECK(bad == 0);
    DONE(wsp_sample_edge(p, q, close, 4, 1, NULL, out, 16, &count));
    CHECK(count == 0);
    DONE(wsp_sample_edge(p, q, ring, 4, 1, NULL, NULL, 0, &all));
    CHECK(all >= 1 && all <= 16);
    DONE(wsp_sample_edge(p, q, ring, 4, 1, NULL, out, 16, &count));
    CHECK(count == all);
    for (i = 0; i < count && i < 16; ++i) {
        /* On the bisector plane, and outside the core disk. */
        CHECK(fabs(out[3 * i + 2] - 0.5) < 1e-9);
        CHECK(hypot(out[3 * i], out[3 * i + 1]) > sqrt(3.75));
    }
    {
        /* A tetrahedron of that edge: the same batch by the sampled rules, its own circumcentre by the third. */
        double corners[12], same[3 * 16];
        size_t k;
        wsp_sampler_options circumcenters;
        for (k = 0; k < 3; ++k) {
            corners[k] = p[k];
            corners[3 + k] = q[k];
            corners[6 + k] = ring[k];
            corners[9 + k] = ring[3 + k];
        }
        DONE(wsp_sample_tetrahedron(corners, ring, 4, 1, NULL, same, 16, &all));
        CHECK(all == count && memcmp(same, out, 3 * count * sizeof *out) == 0);
        DONE(wsp_sampler_options_init(&circumcenters, sizeof circumcenters));
        circumcenters.rule = WSP_RULE_CIRCUMCENTER;
        DONE(wsp_sample_tetrahedron(corners, NULL, 0, 0, &circumcenters, same, 16, &all));
        CHECK(all == 1);
        for (i = 1; i < 4 && all == 1; ++i) {
            double first = 0, other = 0;
            for (k = 0; k < 3; ++k) {
                first += (same[k] - corners[k]) * (same[k] - corners[k]);
                other += (same[k] - corners[3 * i + k]) * (same[k] - corners[3 * i + k]);
            }
            CHECK(fabs(first - other) < 1e-9 * first);
        }
        STATUS(WSP_ERR_ARGUMENT, wsp_sample_tetrahedron(corners, ring, 1, 0, NULL, same, 16, &all));
        STATUS(WSP_ERR_NULL, wsp_sample_tetrahedron(NULL, ring, 4, 1, NULL, same, 16, &all));
        STATUS(WSP_ERR_NULL, wsp_sample_tetrahedron(corners, ring, 4, 1, NULL, same, 16, NULL));
    }
    STATUS(WSP_ERR_ARGUMENT, wsp_sample_edge(p, p, ring, 4, 1, NULL, out, 16, &count));
    STATUS(WSP_ERR_ARGUMENT, wsp_is_bad_edge(p, q, ring, 4, 2, 2, &bad));
}

struct told {
    int calls;
    int cancel;
    size_t vertices;
};

static int32_t tell(void *user, const wsp_progress *progress) {
    struct told *told = user;
    ++told->calls;
    told->vertices = progress->vertices;
    CHECK(progress->struct_size >= sizeof *progress);
    CHECK(progress->stage != NULL && progress->stage[0] != '\0');
    CHECK(progress->fraction >= 0 && progress->fraction <= 1);
    return told->cancel;
}

static void test_control(void) {
    const size_t n = 20000;
    double *xyz = random_points(n);
    struct told told = {0, 1, 0};
    wsp_control *control = NULL;
    wsp_triangulation *t = NULL;
    size_t vertices = 99;
    DONE(wsp_control_new(tell, &told, &control));
    DONE(wsp_triangulation_new(NULL, &t));
    STATUS(WSP_CANCELLED, wsp_triangulation_insert(t, xyz, n, NULL, control));
    CHECK(told.calls == 1);
    DONE(wsp_triangulation_counts(t, &vertices, NULL));
    CHECK(vertices == 0);
    told.cancel = 0;
    DONE(wsp_control_reset(control));
    DONE(wsp_triangulation_insert(t, xyz, n, NULL, control));
    CHECK(told.calls > 1);
    DONE(wsp_triangulation_counts(t, &vertices, NULL));
    CHECK(vertices == n);
    DONE(wsp_control_cancel(control));
    STATUS(WSP_CANCELLED, wsp_refine(t, NULL, control, NULL));
    DONE(wsp_triangulation_validate(t, WSP_VALIDATE_DELAUNAY, 0));
    wsp_control_free(control);
    wsp_control_free(NULL);
    wsp_triangulation_free(t);
    free(xyz);
}

int main(void) {
    test_versions();
    test_points();
    test_plc();
    test_refine();
    test_steps();
    test_sampler();
    test_control();
    printf("%d checks, %d failures\n", checks, failures);
    return failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
