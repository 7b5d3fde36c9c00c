// Large sets of points that no one would choose: each is triangulated exactly, validated, and what its triangulation must be is known.
//
//   hostile CASE
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "wellspaced/wellspaced.hpp"

namespace {

constexpr std::size_t million = 1000000;

void require(bool holds, const char* what) {
    if (!holds) throw std::runtime_error(what);
}

std::uint64_t state = 7;
double number() {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state >> 11) / 9007199254740992.0;
}

struct outcome {
    std::size_t vertices, tetrahedra;
    std::int32_t dimension;
};

// Triangulates; two threads, as far as points come to several.
outcome triangulate(const std::vector<double>& points) {
    wsp_triangulation_options options;
    wsp::check(wsp_triangulation_options_init(&options, sizeof options));
    options.threads = 2;
    wsp_triangulation* t = nullptr;
    wsp::check(wsp_triangulation_new(&options, &t));
    std::vector<std::uint32_t> ids(points.size() / 3);
    outcome made{};
    try {
        wsp::check(wsp_triangulation_insert(t, points.data(), ids.size(), ids.data(), nullptr));
        wsp::check(wsp_triangulation_counts(t, &made.vertices, &made.tetrahedra));
        wsp::check(wsp_triangulation_dimension(t, &made.dimension));
        wsp::check(wsp_triangulation_validate(t, WSP_VALIDATE_DELAUNAY, 0));
        // Each id is its point's vertex.
        for (std::size_t i = 0; i < ids.size(); i += 1 + ids.size() / 1000) {
            double p[3];
            wsp::check(wsp_triangulation_point(t, ids[i], p));
            require(std::equal(p, p + 3, points.begin() + 3 * static_cast<std::ptrdiff_t>(i)), "an id is another point's");
        }
        // There is nothing to refine below dimension 3, and the call says so at once.
        if (made.dimension < 3) wsp::check(wsp_refine(t, nullptr, nullptr, nullptr));
    } catch (...) {
        wsp_triangulation_free(t);
        throw;
    }
    wsp_triangulation_free(t);
    return made;
}

void run(const std::string& name) {
    std::vector<double> points;
    const auto add = [&](double x, double y, double z) { points.insert(points.end(), {x, y, z}); };
    if (name == "equal") {
        for (std::size_t i = 0; i < million; ++i) add(0.1, -0.2, 0.3);
        const outcome made = triangulate(points);
        require(made.vertices == 1 && made.tetrahedra == 0 && made.dimension == 0, "one point");
    } else if (name == "duplicates") {
        // A thousand points a thousand times each.
        for (std::size_t i = 0; i < million; ++i) {
            if (i % 1000 == 0) state = 7;
            const double x = number(), y = number();
            add(x, y, number());
        }
        require(triangulate(points).vertices == 1000, "a thousand points");
    } else if (name == "collinear") {
        for (std::size_t i = 0; i < million; ++i) {
            const double s = std::floor(number() * 1e9);
            add(s, 2 * s, -3 * s);
        }
        const outcome made = triangulate(points);
        require(made.dimension == 1 && made.tetrahedra == 0 && made.vertices > million * 99 / 100, "a line");
    } else if (name == "coplanar") {
        for (std::size_t i = 0; i < million; ++i) {
            const double x = std::floor(number() * 1e6), y = std::floor(number() * 1e6);
            add(x, y, x + y);
        }
        const outcome made = triangulate(points);
        require(made.dimension == 2 && made.tetrahedra == 0, "a plane");
    } else if (name == "cospherical") {
        // The corners of every cell of a grid lie on one sphere.
        for (int i = 0; i < 100; ++i)
            for (int j = 0; j < 100; ++j)
                for (int k = 0; k < 100; ++k) add(i, j, k);
        const outcome made = triangulate(points);
        require(made.vertices == million && made.tetrahedra >= 5 * 99 * 99 * 99u && made.tetrahedra <= 6 * 99 * 99 * 99u, "a grid");
    } else if (name == "sphere") {
        // On one sphere, as far as doubles are.
        for (std::size_t i = 0; i < million; ++i) {
            double x, y, z, r;
            do {
                x = 2 * number() - 1, y = 2 * number() - 1, z = 2 * number() - 1;
                r = std::sqrt(x * x + y * y + z * z);
            } while (r > 1 || r < 0.1);
            add(x / r, y / r, z / r);
        }
        require(triangulate(points).vertices == million, "a sphere");
    } else if (name == "one_sphere") {
        // Exactly on one sphere: whole numbers with x² + y² + z² = n.
        const std::int64_t n = 1105 * 1105 * 9;
        for (std::int64_t x = -3315; x <= 3315; ++x)
            for (std::int64_t y = -3315; y <= 3315; ++y) {
                const std::int64_t rest = n - x * x - y * y;
                if (rest < 0) continue;
                auto z = static_cast<std::int64_t>(std::sqrt(static_cast<double>(rest)));
                while (z * z > rest) --z;
                while ((z + 1) * (z + 1) <= rest) ++z;
                if (z * z != rest) continue;
                add(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
                if (z > 0) add(static_cast<double>(x), static_cast<double>(y), static_cast<double>(-z));
            }
        std::printf("%zu points\n", points.size() / 3);
        require(triangulate(points).vertices == points.size() / 3, "one sphere");
    } else if (name == "shifted") {
        // A unit in the last place is 1.2e-4 there: many points fall together.
        for (std::size_t i = 0; i < million; ++i) {
            const double x = number(), y = number();
            add(1e12 + x, 1e12 + y, 1e12 + number());
        }
        require(triangulate(points).vertices > million / 2, "far from the origin");
    } else if (name == "scales") {
        // Coordinates of all magnitudes that there may be.
        for (std::size_t i = 0; i < million / 100; ++i) {
            double p[3];
            for (double& x : p) x = std::ldexp(number() + 1, static_cast<int>(std::floor(number() * 342)) - 142) * (number() < 0.5 ? -1 : 1);
            add(p[0], p[1], p[2]);
        }
        require(triangulate(points).vertices == million / 100, "all magnitudes");
    } else {
        throw std::runtime_error("no case is called " + name);
    }
}

}  // namespace

int main(int argc, char** argv) {
    try {
        if (argc != 2) throw std::runtime_error("usage: hostile CASE");
        run(argv[1]);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "hostile: %s\n", error.what());
        return 1;
    }
}
