#include <wellspaced/wellspaced.hpp>

#include <cstdio>
#include <random>

int main() {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> inside(0.0, 1.0);
    std::vector<std::array<double, 3>> points(300);
    for (auto& p : points) p = {inside(random), inside(random), inside(random)};

    wsp::plc domain;
    domain.add_box({-1, -1, -1}, {2, 2, 2});
    domain.add_points(points);

    wsp::triangulation mesh(domain);
    wsp::report done = mesh.refine(2.0);  // circumradius at most twice the shortest edge
    std::printf("%zu points in, %zu vertices and %zu tetrahedra out, worst radius-edge ratio %.3f\n",
                done.input_vertices, done.vertices, done.tetrahedra, done.worst_radius_edge);
}
