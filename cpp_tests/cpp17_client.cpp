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
        test_threads();
    } catch (const std::exception& e) {
        std::fprintf(stderr, "an exception got out: %s\n", e.what());
        return 1;
    }
    std::printf("%d checks, %d failures\n", checks.load(), failures.load());
    return failures.load() == 0 ? 0 : 1;
}
