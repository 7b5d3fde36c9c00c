// A C++17 program that uses all of wellspaced.hpp and checks what it gets. Exit status 0 if all holds.
#include <wellspaced/wellspaced.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace {

std::atomic<int> checks{0}, failures{0};

void check(bool holds, const char* text, int line) {
    ++checks;
    if (!holds) {
        ++failures;
        std::fprintf(stderr, "line %d: does not hold: %s (last error: %s)\n", line, text, wsp_last_error());
    }
}

#define CHECK(...) check(static_cast<bool>(__VA_ARGS__), #__VA_ARGS__, __LINE__)

// The status of the wsp::error that the call must throw; 0 if it throws none.
template <class Call>
wsp_status thrown(const Call& call) {
    try {
        call();
    } catch (const wsp::error& e) {
        CHECK(std::strlen(e.what()) > 0);
        return e.status();
    }
    return 0;
}

std::vector<wsp::point> scattered(std::size_t n) {
    std::mt19937_64 random(12345);
    std::vector<wsp::point> points(n);
    for (auto& p : points)
        for (auto& x : p) x = static_cast<double>(random() >> 11) / 9007199254740992.0;
    return points;
}

wsp::plc boxed(std::size_t n) {
    wsp::plc domain;
    CHECK(domain.add_box({-1, -1, -1}, {2, 2, 2}) == 0);
    CHECK(domain.add_points(scattered(n)) == 8);
    return domain;
}

double volume(const wsp::mesh_view& view) {
    double sum = 0;
    for (const auto& t : view.tetrahedra) {
        const auto a = view.vertices[t[0]], b = view.vertices[t[1]], c = view.vertices[t[2]], d = view.vertices[t[3]];
        double u[3], v[3], w[3];
        for (int i = 0; i < 3; ++i) {
            const auto k = static_cast<std::size_t>(i);
            u[i] = b[k] - a[k];
            v[i] = c[k] - a[k];
            w[i] = d[k] - a[k];
        }
        const double six = u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
                           u[2] * (v[0] * w[1] - v[1] * w[0]);
        CHECK(six > 0);
        sum += six / 6;
    }
    return sum;
}

struct vector3 {  // a point type of somebody's own
    double x, y, z;
};

void test_points() {
    wsp::triangulation mesh = wsp::triangulation::with_threads(2);
    CHECK(mesh.dimension() == -1 && mesh.vertex_count() == 0);
    CHECK(mesh.insert(wsp::point{0, 0, 0}) == 0);
    const double flat[] = {2, 0, 0, 0, 2, 0};
    CHECK(mesh.insert(wsp::points(flat, 2)) == std::vector<std::uint32_t>{1, 2});
    CHECK(mesh.insert(flat) == std::vector<std::uint32_t>{1, 2});
    CHECK(mesh.insert(std::vector<double>{0, 0, 2}) == std::vector<std::uint32_t>{3});
    CHECK(mesh.insert(std::vector<vector3>{{2, 0, 0}, {2, 2, 2}}) == std::vector<std::uint32_t>{1, 4});
    CHECK(mesh.insert(std::vector<double>{}).empty());
    CHECK(thrown([&] { mesh.insert(std::vector<double>{1, 2}); }) == WSP_ERR_ARGUMENT);
    CHECK(mesh.dimension() == 3 && mesh.vertex_count() == 5 && mesh.tetrahedron_count() == 2);
    CHECK(mesh.point(4) == wsp::point{2, 2, 2});
    CHECK(thrown([&] { mesh.point(5); }) == WSP_ERR_NO_SUCH_VERTEX);
    CHECK(mesh.locate({0, 2, 0}).kind == WSP_AT_VERTEX);
    CHECK(mesh.locate({0.1, 0.1, 0.1}, 2).kind == WSP_IN_TETRAHEDRON);
    CHECK(mesh.locate({-1, 0, 0}).kind == WSP_OUTSIDE);
    try {
        mesh.insert(std::vector<double>{9, 9, 9, 0, 0, std::numeric_limits<double>::infinity()});
        CHECK(false);
    } catch (const std::exception& e) {
        CHECK(std::string(e.what()).find("point 1") != std::string::npos);
    }
    CHECK(mesh.vertex_count() == 5);

    bool closed = true;
    CHECK(mesh.link({{0, 1}}, &closed).size() == 2 && !closed);
    CHECK(thrown([&] { mesh.link({{0, 4}}); }) == WSP_ERR_NO_SUCH_EDGE);

    wsp::triangulation copy = mesh.clone();
    copy.insert(wsp::point{0.5, 0.5, 0.5});
    CHECK(copy.vertex_count() == 6 && mesh.vertex_count() == 5);
    copy.validate();
    copy.remove(2);
    CHECK(copy.vertex_count() == 5 && thrown([&] { copy.remove(2); }) == WSP_ERR_NO_SUCH_VERTEX);
    copy.validate();
    CHECK(copy.insert(mesh.point(2)) == 2 && copy.vertex_count() == 6);
    copy.validate();

    // Moves: the handle goes along, what stays behind is empty.
    wsp::triangulation moved = std::move(copy);
    CHECK(moved.vertex_count() == 6 && copy.get() == nullptr);
    CHECK(thrown([&] { copy.vertex_count(); }) == WSP_ERR_NULL);
    copy = std::move(moved);
    CHECK(copy.vertex_count() == 6);
    static_assert(!std::is_copy_constructible_v<wsp::triangulation>);
    static_assert(std::is_nothrow_move_constructible_v<wsp::triangulation>);
    static_assert(!std::is_copy_constructible_v<wsp::plc> && std::is_nothrow_move_constructible_v<wsp::plc>);
    static_assert(!std::is_copy_constructible_v<wsp::batch> && std::is_nothrow_move_constructible_v<wsp::batch>);
    static_assert(!std::is_copy_constructible_v<wsp::control> && std::is_nothrow_move_constructible_v<wsp::control>);
    static_assert(std::is_nothrow_copy_constructible_v<wsp::error>);
}

void test_plc() {
    wsp::plc cube;
    std::vector<wsp::point> corners;
    for (int i = 0; i < 8; ++i) corners.push_back({i & 1 ? 1.0 : 0.0, i & 2 ? 1.0 : 0.0, i & 4 ? 1.0 : 0.0});
    const std::vector<std::int32_t> markers{1, 2, 3, 4, 5, 6, 7, 8};
    CHECK(cube.add_points(corners, markers) == 0);
    CHECK(thrown([&] { cube.add_points(corners, std::vector<std::int32_t>{1}); }) == WSP_ERR_ARGUMENT);
    CHECK(cube.add_facet({0, 2, 6, 4}, 11) == 0);
    CHECK(cube.add_facet(std::vector<std::uint32_t>{1, 3, 7, 5}) == 1);
    const std::vector<std::uint32_t> vertices{0, 1, 5, 4, 2, 3, 7, 6, 0, 1, 3, 2, 4, 5, 7, 6};
    const std::vector<std::size_t> starts{0, 4, 8, 12, 16};
    CHECK(cube.add_facets(vertices, starts, {}, std::vector<std::int32_t>{13, 14, 15, 16}) == 2);
    CHECK(thrown([&] { cube.add_facets(vertices, std::vector<std::size_t>{0, 99}); }) == WSP_ERR_ARGUMENT);
    CHECK(thrown([&] { cube.add_facet({0, 1, 99}); }) == WSP_ERR_NO_SUCH_VERTEX);
    CHECK(cube.point_count() == 8 && cube.segment_count() == 0 && cube.facet_count() == 6);

    const wsp::triangulation mesh(cube);
    CHECK(mesh.has_domain());
    CHECK(std::abs(volume(mesh.view()) - 1) < 1e-12);

    cube.add_segments(std::vector<std::array<std::uint32_t, 2>>{{0, 7}}, std::vector<std::int32_t>{5});
    cube.add_segments({});
    CHECK(cube.segment_count() == 1);
    cube.add_facet_hole(0, {0, 0.5, 0.5});
    cube.add_hole({0.5, 0.5, 0.5});
    cube.add_region({0.5, 0.5, 0.5}, 3);
    CHECK(thrown([&] { cube.add_region({0.5, 0.5, 0.5}, 3, -1); }) == WSP_ERR_ARGUMENT);

    wsp::plc flat;
    flat.add_points(wsp::points(corners.front().data(), 4));
    flat.add_facet({0, 1, 3, 2});
    CHECK(thrown([&] { wsp::triangulation mesh_of_flat(flat); }) == WSP_ERR_INVALID_DOMAIN);
}

void test_refine() {
    wsp::triangulation mesh(boxed(100));
    wsp::refine_options options(1.5, WSP_RULE_CIRCUMCENTER);
    options.max_vertices = mesh.vertex_count() + 5;
    wsp::report report = mesh.refine(options);
    CHECK(report.status == WSP_VERTEX_LIMIT && report.vertices <= options.max_vertices && report.bad > 0);
    report = mesh.refine(1.5);
    CHECK(report.status == WSP_DONE && report.bad == 0 && report.worst_radius_edge <= 1.500001);
    CHECK(mesh.bad_short_edges(1.5).empty());
    mesh.validate(WSP_VALIDATE_QUALITY, 1.5);
    CHECK(thrown([&] { mesh.validate(WSP_VALIDATE_QUALITY, 1.0); }) == WSP_ERR_NOT_VALID);
    const std::size_t refined = report.steiner;
    report = mesh.sparsify(1.5, WSP_SPARSIFY_THOROUGH);
    CHECK(report.status == WSP_DONE && report.bad == 0 && report.steiner <= refined);
    CHECK(thrown([&] { mesh.sparsify(0.5); }) == WSP_ERR_OPTION);
    const wsp::mesh_view view = mesh.view();
    CHECK(view.vertices.size() == report.vertices && view.tetrahedra.size() == report.tetrahedra);
    CHECK(view.neighbours.size() == report.tetrahedra);
    CHECK(std::abs(volume(view) - 27) < 1e-9);
    options.radius_edge = 0.3;
    CHECK(thrown([&] { mesh.refine(options); }) == WSP_ERR_OPTION);

    wsp::triangulation points_only;  // whose hull is a cube
    points_only.insert(scattered(100));
    for (int i = 0; i < 8; ++i)
        points_only.insert(wsp::point{i & 1 ? 2.0 : -1.0, i & 2 ? 2.0 : -1.0, i & 4 ? 2.0 : -1.0});
    CHECK(!points_only.has_domain());
    points_only.use_hull_as_domain();
    CHECK(points_only.refine(2.0).bad == 0);
}

void test_steps() {
    wsp::triangulation mesh(boxed(30));
    const wsp::sampler_options options(2.0);
    int steps = 0;
    const int failures_before = failures;
    for (auto bad = mesh.bad_short_edges(2.0); !bad.empty() && steps < 5000; bad = mesh.bad_short_edges(2.0), ++steps) {
        const wsp::batch batch = mesh.steiner_batch(bad.front(), options);
        CHECK(!batch.empty() && batch.size() == batch.origins().size() && batch.rule() == WSP_RULE_SPARSE);
        CHECK(batch.edge().vertices[0] == bad.front().vertices[0] && batch.span_angle() >= batch.theta());
        const auto ids = mesh.insert(batch);
        for (std::size_t i = 0; i < ids.size(); ++i)
            CHECK(ids[i] == WSP_NONE || mesh.point(ids[i]) == batch.points()[i]);
        CHECK(thrown([&] { mesh.insert(batch); }) == WSP_ERR_STALE);
        if (failures > failures_before) break;
    }
    CHECK(steps > 0 && steps < 5000);
    mesh.validate(WSP_VALIDATE_QUALITY, 2.0);
}

void test_sampler() {
    const wsp::point p{0, 0, 0}, q{0, 0, 1};
    const std::vector<wsp::point> wide{{5, 0, 0.5}, {0, 5, 0.5}, {-5, 0, 0.5}, {0, -5, 0.5}};
    const std::vector<wsp::point> narrow{{0.6, 0, 0.5}, {0, 0.6, 0.5}, {-0.6, 0, 0.5}, {0, -0.6, 0.5}};
    CHECK(wsp::is_bad_edge(p, q, wide, true, 2));
    CHECK(!wsp::is_bad_edge(p, q, narrow, true, 2));
    CHECK(wsp::sample_edge(p, q, narrow, true).empty());
    const auto samples = wsp::sample_edge(p, q, wide, true, wsp::sampler_options(2));
    CHECK(!samples.empty());
    for (const auto& s : samples) CHECK(std::abs(s[2] - 0.5) < 1e-9 && std::hypot(s[0], s[1]) > std::sqrt(3.75));
    CHECK(wsp::sample_tetrahedron({p, q, wide[0], wide[1]}, wide, true, wsp::sampler_options(2)) == samples);
    CHECK(thrown([&] { wsp::sample_edge(p, p, wide, true); }) == WSP_ERR_ARGUMENT);
}

// What a callback throws comes out of the call unchanged, and the triangulation is usable.
struct own_exception : std::runtime_error {
    own_exception(const char* text, int value) : std::runtime_error(text), number(value) {}
    int number;
};

void test_control() {
    const auto points = scattered(20000);
    int calls = 0;
    bool go_on = false;
    wsp::control control([&](const wsp_progress& progress) {
        ++calls;
        CHECK(progress.fraction >= 0 && progress.fraction <= 1 && progress.stage[0] != '\0');
        return go_on;
    });
    wsp::triangulation mesh;
    std::vector<std::uint32_t> ids(5);
    CHECK(mesh.insert(points, control, &ids) == WSP_CANCELLED);
    CHECK(calls == 1 && ids.empty() && mesh.vertex_count() == 0);
    CHECK(mesh.insert(points, control) == WSP_CANCELLED);
    go_on = true;
    control.reset();
    CHECK(mesh.insert(points, control, &ids) == WSP_DONE);
    CHECK(calls > 1 && ids.size() == points.size() && ids[7] == 7);

    wsp::control moved = std::move(control);  // the callback goes along
    calls = 0;
    moved.cancel();
    CHECK(mesh.refine(wsp::refine_options(2.0), moved).status == WSP_CANCELLED);
    moved.reset();

    wsp::control thrower([](const wsp_progress&) -> bool { throw own_exception("from the callback", 42); });
    wsp::triangulation other;
    for (int round = 0; round < 2; ++round) {
        try {
            other.insert(points, thrower);
            CHECK(false);
        } catch (const own_exception& e) {
            CHECK(e.number == 42 && std::strcmp(e.what(), "from the callback") == 0);
        }
        CHECK(other.vertex_count() == 0);
        // The control stays cancelled until it is reset: no callback, no exception.
        CHECK(other.insert(points, thrower) == WSP_CANCELLED);
        thrower.reset();
    }
    try {
        wsp::triangulation from(boxed(20000), thrower);
        CHECK(false);
    } catch (const own_exception& e) {
        CHECK(e.number == 42);
    }
    // An exception of a call within a callback goes to that inner call.
    int inner = 0;
    wsp::control nested([&](const wsp_progress&) {
        thrower.reset();
        try {
            wsp::triangulation().insert(points, thrower);
        } catch (const own_exception&) {
            ++inner;
        }
        return inner < 2;
    });
    CHECK(other.insert(points, nested) == WSP_CANCELLED);
    CHECK(inner == 2);
    CHECK(other.vertex_count() == 0);
    other.insert(points);
    other.validate();

    // What a log throws, too.
    std::vector<std::string> lines;
    wsp::control logging;
    logging.set_log([&](std::uint32_t level, const char* text) {
        CHECK(level == WSP_LOG_INFO || level == WSP_LOG_WARNING);
        lines.emplace_back(text);
    });
    wsp::triangulation logged;
    CHECK(logged.insert(points, logging) == WSP_DONE);
    CHECK(lines.size() == 1 && lines[0].find("delaunay: ") == 0);
    CHECK(logged.validate(logging) == WSP_DONE);
    logging.set_log([](std::uint32_t, const char*) { throw own_exception("from the log", 43); });
    try {
        logged.refine(wsp::refine_options(2.0), logging);
        CHECK(false);
    } catch (const own_exception& e) {
        CHECK(e.number == 43);
    }
    logged.validate();
    CHECK(logged.validate(logging) == WSP_CANCELLED);
    logging.set_log(nullptr);
    logging.reset();
    wsp::refine_options limited(1.2);
    limited.max_memory = 1;
    CHECK(logged.refine(limited, logging).status == WSP_MEMORY_LIMIT);
    limited.max_memory = 0;
    limited.max_seconds = 1e-9;
    CHECK(logged.refine(limited, logging).status == WSP_TIME_LIMIT);

    wsp::control silent;
    wsp::triangulation quiet;
    CHECK(quiet.insert(scattered(10), silent) == WSP_DONE);
    silent.cancel();
    CHECK(thrown([&] { wsp::triangulation cancelled(boxed(10), silent); }) == WSP_CANCELLED);
}

void test_check() {
    wsp::plc broken;
    // A facet that stands across another, and a point that is there twice.
    broken.add_points(std::vector<wsp::point>{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 1}, {9, 9, 0}, {4, 0, 0}});
    broken.add_facet({0, 1, 2});
    broken.add_facet({3, 4, 5});
    const wsp::plc_check found = broken.check();
    CHECK(found.errors == 2 && found.defects.size() == 9);
    std::size_t through = 0, open = 0, twice = 0;
    for (const wsp::defect& d : found.defects) {
        CHECK(!d.text.empty() && d.is_error == (d.kind < WSP_DEFECT_DUPLICATE_POINT));
        if (d.kind == WSP_DEFECT_SEGMENT_THROUGH_FACET) {
            ++through;
            CHECK(d.elements.size() == 2 && d.elements[0].kind == WSP_ELEMENT_FACET && d.is_error);
            CHECK(d.place == (d.elements[0].index == 0 ? wsp::point{2, 2, 0} : wsp::point{1, 1, 0}));
        } else if (d.kind == WSP_DEFECT_OPEN_EDGE) {
            ++open;
            CHECK(d.elements.size() == 1 && d.measure == 1);
        } else if (d.kind == WSP_DEFECT_DUPLICATE_POINT) {
            ++twice;
            CHECK(d.elements.size() == 2 && d.elements[0].index + d.elements[1].index == 7 && d.place == wsp::point{4, 0, 0});
        }
    }
    CHECK(through == 2 && open == 6 && twice == 1);
    CHECK(std::abs(found.segment_angle.degrees - std::acos(127. / 129) * 180 / std::acos(-1.)) < 1e-9);
    CHECK(found.segment_angle.place == wsp::point{9, 9, 0} && found.segment_angle.elements.size() == 2);
    CHECK(std::isnan(found.facet_angle.degrees) && found.facet_angle.elements.empty());

    const wsp::plc_check good = boxed(10).check();
    CHECK(good.errors == 0 && good.defects.empty() && good.facet_angle.degrees == 90 && good.facet_angle.elements.size() == 2);
    wsp::control control;
    CHECK(broken.check(control).errors == 2);
    control.cancel();
    CHECK(thrown([&] { broken.check(control); }) == WSP_CANCELLED);

    // A cube of triangles.
    wsp::plc cube;
    for (int i = 0; i < 8; ++i) cube.add_points(wsp::point{i & 1 ? 1.0 : 0.0, i & 2 ? 1.0 : 0.0, i & 4 ? 1.0 : 0.0});
    for (const auto& side : {std::array<std::uint32_t, 4>{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}}) {
        cube.add_facet({side[0], side[1], side[2]});
        cube.add_facet({side[0], side[2], side[3]});
    }
    CHECK(cube.join_coplanar(1, control) == WSP_CANCELLED && cube.facet_count() == 12);
    control.reset();
    CHECK(thrown([&] { cube.join_coplanar(91); }) == WSP_ERR_ARGUMENT);
    const std::vector<std::uint32_t> joined = cube.join_coplanar(1);
    CHECK(joined.size() == 12 && cube.facet_count() == 6);
    for (std::uint32_t facet = 0; facet < 6; ++facet) CHECK(std::count(joined.begin(), joined.end(), facet) == 2);
    std::vector<std::uint32_t> again;
    CHECK(cube.join_coplanar(1, control, &again) == WSP_DONE && again == std::vector<std::uint32_t>({0, 1, 2, 3, 4, 5}));
    CHECK(std::abs(volume(wsp::triangulation(cube).view()) - 1) < 1e-12);

    wsp::plc empty = std::move(cube);
    CHECK(thrown([&] { cube.check(); }) == WSP_ERR_NULL && thrown([&] { cube.join_coplanar(1); }) == WSP_ERR_NULL);
}

// The longest edge of the tetrahedra whose centroids are between two planes across x.
double longest_edge(const wsp::triangulation& mesh, double from, double to) {
    const wsp::mesh_view view = mesh.view();
    double longest = 0;
    for (const auto& t : view.tetrahedra) {
        double x = 0;
        for (std::uint32_t v : t) x += view.vertices[v][0] / 4;
        if (x < from || x > to) continue;
        for (std::uint32_t v : t)
            for (std::uint32_t w : t) {
                const wsp::point a = view.vertices[v], b = view.vertices[w];
                longest = std::max(longest, std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]));
            }
    }
    return longest;
}

// A box from 0 to 2 in x, two regions on the sides of a wall at 1.
wsp::plc walled() {
    wsp::plc domain;
    std::vector<wsp::point> corners;
    for (int i = 0; i < 12; ++i) corners.push_back({double(i % 3), i / 3 % 2 ? 1.0 : 0.0, i < 6 ? 0.0 : 1.0});
    domain.add_points(corners);
    for (const auto& side : {std::array<std::uint32_t, 4>{0, 1, 4, 3}, {1, 2, 5, 4}, {6, 7, 10, 9}, {7, 8, 11, 10}, {0, 1, 7, 6}, {1, 2, 8, 7},
                             {3, 4, 10, 9}, {4, 5, 11, 10}, {0, 3, 9, 6}, {2, 5, 11, 8}, {1, 4, 10, 7}})
        domain.add_facet(side);
    domain.add_region({0.5, 0.5, 0.5}, 1);
    domain.add_region({1.5, 0.5, 0.5}, 2);
    return domain;
}

void test_sizes() {
    const wsp::refine_options options(2.0);
    const auto refined = [&](const wsp::sizing& sizes) {
        wsp::triangulation mesh(walled());
        const wsp::report report = mesh.refine(options, sizes);
        CHECK(report.status == WSP_DONE && report.too_large == 0 && report.bad == 0);
        CHECK(std::abs(volume(mesh.view()) - 2) < 1e-9);
        return mesh;
    };
    CHECK(longest_edge(refined({}), 0, 2) >= 1);

    wsp::sizing sizes;
    sizes.everywhere = 0.3;
    CHECK(longest_edge(refined(sizes), 0, 2) <= 0.3);
    sizes.everywhere = std::numeric_limits<double>::infinity();  // asks for nothing
    sizes.regions = {0, 0.2};
    {
        const auto mesh = refined(sizes);
        CHECK(longest_edge(mesh, 0, 1) > 0.6 && longest_edge(mesh, 1, 2) <= 0.2);
    }
    sizes = {};
    sizes.vertices.assign(12, 0.3);
    CHECK(longest_edge(refined(sizes), 0, 2) <= 0.3 * (1 + 1e-9));
    sizes = {};
    std::size_t asked = 0, most = 0;
    sizes.at = [&](wsp::points at, double* max_edge) {
        asked += at.size();
        most = std::max(most, at.size());
        for (std::size_t i = 0; i < at.size(); ++i)
            if (at[i][0] > 1) max_edge[i] = 0.25;  // what is left alone asks for nothing
    };
    {
        const auto mesh = refined(sizes);
        CHECK(asked >= mesh.tetrahedron_count() && most > 20);
        CHECK(longest_edge(mesh, 1, 2) <= 0.25 && longest_edge(mesh, 0, 1) > 0.6);
    }
    // Of several the smallest counts, the option's too.
    sizes.everywhere = 0.5;
    CHECK(longest_edge(refined(sizes), 0, 1) <= 0.5);
    {
        wsp::triangulation mesh(walled());
        wsp::refine_options smaller(2.0);
        smaller.max_edge = 0.35;
        CHECK(mesh.refine(smaller, sizes).status == WSP_DONE);
        CHECK(longest_edge(mesh, 0, 1) <= 0.35 && longest_edge(mesh, 1, 2) <= 0.25);
    }

    // What the callback throws comes out of the call unchanged, and it is not asked again. The triangulation is usable.
    int calls = 0;
    sizes = {};
    sizes.at = [&](wsp::points at, double* max_edge) {
        if (++calls == 3) throw own_exception("from the sizes", 44);
        std::fill_n(max_edge, at.size(), 0.1);
    };
    wsp::control control;
    for (int round = 0; round < 2; ++round) {
        wsp::triangulation mesh(walled());
        calls = 0;
        try {
            round == 0 ? mesh.refine(options, sizes) : mesh.refine(options, sizes, control);
            CHECK(false);
        } catch (const own_exception& e) {
            CHECK(e.number == 44 && std::strcmp(e.what(), "from the sizes") == 0);
        }
        CHECK(calls == 3);
        mesh.validate();
        // Cancelled is that call, and the control that was given until it is reset.
        CHECK(mesh.refine(options).status == WSP_DONE);
        if (round == 1) {
            CHECK(mesh.refine(options, control).status == WSP_CANCELLED);
            control.reset();
            CHECK(mesh.refine(options, control).status == WSP_DONE);
        }
    }
    control.cancel();
    wsp::triangulation mesh(walled());
    sizes.at = nullptr;
    CHECK(mesh.refine(options, sizes, control).status == WSP_CANCELLED);
}

// A control where a call has one, and the number of threads.
void test_within() {
    wsp::control control;
    wsp::triangulation mesh(boxed(200), wsp::triangulation_options(2));
    const wsp::triangulation one(boxed(200), wsp::triangulation_options(1), control);
    CHECK(mesh.vertex_count() == one.vertex_count() && mesh.tetrahedron_count() == one.tetrahedron_count());
    CHECK(wsp::triangulation_options().threads == 1);
    CHECK(thrown([&] { wsp::triangulation too_many(boxed(10), wsp::triangulation_options(5000)); }) == WSP_ERR_OPTION);

    CHECK(mesh.view(control).tetrahedra.size() == one.view().tetrahedra.size());
    CHECK(mesh.bad_short_edges(2, control).size() == one.bad_short_edges(2).size());
    wsp::triangulation hull;
    hull.insert(scattered(50));
    control.cancel();
    CHECK(thrown([&] { wsp::triangulation cancelled(boxed(10), wsp::triangulation_options(2), control); }) == WSP_CANCELLED);
    CHECK(hull.use_hull_as_domain(control) == WSP_CANCELLED && !hull.has_domain());
    CHECK(thrown([&] { hull.view(control); }) == WSP_CANCELLED);
    CHECK(thrown([&] { mesh.bad_short_edges(2, control); }) == WSP_CANCELLED);
    CHECK(mesh.sparsify(2, control).status == WSP_CANCELLED);
    CHECK(thrown([&] { mesh.clone(control); }) == WSP_CANCELLED);
    control.reset();
    CHECK(hull.use_hull_as_domain(control) == WSP_DONE && hull.has_domain());
    CHECK(mesh.refine(2.0).status == WSP_DONE);
    CHECK(mesh.sparsify(2, control, WSP_SPARSIFY_THOROUGH).status == WSP_DONE);

    // An empty control is none; other empty handles are errors, but for those of batches.
    const wsp::control moved = std::move(control);
    CHECK(thrown([&] { control.cancel(); }) == WSP_ERR_NULL);
    CHECK(mesh.validate(control) == WSP_DONE);
    CHECK(wsp::batch(nullptr).empty() && wsp::batch(nullptr).points().data() == nullptr && wsp::batch(nullptr).rule() == 0);
    CHECK(wsp::batch(nullptr).edge().vertices[0] == WSP_NONE);
    CHECK(thrown([&] { mesh.insert(wsp::batch(nullptr)); }) == WSP_ERR_NULL);
}

void test_arrays() {
    const wsp::point a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0}, d{0, 0, 1};
    CHECK(wsp::orientation(a, b, c, d) == 1 && wsp::orientation(a, c, b, d) == -1 && wsp::orientation(a, b, c, {3, 4, 0}) == 0);
    CHECK(wsp::side_of_sphere(a, b, c, d, {0.5, 0.5, 0.5}) == 1 && wsp::side_of_sphere(a, b, c, d, {1, 1, 1}) == 0);
    CHECK(wsp::side_of_sphere(a, b, c, d, {1, 1, 1.0000000000000002}) == -1);
    CHECK(thrown([&] { wsp::orientation(a, b, c, {std::numeric_limits<double>::quiet_NaN(), 0, 0}); }) == WSP_ERR_NOT_FINITE);
    const std::vector<wsp::point> two{a, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}, a, b, {40, 40, 0}, {40, 0, 40}};
    CHECK(wsp::bad_tetrahedra(two, 2) == std::vector<std::uint8_t>{0, 1});
    CHECK(wsp::bad_tetrahedra(std::vector<double>(), 2).empty());
    CHECK(thrown([&] { wsp::bad_tetrahedra(wsp::points(two[0].data(), 7), 2); }) == WSP_ERR_ARGUMENT);
    CHECK(thrown([&] { wsp::bad_tetrahedra(two, 0.3); }) == WSP_ERR_OPTION);

    wsp::triangulation mesh(boxed(100));
    const wsp::mesh_view view = mesh.view();
    const wsp::mesh_arrays arrays(view.vertices, view.tetrahedra, view.neighbours);
    wsp::control control;
    wsp::mesh_batch batch(arrays, wsp::sampler_options(2.0), control);
    CHECK(batch.status() == WSP_DONE && !batch.empty() && batch.refused() == 0);
    CHECK(batch.bad_edges().size() == mesh.bad_short_edges(2).size());
    const wsp::mesh_batch moved = std::move(batch);
    CHECK(batch.empty() && batch.points().empty() && batch.bad_edges().empty() && batch.refused() == 0 && !moved.empty());
    control.cancel();
    CHECK(thrown([&] { wsp::mesh_batch cancelled(arrays, wsp::sampler_options(2.0), control); }) == WSP_CANCELLED);
    CHECK(thrown([&] { wsp::mesh_batch bad(arrays, wsp::sampler_options(0.3)); }) == WSP_ERR_OPTION);

    // Two points so near each other that mending would need edges below 2^-40 of the box: 'batch, insert, repeat' ends with that.
    wsp::triangulation host;
    for (int i = 0; i < 8; ++i) host.insert(wsp::point{i & 1 ? 1.0 : 0.0, i & 2 ? 1.0 : 0.0, i & 4 ? 1.0 : 0.0});
    host.insert(std::vector<wsp::point>{{0.5, 0.5, 0.5}, {0.5, 0.5, 0.5 + std::ldexp(1, -46)}});
    wsp_status status = WSP_DONE;
    std::size_t refused = 0;
    for (int round = 0; round < 100; ++round) {
        const wsp::mesh_view mesh_now = host.view();
        const wsp::mesh_batch points(wsp::mesh_arrays(mesh_now.vertices, mesh_now.tetrahedra, mesh_now.neighbours),
                                     wsp::sampler_options(2.0));
        status = points.status();
        refused = points.refused();
        if (points.empty()) break;
        CHECK(status == WSP_DONE);
        std::vector<wsp::point> more;
        for (const wsp_steiner_point& p : points.points()) more.push_back({p.xyz[0], p.xyz[1], p.xyz[2]});
        host.insert(more);
    }
    CHECK(status == WSP_UNREFINED && refused > 0 && refused >= host.bad_short_edges(2).size());
    const std::vector<wsp::edge> left = host.bad_short_edges(2);
    CHECK(left.size() == 1 && left[0].vertices[0] == 8 && left[0].vertices[1] == 9);
}

void test_boundary() {
    // A box of markers 1 to 6, and a sheet of marker -9 in it that two points near its middle would take out.
    wsp::plc domain;
    domain.add_box({-1, -1, -1}, {2, 2, 2}, 1);
    const std::array<wsp::point, 2> free{{{0.5, 0.5, 0.45}, {0.5, 0.5, 0.55}}};
    domain.add_points(free);
    const std::array<wsp::point, 4> corners{{{0, 0, 0.5}, {1, 0, 0.5}, {1, 1, 0.5}, {0, 1, 0.5}}};
    domain.add_points(corners);
    const std::vector<std::uint32_t> sheet{10, 11, 12, 13};
    domain.add_facet(sheet, -9);

    wsp::triangulation_options keep;
    keep.keep_boundary = 1;
    try {
        wsp::triangulation(domain, keep);
        CHECK(false);
    } catch (const wsp::error& e) {
        CHECK(e.status() == WSP_ERR_INVALID_DOMAIN && std::string(e.what()).find("facet 6") != std::string::npos);
    }
    wsp::triangulation mesh(domain);
    const wsp::report done = mesh.refine(2.0);
    const wsp::mesh_view view = mesh.view();
    const wsp::boundary_view boundary = mesh.boundary();
    CHECK(boundary.vertex_kinds.size() == view.vertices.size() && boundary.vertex_elements.size() == view.vertices.size());
    double area[7] = {};
    for (std::size_t i = 0; i < boundary.faces.size(); ++i) {
        const std::uint32_t facet = boundary.face_facets[i];
        CHECK(boundary.face_markers[i] == (facet == 6 ? -9 : static_cast<std::int32_t>(facet) + 1));
        CHECK((boundary.face_tetrahedra[i][1] == WSP_NONE) == (facet != 6));
        const double *a = view.vertices.data() + 3 * boundary.faces[i][0], *b = view.vertices.data() + 3 * boundary.faces[i][1],
                     *c = view.vertices.data() + 3 * boundary.faces[i][2];
        double u[3], v[3], n[3];
        for (int k = 0; k < 3; ++k) u[k] = b[k] - a[k], v[k] = c[k] - a[k];
        for (int k = 0; k < 3; ++k) n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
        area[facet] += 0.5 * std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        // Out of the box.
        if (facet < 6) CHECK(facet % 2 == 0 ? n[facet / 2] < 0 : n[facet / 2] > 0);
    }
    for (int facet = 0; facet < 7; ++facet) CHECK(std::abs(area[facet] - (facet == 6 ? 1 : 9)) < 1e-12);
    std::size_t on_segments = 0, on_facets = 0;
    for (std::size_t v = 0; v < boundary.vertex_kinds.size(); ++v) {
        on_segments += boundary.vertex_kinds[v] == WSP_ON_SEGMENT;
        on_facets += boundary.vertex_kinds[v] == WSP_ON_FACET;
        CHECK((boundary.vertex_kinds[v] == WSP_ON_VERTEX) == (v < 8 || (v >= 10 && v < 14)));
    }
    CHECK(done.on_segments == on_segments && done.on_facets == on_facets && on_facets > 0);
    double length = 0;
    for (const auto& edge : boundary.edges) {
        const double *a = view.vertices.data() + 3 * edge[0], *b = view.vertices.data() + 3 * edge[1];
        length += std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]);
    }
    CHECK(std::abs(length - 40) < 1e-12);  // twelve sides of 3 and four of 1
    wsp::control control;
    control.cancel();
    wsp::triangulation other(domain);
    try {
        other.boundary(control);
        CHECK(false);
    } catch (const wsp::error& e) {
        CHECK(e.status() == WSP_CANCELLED);
    }
    CHECK(wsp::triangulation().boundary().faces.empty());
}

void test_threads() {
    const auto points = scattered(3000);
    wsp::triangulation shared;
    shared.insert(points);
    std::vector<std::thread> threads;
    for (int k = 0; k < 3; ++k) {
        threads.emplace_back([&] {
            const wsp::triangulation& reader = shared;
            for (std::size_t i = 0; i < points.size(); ++i) {
                const auto found = reader.locate(points[i]);
                if (found.kind != WSP_AT_VERTEX || found.vertices[0] != i) CHECK(false);
            }
            wsp::triangulation own;
            own.insert(points);
            CHECK(own.tetrahedron_count() == reader.tetrahedron_count());
        });
    }
    for (auto& thread : threads) thread.join();
}

}  // namespace

int main() {
    CHECK(std::string(wsp::version()) == wsp_version());
    try {
        test_points();
        test_plc();
        test_refine();
        test_steps();
        test_sampler();
        test_control();
        test_check();
        test_sizes();
        test_within();
        test_arrays();
        test_boundary();
        test_threads();
    } catch (const std::exception& e) {
        std::fprintf(stderr, "an exception got out: %s\n", e.what());
        return 1;
    }
    std::printf("%d checks, %d failures\n", checks.load(), failures.load());
    return failures.load() == 0 ? 0 : 1;
}
