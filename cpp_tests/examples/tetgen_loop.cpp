// TetGen as the mesher: it triangulates points in a box, and in each round inserts wellspaced's points into its mesh (its switch -i).
#include <tetgen.h>
#include <wellspaced/wellspaced.hpp>

#include <algorithm>
#include <cstdio>
#include <random>

namespace {

void set_points(tetgenio& io, const std::vector<wsp::point>& points) {
    io.numberofpoints = static_cast<int>(points.size());
    io.pointlist = new REAL[3 * points.size()];  // TetGen deletes it
    for (std::size_t i = 0; i < points.size(); ++i) std::copy(points[i].begin(), points[i].end(), io.pointlist + 3 * i);
}

void run(const char* switches, tetgenio* in, tetgenio* out, tetgenio* added = nullptr) {
    std::string copy(switches);
    tetrahedralize(&copy[0], in, out, added);
}

// TetGen's arrays as wellspaced reads them.
wsp::mesh_batch round_of(const tetgenio& mesh, const wsp::sampler_options& options) {
    std::vector<std::array<std::uint32_t, 4>> tetrahedra(static_cast<std::size_t>(mesh.numberoftetrahedra));
    for (std::size_t t = 0; t < tetrahedra.size(); ++t)
        for (std::size_t k = 0; k < 4; ++k) tetrahedra[t][k] = static_cast<std::uint32_t>(mesh.tetrahedronlist[4 * t + k]);
    return wsp::mesh_batch(wsp::mesh_arrays({mesh.pointlist, static_cast<std::size_t>(mesh.numberofpoints)}, tetrahedra), options);
}

}  // namespace

int main() {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> inside(-1.0, 1.0);
    std::vector<wsp::point> points;
    for (int i = 0; i < 8; ++i) points.push_back({i & 1 ? 2. : -2., i & 2 ? 2. : -2., i & 4 ? 2. : -2.});
    for (int i = 0; i < 500; ++i) points.push_back({inside(random), inside(random), inside(random)});

    tetgenio input;
    set_points(input, points);
    auto mesh = std::make_unique<tetgenio>();
    run("zQ", &input, mesh.get());

    const wsp::sampler_options options(2.0);
    for (int rounds = 0; rounds < 200; ++rounds) {
        const wsp::mesh_batch batch = round_of(*mesh, options);
        if (batch.empty()) {
            std::printf("%zu points in, %d after %d rounds, %d tetrahedra, %zu bad edges left\n", points.size(),
                        mesh->numberofpoints, rounds, mesh->numberoftetrahedra, batch.bad_edges().size());
            return batch.refused() > 0;
        }
        std::vector<wsp::point> steiner;
        for (const wsp_steiner_point& p : batch.points()) steiner.push_back({p.xyz[0], p.xyz[1], p.xyz[2]});
        tetgenio added;
        set_points(added, steiner);
        auto next = std::make_unique<tetgenio>();
        run("rizQ", mesh.get(), next.get(), &added);
        mesh = std::move(next);
    }
    std::printf("no end\n");
    return 1;
}
