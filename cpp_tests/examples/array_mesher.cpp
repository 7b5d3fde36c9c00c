// A mesher of one page that keeps plain arrays, and wellspaced's Steiner points in it: 'batch, insert, repeat'.
//
//     array_mesher FILE [BETA]     FILE: a .poly of points in a box
//
// The mesher is Bowyer and Watson's: the tetrahedra whose circumspheres hold a new point make room for those that join it to their
// outline. It knows nothing of wellspaced but two exact predicates; yours may have its own.
//
// Exits with 1 if anything can't be mended, bad tetrahedra are left, the rounds are more than the sizes in the input explain, or the
// Steiner points more than a tenth above those that wellspaced's own triangulation takes one by one.
#include <wellspaced/wellspaced.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <utility>

#include "../cgal/poly_file.hpp"

namespace {

using tetrahedron = std::array<std::uint32_t, 4>;

class mesher {
public:
    std::vector<wsp::point> points;
    std::vector<tetrahedron> tetrahedra;
    std::vector<tetrahedron> neighbours;  // across the face opposite each vertex, or WSP_NONE

    // A box as six tetrahedra around its diagonal.
    mesher(const wsp::point& low, const wsp::point& high) {
        for (int i = 0; i < 8; ++i)
            points.push_back({i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1], i & 4 ? high[2] : low[2]});
        const std::uint32_t around[] = {1, 3, 2, 6, 4, 5, 1};
        std::vector<std::uint32_t> all;
        for (int i = 0; i < 6; ++i) {
            tetrahedra.push_back({0, around[i], around[i + 1], 7});
            all.push_back(static_cast<std::uint32_t>(i));
        }
        neighbours.assign(6, {WSP_NONE, WSP_NONE, WSP_NONE, WSP_NONE});
        link(all);
    }

    // Inserts a point of the box. `start` is a tetrahedron near it.
    void insert(const wsp::point& p, std::uint32_t start) {
        if (start >= tetrahedra.size() || is_free(start)) start = last_;
        std::vector<std::uint32_t> cavity{locate(p, start)};
        for (std::uint32_t v : tetrahedra[cavity[0]])
            if (points[v] == p) return;
        struct face {
            tetrahedron with_p;
            std::uint32_t beyond;
            std::uint32_t slot;
        };
        std::vector<face> outline;
        const std::uint32_t added = static_cast<std::uint32_t>(points.size());
        points.push_back(p);
        const auto in_cavity = [&](std::uint32_t t) { return std::find(cavity.begin(), cavity.end(), t) != cavity.end(); };
        for (std::size_t next = 0; next < cavity.size(); ++next)
            for (std::uint32_t slot = 0; slot < 4; ++slot) {
                const std::uint32_t t = cavity[next], across = neighbours[t][slot];
                if (across != WSP_NONE && in_cavity(across)) continue;
                if (across != WSP_NONE && side_of_sphere(tetrahedra[across], p) > 0) {
                    cavity.push_back(across);
                    continue;
                }
                tetrahedron with_p = tetrahedra[t];
                with_p[slot] = added;
                // A point on the box's side has no tetrahedron with that side.
                if (across == WSP_NONE && orientation(with_p) == 0) continue;
                outline.push_back({with_p, across, slot});
            }
        free_.insert(free_.end(), cavity.begin(), cavity.end());
        for (std::uint32_t t : cavity) tetrahedra[t][0] = WSP_NONE;
        std::vector<std::uint32_t> made;
        for (const face& f : outline) {
            std::uint32_t t = static_cast<std::uint32_t>(tetrahedra.size());
            if (free_.empty()) {
                tetrahedra.push_back({});
                neighbours.push_back({});
            } else {
                t = free_.back();
                free_.pop_back();
            }
            tetrahedra[t] = f.with_p;
            neighbours[t] = {WSP_NONE, WSP_NONE, WSP_NONE, WSP_NONE};
            neighbours[t][f.slot] = f.beyond;
            if (f.beyond != WSP_NONE) neighbours[f.beyond][slot_of(f.beyond, f.with_p, f.slot)] = t;
            made.push_back(t);
        }
        link(made);
        last_ = made[0];
    }

    // Closes the gaps in the arrays.
    void compact() {
        std::sort(free_.rbegin(), free_.rend());
        for (std::uint32_t hole : free_) {
            const std::uint32_t moved = static_cast<std::uint32_t>(tetrahedra.size()) - 1;
            if (hole != moved) {
                tetrahedra[hole] = tetrahedra[moved];
                neighbours[hole] = neighbours[moved];
                for (std::uint32_t n : neighbours[hole])
                    if (n != WSP_NONE) std::replace(neighbours[n].begin(), neighbours[n].end(), moved, hole);
            }
            tetrahedra.pop_back();
            neighbours.pop_back();
        }
        free_.clear();
        last_ = 0;
    }

private:
    bool is_free(std::uint32_t t) const { return tetrahedra[t][0] == WSP_NONE; }

    int orientation(const tetrahedron& t) const {
        return wsp::orientation(points[t[0]], points[t[1]], points[t[2]], points[t[3]]);
    }
    int side_of_sphere(const tetrahedron& t, const wsp::point& p) const {
        return wsp::side_of_sphere(points[t[0]], points[t[1]], points[t[2]], points[t[3]], p);
    }

    // Walks through faces that have the point behind them.
    std::uint32_t locate(const wsp::point& p, std::uint32_t t) {
        points.push_back(p);
        const std::uint32_t probe = static_cast<std::uint32_t>(points.size()) - 1;
        for (std::uint32_t from = WSP_NONE, slot = 0; slot < 4; ++slot) {
            const std::uint32_t across = neighbours[t][slot];
            if (across == WSP_NONE || across == from) continue;
            tetrahedron with_p = tetrahedra[t];
            with_p[slot] = probe;
            if (orientation(with_p) >= 0) continue;
            from = t;
            t = across;
            slot = WSP_NONE;  // 0 after the increment
        }
        points.pop_back();
        return t;
    }

    // The slot of tetrahedron t that is opposite its face in common with `other` at `slot`.
    std::uint32_t slot_of(std::uint32_t t, const tetrahedron& other, std::uint32_t slot) const {
        for (std::uint32_t s = 0;; ++s) {
            const std::uint32_t v = tetrahedra[t][s];
            bool shared = false;
            for (std::uint32_t k = 0; k < 4; ++k) shared = shared || (k != slot && other[k] == v);
            if (!shared) return s;
        }
    }

    // Makes tetrahedra neighbours that share faces among one another.
    void link(const std::vector<std::uint32_t>& some) {
        std::map<std::array<std::uint32_t, 3>, std::array<std::uint32_t, 2>> open;
        for (std::uint32_t t : some)
            for (std::uint32_t slot = 0; slot < 4; ++slot) {
                if (neighbours[t][slot] != WSP_NONE) continue;
                std::array<std::uint32_t, 3> key{};
                for (std::uint32_t k = 0, n = 0; k < 4; ++k)
                    if (k != slot) key[n++] = tetrahedra[t][k];
                std::sort(key.begin(), key.end());
                const auto other = open.find(key);
                if (other == open.end()) {
                    open[key] = {t, slot};
                } else {
                    neighbours[t][slot] = other->second[0];
                    neighbours[other->second[0]][other->second[1]] = t;
                    open.erase(other);
                }
            }
    }

    std::vector<std::uint32_t> free_;
    std::uint32_t last_ = 0;
};

struct result {
    int rounds = 0;
    std::size_t refused = 0;
};

// The whole connection to wellspaced, but for the limit that it is tested with.
result refine(mesher& mesh, const wsp::sampler_options& options, int most_rounds) {
    for (result done;; ++done.rounds) {
        mesh.compact();
        const wsp::mesh_batch batch(wsp::mesh_arrays(mesh.points, mesh.tetrahedra, mesh.neighbours), options);
        done.refused = batch.refused();  // what can't be mended stays so from round to round
        if (batch.empty() || done.rounds > most_rounds) return done;
        for (const wsp_steiner_point& p : batch.points()) mesh.insert({p.xyz[0], p.xyz[1], p.xyz[2]}, p.tetrahedron);
    }
}

std::size_t count_bad(const mesher& mesh, double radius_edge) {
    std::vector<wsp::point> corners;
    for (const tetrahedron& t : mesh.tetrahedra)
        for (std::uint32_t v : t) corners.push_back(mesh.points[v]);
    const std::vector<std::uint8_t> bad = wsp::bad_tetrahedra(corners, radius_edge);
    return static_cast<std::size_t>(std::count(bad.begin(), bad.end(), 1));
}

double distance(const wsp::point& a, const wsp::point& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

double shortest_edge(const mesher& mesh) {
    double shortest = distance(mesh.points[0], mesh.points[7]);
    for (const tetrahedron& t : mesh.tetrahedra)
        for (std::uint32_t a : t)
            for (std::uint32_t b : t)
                if (a < b) shortest = std::min(shortest, distance(mesh.points[a], mesh.points[b]));
    return shortest;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return std::fprintf(stderr, "usage: %s FILE [BETA]\n", argv[0]), 2;
    const double radius_edge = argc > 2 ? std::atof(argv[2]) : 2.0;
    const auto xyz = poly_file::read(argv[1]).xyz;
    const wsp::points input(xyz);
    wsp::point low = {xyz[0], xyz[1], xyz[2]}, high = low;
    for (std::size_t i = 0; i < xyz.size(); ++i) {
        low[i % 3] = std::min(low[i % 3], xyz[i]);
        high[i % 3] = std::max(high[i % 3], xyz[i]);
    }

    mesher mesh(low, high);
    for (std::size_t i = 0; i < input.size(); ++i) mesh.insert({xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]}, WSP_NONE);
    const std::size_t before = mesh.points.size();
    mesh.compact();
    // A round mends what lies at about one length, from the shortest on: so rounds go with the logarithm of the lengths between that
    // and the box, not with the number of points.
    const int most_rounds = static_cast<int>(20 * std::log2(distance(low, high) / shortest_edge(mesh)));
    const result done = refine(mesh, wsp::sampler_options(radius_edge), most_rounds);
    const std::size_t added = mesh.points.size() - before;

    // Beside it, the same domain in wellspaced's own triangulation, one edge after the other.
    wsp::plc box;
    box.add_box(low, high);
    box.add_points(input);
    wsp::triangulation own(box);
    wsp::refine_options alone(radius_edge);
    alone.sparsify = WSP_SPARSIFY_OFF;  // rounds take nothing away again
    const std::size_t sequential = own.refine(alone).steiner;
    const std::size_t bad = count_bad(mesh, radius_edge);
    std::printf("%zu points in, %zu added in %d rounds (%zu one by one: ratio %.3f), %zu tetrahedra, %zu bad, %zu refused\n", before,
                added, done.rounds, sequential, double(added) / double(sequential), mesh.tetrahedra.size(), bad, done.refused);
    int failed = 0;
    const auto require = [&](bool holds, const char* what) {
        if (holds) return;
        std::fprintf(stderr, "%s\n", what);
        failed = 1;
    };
    require(done.refused == 0, "something could not be mended");
    require(bad == 0, "bad tetrahedra are left");
    require(done.rounds <= most_rounds, "more rounds than the sizes in the input explain");
    // A tenth more; in a mesh of some dozens that is a matter of few.
    require(added <= sequential + std::max<std::size_t>(sequential / 10, 8), "too many Steiner points beside those one by one");
    return failed;
}
