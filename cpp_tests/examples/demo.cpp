// Refines a real data set from C++: the points of a TetGen .poly or .node file in the box that they span.
//
//     demo FILE [BETA]
#include <wellspaced/wellspaced.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace {

// The list of points that both kinds of file begin with: a count, then a number and three coordinates a line.
std::vector<wsp::point> read_points(const char* file) {
    std::ifstream in(file);
    if (!in) throw std::runtime_error("can't be opened");
    std::vector<wsp::point> points;
    std::size_t count = 0;
    bool counted = false;
    for (std::string line; (!counted || points.size() < count) && std::getline(in, line);) {
        std::istringstream fields(line.substr(0, line.find('#')));
        fields >> std::ws;
        if (fields.eof()) continue;
        double number;
        wsp::point p;
        if (!counted) {
            counted = static_cast<bool>(fields >> count);
            if (!counted) break;
        } else if (fields >> number >> p[0] >> p[1] >> p[2]) {
            points.push_back(p);
        } else {
            break;
        }
    }
    if (points.empty() || points.size() < count) throw std::runtime_error("has no whole list of points");
    return points;
}

void refine(const std::vector<wsp::point>& points, double radius_edge, wsp_rule rule, const char* name) {
    wsp::point low = points.front(), high = points.front();
    for (const wsp::point& p : points)
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], p[axis]);
            high[axis] = std::max(high[axis], p[axis]);
        }
    std::vector<wsp::point> inside;  // the box brings its own corners
    for (const wsp::point& p : points) {
        bool corner = true;
        for (int axis = 0; axis < 3; ++axis) corner = corner && (p[axis] == low[axis] || p[axis] == high[axis]);
        if (!corner) inside.push_back(p);
    }

    const auto start = std::chrono::steady_clock::now();
    wsp::plc domain;
    domain.add_box(low, high);
    domain.add_points(inside);
    wsp::triangulation mesh(domain);
    const wsp::report report = mesh.refine(wsp::refine_options(radius_edge, rule));
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::printf("  %-12s %6zu vertices (%zu Steiner), %6zu tetrahedra, %zu bad, worst R/l %.3f, %.2f s\n", name,
                report.vertices, report.steiner, report.tetrahedra, report.bad, report.worst_radius_edge,
                seconds.count());
}

}  // namespace

int main(int argc, char** argv) {
    const double radius_edge = argc > 2 ? std::atof(argv[2]) : 2.0;
    if (argc < 2 || argc > 3 || !(radius_edge >= 1)) {
        std::fprintf(stderr, "usage: %s FILE [BETA], with BETA 1 or more\n", argv[0]);
        return 2;
    }
    try {
        const std::vector<wsp::point> points = read_points(argv[1]);
        std::printf("%s: %zu points, radius-edge bound %g\n", argv[1], points.size(), radius_edge);
        refine(points, radius_edge, WSP_RULE_CIRCUMCENTER, "circumcenter");
        refine(points, radius_edge, WSP_RULE_PAPER, "paper");
        refine(points, radius_edge, WSP_RULE_SPARSE, "sparse");
    } catch (const std::exception& problem) {  // wsp::error is one
        std::fprintf(stderr, "%s: %s\n", argv[1], problem.what());
        return 1;
    }
}
