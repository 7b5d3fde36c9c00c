// The same in C++17: refines a cube with one point near a corner.
#include <wellspaced/wellspaced.hpp>

#include <array>
#include <cstdio>
#include <exception>
#include <vector>

int main() {
    try {
        const std::vector<std::array<double, 3>> points = {{0.9, 0.9, 0.9}};
        wsp::plc domain;
        domain.add_box({-1, -1, -1}, {1, 1, 1});
        domain.add_points(points);
        wsp::triangulation mesh(domain);
        const wsp::report report = mesh.refine(1.5);
        std::printf("%zu tetrahedra, %zu bad\n", report.tetrahedra, report.bad);
        return report.bad != 0 || report.tetrahedra == 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
