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

/* Everything that is wrong with a complex: its kind, the elements, and where. */
static void expect_defect(const wsp_check *found, wsp_defect_kind kind, uint32_t is_error, wsp_element one, wsp_element other,
                          double x, double y, double z, double measure, const char *text) {
    const size_t count = wsp_check_count(found, NULL);
    size_t i, matches = 0;
    for (i = 0; i < count; ++i) {
        wsp_defect defect;
        const uint32_t elements = other.kind == WSP_ELEMENT_DOMAIN ? 1 : 2;
        DONE(wsp_defect_init(&defect, sizeof defect));
        DONE(wsp_check_defect(found, i, &defect));
        if (defect.kind == kind && defect.is_error == is_error && defect.element_count == elements &&
            memcmp(&defect.elements[0], &one, sizeof one) == 0 &&
            (elements == 1 || memcmp(&defect.elements[1], &other, sizeof other) == 0) && defect.place[0] == x &&
            defect.place[1] == y && defect.place[2] == z && fabs(defect.measure - measure) <= 1e-15 &&
            strstr(wsp_check_text(found, i), text) != NULL)
            ++matches;
    }
    if (matches != 1) (void)fprintf(stderr, "defect %lu at %g %g %g:\n", (unsigned long)kind, x, y, z);
    CHECK(matches == 1);
}

static wsp_element facet(uint32_t index) {
    wsp_element element;
    element.kind = WSP_ELEMENT_FACET;
    element.index = index;
    return element;
}

static void test_boundary(void) {
    wsp_plc *plc = boxed(60);
    wsp_triangulation *t = NULL;
    wsp_control *control = NULL;
    wsp_boundary_view view;
    wsp_report report;
    size_t i, on_segments = 0, on_facets = 0, of_facet[6] = {0};
    STATUS(WSP_ERR_STRUCT_SIZE, wsp_boundary_view_init(&view, 7));
    DONE(wsp_boundary_view_init(&view, sizeof view));
    DONE(wsp_triangulation_from_plc(plc, NULL, NULL, &t));
    wsp_plc_free(plc);
    DONE(wsp_report_init(&report, sizeof report));
    DONE(wsp_refine(t, NULL, NULL, &report));
    DONE(wsp_control_new(NULL, NULL, &control));
    DONE(wsp_control_cancel(control));
    STATUS(WSP_CANCELLED, wsp_triangulation_boundary(t, control, &view));
    CHECK(view.faces == NULL && view.faces_count == 0);
    wsp_control_free(control);
    DONE(wsp_triangulation_boundary(t, NULL, &view));
    CHECK(view.faces_count >= 12 && view.edges_count >= 12 && view.vertices_count == report.vertices);
    for (i = 0; i < view.faces_count; ++i) {
        const uint32_t facet = view.face_facets[i];
        CHECK(facet < 6 && view.face_markers[i] == (int32_t)facet + 1);
        CHECK(view.face_tetrahedra[2 * i] < report.tetrahedra && view.face_tetrahedra[2 * i + 1] == WSP_NONE);
        ++of_facet[facet < 6 ? facet : 0];
    }
    for (i = 0; i < 6; ++i) {
        CHECK(of_facet[i] >= 2);
    }
    /* A box's sides have the markers of their first facets. */
    for (i = 0; i < view.edges_count; ++i) {
        CHECK(view.edges[2 * i] < view.edges[2 * i + 1] && view.edge_segments[i] < 12);
        CHECK(view.edge_markers[i] >= 1 && view.edge_markers[i] <= 6);
    }
    for (i = 0; i < view.vertices_count; ++i) {
        on_segments += view.vertex_kinds[i] == WSP_ON_SEGMENT;
        on_facets += view.vertex_kinds[i] == WSP_ON_FACET;
        CHECK((view.vertex_kinds[i] == WSP_ON_VERTEX) == (i < 8));
        CHECK((view.vertex_elements[i] == WSP_NONE) == (view.vertex_kinds[i] < WSP_ON_SEGMENT));
    }
    CHECK(on_segments == report.on_segments && on_facets == report.on_facets && on_segments + on_facets > 0);
    wsp_triangulation_free(t);
}

static void test_check(void) {
    /* Facet 1 stands across facet 0, point 6 is where point 1 is, and corner 8 of facet 2 is off the plane of the three others. All
       facets end in the open. */
    static const double xyz[] = {0, 0, 0, 4, 0, 0,  0,  4, 0, 1,  1, -1, 1,  1,    1, 9, 9,
                                 0, 4, 0, 0, 10, 0, 0, 11, 0, 0, 11, 1, 0.25, 10, 1, 0};
    static const uint32_t corners[] = {0, 1, 2, 3, 4, 5, 7, 8, 9, 10};
    static const size_t starts[] = {0, 3, 6, 10};
    static const wsp_element none = {WSP_ELEMENT_DOMAIN, 0}, point_6 = {WSP_ELEMENT_POINT, 6}, point_1 = {WSP_ELEMENT_POINT, 1};
    /* A corner of a cube cut off. */
    static const double corner[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const uint32_t sides[] = {0, 1, 2, 0, 1, 3, 0, 2, 3, 1, 2, 3};
    static const size_t side_starts[] = {0, 3, 6, 9, 12};
    const double pi = acos(-1);
    wsp_plc *plc = NULL, *tetrahedron = NULL;
    wsp_check *found = NULL;
    wsp_control *control = NULL;
    wsp_triangulation *t = NULL;
    wsp_defect defect;
    size_t errors = 99, i;

    STATUS(WSP_ERR_NULL, wsp_defect_init(NULL, sizeof defect));
    STATUS(WSP_ERR_STRUCT_SIZE, wsp_defect_init(&defect, sizeof defect - 1));
    DONE(wsp_defect_init(&defect, sizeof defect));
    CHECK(defect.struct_size == sizeof defect && defect.kind == 0 && defect.is_error == 0 && defect.element_count == 0);

    DONE(wsp_plc_new(&plc));
    DONE(wsp_plc_check(plc, &found));
    CHECK(wsp_check_count(found, &errors) == 0 && errors == 0 && wsp_check_text(found, 0) == NULL);
    DONE(wsp_check_angle(found, 0, &defect));
    CHECK(isnan(defect.measure) && defect.element_count == 0 && isnan(defect.place[0]));
    wsp_check_free(found);

    DONE(wsp_plc_add_points(plc, xyz, sizeof xyz / sizeof *xyz / 3, NULL, NULL));
    DONE(wsp_plc_add_facets(plc, corners, starts, 3, NULL, 3, NULL, NULL));
    STATUS(WSP_ERR_NULL, wsp_plc_check(plc, NULL));
    STATUS(WSP_ERR_NULL, wsp_plc_check(NULL, &found));
    CHECK(found == NULL);
    DONE(wsp_plc_check(plc, &found));
    CHECK(wsp_check_count(found, &errors) == 10 && errors == 3);
    expect_defect(found, WSP_DEFECT_NOT_PLANAR, 1, facet(2), none, 11, 0, 0, 1 / sqrt(17), "facet 2: is not planar");
    expect_defect(found, WSP_DEFECT_SEGMENT_THROUGH_FACET, 1, facet(0), facet(1), 2, 2, 0, 0, "facet 0: goes through facet 1");
    expect_defect(found, WSP_DEFECT_SEGMENT_THROUGH_FACET, 1, facet(1), facet(0), 1, 1, 0, 0, "facet 1: goes through facet 0");
    expect_defect(found, WSP_DEFECT_DUPLICATE_POINT, 0, point_6, point_1, 4, 0, 0, 0, "point 6");
    /* The middles of the open edges, of facets that are usable by themselves. */
    expect_defect(found, WSP_DEFECT_OPEN_EDGE, 0, facet(0), none, 2, 0, 0, 1, "facet 0");
    expect_defect(found, WSP_DEFECT_OPEN_EDGE, 0, facet(0), none, 2, 2, 0, 1, "facet 0");
    expect_defect(found, WSP_DEFECT_OPEN_EDGE, 0, facet(0), none, 0, 2, 0, 1, "facet 0");
    expect_defect(found, WSP_DEFECT_OPEN_EDGE, 0, facet(1), none, 1, 1, 0, 1, "facet 1");
    expect_defect(found, WSP_DEFECT_OPEN_EDGE, 0, facet(1), none, 5, 5, 0.5, 1, "facet 1");
    expect_defect(found, WSP_DEFECT_OPEN_EDGE, 0, facet(1), none, 5, 5, -0.5, 1, "facet 1");
    for (i = 0; i < 10; ++i) {
        /* Errors first. */
        DONE(wsp_check_defect(found, i, &defect));
        CHECK(defect.is_error == (i < errors) && (defect.kind < WSP_DEFECT_DUPLICATE_POINT) == (i < errors));
    }
    STATUS(WSP_ERR_ARGUMENT, wsp_check_defect(found, 10, &defect));
    STATUS(WSP_ERR_NULL, wsp_check_defect(found, 0, NULL));
    CHECK(wsp_check_text(found, 10) == NULL);
    /* At the far corner of facet 1. No two facets meet at an edge. */
    DONE(wsp_check_angle(found, 0, &defect));
    CHECK(fabs(defect.measure - acos(127.0 / 129) * 180 / pi) < 1e-9 && defect.kind == 0 && defect.element_count == 2);
    CHECK(defect.elements[0].kind == WSP_ELEMENT_FACET && defect.elements[0].index == 1 && defect.elements[1].index == 1);
    CHECK(defect.place[0] == 9 && defect.place[1] == 9 && defect.place[2] == 0);
    DONE(wsp_check_angle(found, 1, &defect));
    CHECK(isnan(defect.measure) && defect.element_count == 0);
    STATUS(WSP_ERR_ARGUMENT, wsp_check_angle(found, 2, &defect));
    wsp_check_free(found);
    /* The first of the errors is what such a complex is refused with. */
    STATUS(WSP_ERR_INVALID_DOMAIN, wsp_triangulation_from_plc(plc, NULL, NULL, &t));
    CHECK(strstr(wsp_last_error(), "facet 2") != NULL && strstr(wsp_last_error(), "not planar") != NULL);

    DONE(wsp_plc_new(&tetrahedron));
    DONE(wsp_plc_add_points(tetrahedron, corner, 4, NULL, NULL));
    DONE(wsp_plc_add_facets(tetrahedron, sides, side_starts, 4, NULL, 4, NULL, NULL));
    DONE(wsp_plc_check_within(tetrahedron, NULL, &found));
    CHECK(wsp_check_count(found, &errors) == 0 && errors == 0);
    DONE(wsp_check_angle(found, 0, &defect));
    CHECK(fabs(defect.measure - 45) < 1e-9);
    DONE(wsp_check_angle(found, 1, &defect));
    CHECK(fabs(defect.measure - atan(sqrt(2)) * 180 / pi) < 1e-9 && defect.element_count == 2);
    CHECK(defect.elements[0].index == 3 || defect.elements[1].index == 3);
    wsp_check_free(found);

    DONE(wsp_control_new(NULL, NULL, &control));
    DONE(wsp_control_cancel(control));
    STATUS(WSP_CANCELLED, wsp_plc_check_within(plc, control, &found));
    CHECK(found == NULL);
    DONE(wsp_control_reset(control));
    DONE(wsp_plc_check_within(plc, control, &found));
    CHECK(wsp_check_count(found, &errors) == 10 && errors == 3);
    wsp_check_free(found);
    wsp_control_free(control);

    wsp_check_free(NULL);
    errors = 99;
    CHECK(wsp_check_count(NULL, &errors) == 0 && errors == 0 && wsp_check_text(NULL, 0) == NULL);
    STATUS(WSP_ERR_NULL, wsp_check_defect(NULL, 0, &defect));
    STATUS(WSP_ERR_NULL, wsp_check_angle(NULL, 0, &defect));
    wsp_plc_free(tetrahedron);
    wsp_plc_free(plc);
}

/* A cube of twelve triangles; `top` is the marker of one of the two at the top. */
static wsp_plc *triangles(int32_t top) {
    static const uint32_t corners[] = {0, 2, 6, 0, 6, 4, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                                       2, 3, 7, 2, 7, 6, 0, 1, 3, 0, 3, 2, 4, 5, 7, 4, 7, 6};
    double xyz[24];
    size_t starts[13], i;
    int32_t markers[12] = {0};
    wsp_plc *plc = NULL;
    for (i = 0; i < 24; ++i) xyz[i] = (double)(i / 3 >> i % 3 & 1);
    for (i = 0; i < 13; ++i) starts[i] = 3 * i;
    markers[11] = top;
    DONE(wsp_plc_new(&plc));
    DONE(wsp_plc_add_points(plc, xyz, 8, NULL, NULL));
    DONE(wsp_plc_add_facets(plc, corners, starts, 12, NULL, 12, markers, NULL));
    return plc;
}

static void test_join(void) {
    static const uint32_t diagonal[2] = {0, 6};
    wsp_plc *plc = triangles(0);
    wsp_control *control = NULL;
    wsp_triangulation *t = NULL;
    wsp_refine_options options;
    wsp_report report;
    uint32_t joined[12], parts[9] = {0};
    size_t facets = 99;
    STATUS(WSP_ERR_ARGUMENT, wsp_plc_join_coplanar(plc, -1, &facets));
    STATUS(WSP_ERR_ARGUMENT, wsp_plc_join_coplanar(plc, 90.5, &facets));
    STATUS(WSP_ERR_NULL, wsp_plc_join_coplanar(NULL, 1, &facets));
    DONE(wsp_control_new(NULL, NULL, &control));
    DONE(wsp_control_cancel(control));
    STATUS(WSP_CANCELLED, wsp_plc_join_coplanar_within(plc, 1, control, NULL));
    DONE(wsp_plc_counts(plc, NULL, NULL, &facets));
    CHECK(facets == 12);
    wsp_control_free(control);
    DONE(wsp_plc_join_coplanar(plc, 1, &facets));
    CHECK(facets == 6);
    facets = 99;
    DONE(wsp_plc_counts(plc, NULL, NULL, &facets));
    CHECK(facets == 6);
    DONE(wsp_triangulation_from_plc(plc, NULL, NULL, &t));
    check_view(t, 1);
    wsp_triangulation_free(t);
    wsp_plc_free(plc);

    /* Neither facets of different markers, nor across a segment of the list. */
    plc = triangles(7);
    DONE(wsp_plc_add_segments(plc, diagonal, 1, NULL));
    memset(joined, 99, sizeof joined);
    STATUS(WSP_ERR_ARGUMENT, wsp_plc_join_coplanar_groups(plc, 1, NULL, joined, 11, &facets));
    STATUS(WSP_ERR_NULL, wsp_plc_join_coplanar_groups(plc, 1, NULL, NULL, 12, &facets));
    CHECK(joined[0] == 0x63636363u);
    DONE(wsp_plc_join_coplanar_groups(plc, 1, NULL, joined, 12, &facets));
    CHECK(facets == 8);
    for (facets = 0; facets < 12; ++facets) {
        ++parts[joined[facets] < 8 ? joined[facets] : 8];
    }
    /* Each of the eight has one or two of the twelve. */
    for (facets = 0; facets < 8; ++facets) {
        CHECK(parts[facets] == 1 || parts[facets] == 2);
    }
    CHECK(parts[8] == 0);
    DONE(wsp_triangulation_from_plc(plc, NULL, NULL, &t));
    check_view(t, 1);
    /* The diagonal is a segment still: sizes cut it. */
    DONE(wsp_refine_options_init(&options, sizeof options));
    DONE(wsp_report_init(&report, sizeof report));
    options.max_edge = 0.5;
    DONE(wsp_refine(t, &options, NULL, &report));
    CHECK(report.segment_splits > 0 && report.too_large == 0);
    wsp_triangulation_free(t);
    wsp_plc_free(plc);
}

/* Two cubes side by side in x, 0 to 1 and 1 to 2, each a region. */
static wsp_triangulation *two_cubes(void) {
    static const uint32_t corners[] = {0, 1, 4, 3, 1, 2, 5, 4, 6, 7, 10, 9, 7, 8, 11, 10, 0, 1, 7, 6, 1, 2, 8, 7,
                                       3, 4, 10, 9, 4, 5, 11, 10, 0, 3, 9, 6, 2, 5, 11, 8, 1, 4, 10, 7};
    static const double left[3] = {0.5, 0.5, 0.5}, right[3] = {1.5, 0.5, 0.5};
    double xyz[36];
    size_t starts[12], i;
    wsp_plc *plc = NULL;
    wsp_triangulation *t = NULL;
    for (i = 0; i < 12; ++i) {
        xyz[3 * i] = (double)(i % 3);
        xyz[3 * i + 1] = (double)(i / 3 % 2);
        xyz[3 * i + 2] = i < 6 ? 0 : 1;
        starts[i] = 4 * i;
    }
    DONE(wsp_plc_new(&plc));
    DONE(wsp_plc_add_points(plc, xyz, 12, NULL, NULL));
    DONE(wsp_plc_add_facets(plc, corners, starts, 11, NULL, 11, NULL, NULL));
    DONE(wsp_plc_add_region(plc, left, 1, 0));
    DONE(wsp_plc_add_region(plc, right, 2, 0));
    DONE(wsp_triangulation_from_plc(plc, NULL, NULL, &t));
    wsp_plc_free(plc);
    return t;
}

/* Of the tetrahedra whose centroids are from x `from` to `to`: the longest edge, and how many they are. */
static double longest_edge(const wsp_triangulation *t, double from, double to, size_t *count) {
    wsp_mesh_view view;
    size_t i;
    double longest = 0;
    *count = 0;
    DONE(wsp_mesh_view_init(&view, sizeof view));
    DONE(wsp_triangulation_view(t, &view));
    for (i = 0; i < view.tetrahedra_count; ++i) {
        const uint32_t *v = view.tetrahedra + 4 * i;
        double x = 0;
        size_t a, b, k;
        for (a = 0; a < 4; ++a) x += view.points[3 * (size_t)v[a]] / 4;
        if (x < from || x > to) continue;
        ++*count;
        CHECK(view.regions[i] == (x < 1 ? 1u : 2u));
        for (a = 0; a < 4; ++a)
            for (b = a + 1; b < 4; ++b) {
                double squared = 0;
                for (k = 0; k < 3; ++k) {
                    const double d = view.points[3 * (size_t)v[a] + k] - view.points[3 * (size_t)v[b] + k];
                    squared += d * d;
                }
                longest = fmax(longest, sqrt(squared));
            }
    }
    return longest;
}

struct asked {
    size_t calls;
    size_t points;
    size_t most;
    int outside;
};

/* From 0.1 at x 0 to 0.9 at x 2. */
static double size_at(double x) { return 0.1 + 0.4 * x; }

static void ask(void *user, const double *xyz, size_t n, double *max_edge) {
    struct asked *asked = user;
    size_t i;
    ++asked->calls;
    asked->points += n;
    if (n > asked->most) asked->most = n;
    for (i = 0; i < n; ++i) {
        const double *p = xyz + 3 * i;
        if (p[0] < 0 || p[0] > 2 || p[1] < 0 || p[1] > 1 || p[2] < 0 || p[2] > 1) asked->outside = 1;
        max_edge[i] = size_at(p[0]);
    }
}

/* Refines with these sizes and checks what holds in each case. The caller frees the result. */
static wsp_triangulation *refine_sized(const wsp_refine_options *options, const wsp_sizing *sizing) {
    wsp_triangulation *t = two_cubes();
    wsp_report report;
    DONE(wsp_report_init(&report, sizeof report));
    DONE(wsp_refine_sized(t, options, sizing, NULL, &report));
    CHECK(report.bad == 0 && report.too_large == 0 && report.removed == 0 && report.replaced == 0);
    DONE(wsp_triangulation_validate(t, WSP_VALIDATE_QUALITY, 2));
    check_view(t, 2);
    return t;
}

static void test_sizes(void) {
    const double regions[2] = {0.2, 0}, more_regions[3] = {0, 0.2, 0.1};
    double vertices[12];
    wsp_sizing sizing;
    wsp_refine_options options;
    wsp_triangulation *t = NULL;
    struct asked asked = {0, 0, 0, 0};
    size_t count = 0, few = 0, i;
    double longest;

    STATUS(WSP_ERR_NULL, wsp_sizing_init(NULL, sizeof sizing));
    STATUS(WSP_ERR_STRUCT_SIZE, wsp_sizing_init(&sizing, sizeof sizing + 8));
    DONE(wsp_sizing_init(&sizing, sizeof sizing));
    CHECK(sizing.struct_size == sizeof sizing && sizing.region_count == 0 && sizing.vertex_count == 0);
    CHECK(sizing.region_max_edge == NULL && sizing.vertex_max_edge == NULL && sizing.callback == NULL);
    DONE(wsp_refine_options_init(&options, sizeof options));

    /* Nothing is asked for: the cubes stay as they are. */
    t = refine_sized(NULL, &sizing);
    CHECK(longest_edge(t, 0, 2, &few) >= 1);
    CHECK(few < 50);
    wsp_triangulation_free(t);

    /* The same everywhere. */
    options.max_edge = 0.3;
    t = refine_sized(&options, &sizing);
    longest = longest_edge(t, 0, 2, &count);
    CHECK(longest <= 0.3 && longest > 0.15 && count > 20 * few);
    wsp_triangulation_free(t);
    options.max_edge = 0;

    /* One cube gets small tetrahedra, the other large ones. */
    sizing.region_max_edge = regions;
    sizing.region_count = 2;
    t = refine_sized(&options, &sizing);
    CHECK(longest_edge(t, 0, 1, &count) <= 0.2);
    CHECK(longest_edge(t, 1, 2, &few) > 0.6);
    CHECK(count > 5 * few && few > 0);
    wsp_triangulation_free(t);
    /* The other way round; what there is no region for asks for nothing. */
    sizing.region_max_edge = more_regions;
    sizing.region_count = 3;
    t = refine_sized(&options, &sizing);
    CHECK(longest_edge(t, 0, 1, &few) > 0.6);
    CHECK(longest_edge(t, 1, 2, &count) <= 0.2);
    CHECK(count > 5 * few && few > 0);
    wsp_triangulation_free(t);
    sizing.region_max_edge = NULL;
    sizing.region_count = 0;

    /* By the vertices: everywhere the same, then small at x 0 and large at x 2. */
    for (i = 0; i < 12; ++i) vertices[i] = 0.3;
    sizing.vertex_max_edge = vertices;
    sizing.vertex_count = 12;
    t = refine_sized(&options, &sizing);
    CHECK(longest_edge(t, 0, 2, &count) <= 0.3 * (1 + 1e-9));
    wsp_triangulation_free(t);
    for (i = 0; i < 12; ++i) vertices[i] = size_at((double)(i % 3));
    t = refine_sized(&options, &sizing);
    CHECK(longest_edge(t, 0, 0.25, &count) < 0.5 * longest_edge(t, 1.75, 2, &few));
    CHECK(count > 2 * few && few > 0);
    CHECK(longest_edge(t, 0, 2, &count) <= size_at(2));
    wsp_triangulation_free(t);
    sizing.vertex_max_edge = NULL;
    sizing.vertex_count = 0;

    /* By a callback, at many points at once. Cut into slices, each is as small as asked for at its far end. */
    sizing.callback = ask;
    sizing.user = &asked;
    t = refine_sized(&options, &sizing);
    CHECK(asked.calls > 0 && asked.most > 20 && !asked.outside);
    for (i = 0; i < 8; ++i) {
        CHECK(longest_edge(t, 0.25 * (double)i, 0.25 * (double)(i + 1), &count) <= size_at(0.25 * (double)(i + 1)));
        CHECK(count > 0);
    }
    CHECK(longest_edge(t, 1.75, 2, &few) > 0.4);
    longest_edge(t, 0, 0.25, &count);
    CHECK(asked.points >= count && count > 5 * few);
    wsp_triangulation_free(t);

    /* Of several the smallest counts. */
    sizing.region_max_edge = more_regions;
    sizing.region_count = 2;
    options.max_edge = 0.4;
    t = refine_sized(&options, &sizing);
    CHECK(longest_edge(t, 0, 0.25, &count) <= size_at(0.25));
    CHECK(longest_edge(t, 0.75, 1, &count) <= 0.4);
    CHECK(longest_edge(t, 1, 2, &count) <= 0.2);
    wsp_triangulation_free(t);

    t = two_cubes();
    sizing.reserved = 1;
    STATUS(WSP_ERR_OPTION, wsp_refine_sized(t, &options, &sizing, NULL, NULL));
    sizing.reserved = 0;
    sizing.region_max_edge = NULL;
    STATUS(WSP_ERR_NULL, wsp_refine_sized(t, &options, &sizing, NULL, NULL));
    sizing.struct_size = 4;
    STATUS(WSP_ERR_STRUCT_SIZE, wsp_refine_sized(t, &options, &sizing, NULL, NULL));
    STATUS(WSP_ERR_NULL, wsp_refine_sized(NULL, &options, NULL, NULL, NULL));
    CHECK(longest_edge(t, 0, 2, &count) >= 1);
    wsp_triangulation_free(t);
}

/* The predicates, and a round of refinement on plain arrays: the triangulation's own, as a host's. */
static void test_arrays(void) {
    static const double a[3] = {0, 0, 0}, b[3] = {1, 0, 0}, c[3] = {0, 1, 0}, d[3] = {0, 0, 1};
    static const double inside[3] = {0.5, 0.5, 0.5}, on[3] = {1, 1, 1}, outside[3] = {1, 1, 1.0000000000000002};
    /* A regular tetrahedron, and a flat one that is far from it. */
    static const double two[24] = {0, 0, 0, 1, 1, 0, 1, 0, 1, 0, 1, 1, 0, 0, 0, 1, 0, 0, 40, 40, 0, 40, 0, 40};
    wsp_plc *plc = boxed(100);
    wsp_triangulation *t = NULL;
    wsp_mesh_view view;
    wsp_mesh_batch *batch = NULL;
    wsp_refine_options options;
    const wsp_steiner_point *points;
    const wsp_edge *edges;
    wsp_edge own[1];
    size_t n, i, count = 99, own_count = 99;
    int32_t sign = 9;
    uint8_t bad[2] = {9, 9};

    DONE(wsp_orientation(a, b, c, d, &sign));
    CHECK(sign == 1);
    DONE(wsp_orientation(a, c, b, d, &sign));
    CHECK(sign == -1);
    DONE(wsp_orientation(a, b, c, b, &sign));
    CHECK(sign == 0);
    DONE(wsp_side_of_sphere(a, b, c, d, inside, &sign));
    CHECK(sign == 1);
    DONE(wsp_side_of_sphere(a, b, c, d, on, &sign));
    CHECK(sign == 0);
    DONE(wsp_side_of_sphere(a, b, c, d, outside, &sign));
    CHECK(sign == -1);
    DONE(wsp_bad_tetrahedra(two, 2, 2, bad));
    CHECK(bad[0] == 0 && bad[1] == 1);
    DONE(wsp_bad_tetrahedra(two, 2, 0.62, bad));
    CHECK(bad[0] == 0);
    STATUS(WSP_ERR_OPTION, wsp_bad_tetrahedra(two, 2, 0.5, bad));

    DONE(wsp_triangulation_from_plc(plc, NULL, NULL, &t));
    wsp_plc_free(plc);
    DONE(wsp_mesh_view_init(&view, sizeof view));
    DONE(wsp_triangulation_view(t, &view));
    DONE(wsp_sample_mesh(&view, NULL, NULL, &batch));
    n = wsp_mesh_batch_count(batch);
    points = wsp_mesh_batch_points(batch);
    edges = wsp_mesh_batch_bad_edges(batch, &count);
    CHECK(n > 0 && points != NULL && wsp_mesh_batch_refused(batch) == 0);
    STATUS(WSP_INCOMPLETE, wsp_bad_short_edges(t, 2, own, 1, &own_count));
    CHECK(count == own_count && memcmp(edges, own, sizeof *own) == 0);
    for (i = 0; i < n; ++i) {
        const uint32_t *v = view.tetrahedra + 4 * (size_t)points[i].tetrahedron;
        CHECK(points[i].tetrahedron < view.tetrahedra_count && points[i].origin.kind <= WSP_ORIGIN_SUBFACET);
        DONE(wsp_side_of_sphere(view.points + 3 * (size_t)v[0], view.points + 3 * (size_t)v[1], view.points + 3 * (size_t)v[2],
                                view.points + 3 * (size_t)v[3], points[i].xyz, &sign));
        CHECK(sign > 0);
    }
    wsp_mesh_batch_free(batch);

    /* A mesh of no bad tetrahedra and no encroached boundary has no points. The pass over Steiner points leaves encroached facets. */
    DONE(wsp_refine_options_init(&options, sizeof options));
    options.sparsify = WSP_SPARSIFY_OFF;
    DONE(wsp_refine(t, &options, NULL, NULL));
    DONE(wsp_triangulation_view(t, &view));
    DONE(wsp_sample_mesh(&view, NULL, NULL, &batch));
    CHECK(wsp_mesh_batch_count(batch) == 0 && wsp_mesh_batch_bad_edges(batch, &count) == NULL && count == 0);
    wsp_mesh_batch_free(batch);
    wsp_triangulation_free(t);
    wsp_mesh_batch_free(NULL);
    CHECK(wsp_mesh_batch_count(NULL) == 0 && wsp_mesh_batch_points(NULL) == NULL && wsp_mesh_batch_refused(NULL) == 0);
}

static void count_line(void *user, uint32_t level, const char *text) {
    CHECK((level == WSP_LOG_INFO || level == WSP_LOG_WARNING) && text[0] != '\0');
    ++*(size_t *)user;
}

/* The calls that end in _within: cancelled they leave everything as it was, and otherwise they do as those without a control. */
static void test_within(void) {
    const size_t n = 2000;
    double *xyz = random_points(n);
    size_t lines = 0, vertices = 0, count = 99;
    uint32_t has_domain = 9;
    wsp_control *control = NULL;
    wsp_triangulation *t = NULL, *copy = NULL;
    wsp_mesh_view view;
    wsp_edge edge = {{77, 78}};
    DONE(wsp_control_new(NULL, NULL, &control));
    DONE(wsp_control_set_log(control, count_line, &lines));
    DONE(wsp_triangulation_new(NULL, &t));
    DONE(wsp_triangulation_insert(t, xyz, n, NULL, control));
    CHECK(lines > 0);
    DONE(wsp_control_set_log(control, NULL, NULL));
    free(xyz);
    DONE(wsp_mesh_view_init(&view, sizeof view));

    DONE(wsp_control_cancel(control));
    STATUS(WSP_CANCELLED, wsp_triangulation_clone_within(t, control, &copy));
    CHECK(copy == NULL);
    STATUS(WSP_CANCELLED, wsp_triangulation_remove_within(t, 5, control));
    STATUS(WSP_CANCELLED, wsp_triangulation_use_hull_as_domain_within(t, control));
    STATUS(WSP_CANCELLED, wsp_triangulation_validate_within(t, WSP_VALIDATE_DELAUNAY, 0, control));
    STATUS(WSP_CANCELLED, wsp_triangulation_view_within(t, &view, control));
    CHECK(view.points == NULL && view.points_count == 0);
    STATUS(WSP_CANCELLED, wsp_bad_short_edges_within(t, 2, control, &edge, 1, &count));
    CHECK(count == 99 && edge.vertices[0] == 77);
    DONE(wsp_triangulation_counts(t, &vertices, NULL));
    DONE(wsp_triangulation_has_domain(t, &has_domain));
    CHECK(vertices == n && has_domain == 0);

    DONE(wsp_control_reset(control));
    DONE(wsp_triangulation_clone_within(t, control, &copy));
    DONE(wsp_triangulation_remove_within(copy, 5, control));
    DONE(wsp_triangulation_counts(copy, &vertices, NULL));
    CHECK(vertices == n - 1);
    DONE(wsp_triangulation_use_hull_as_domain_within(copy, control));
    DONE(wsp_triangulation_has_domain(copy, &has_domain));
    CHECK(has_domain == 1);
    DONE(wsp_triangulation_validate_within(copy, WSP_VALIDATE_DELAUNAY, 0, control));
    DONE(wsp_triangulation_view_within(copy, &view, control));
    CHECK(view.points_count == n && view.tetrahedra_count > n && isnan(view.points[15]));
    STATUS(WSP_INCOMPLETE, wsp_bad_short_edges_within(copy, 2, control, &edge, 1, &count));
    CHECK(count > 1 && count != 99 && edge.vertices[0] < edge.vertices[1]);
    wsp_triangulation_free(copy);
    wsp_triangulation_free(t);
    wsp_control_free(control);
}

int main(void) {
    test_versions();
    test_points();
    test_plc();
    test_refine();
    test_steps();
    test_sampler();
    test_control();
    test_boundary();
    test_check();
    test_join();
    test_sizes();
    test_arrays();
    test_within();
    printf("%d checks, %d failures\n", checks, failures);
    return failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
