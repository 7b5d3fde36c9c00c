// A mesher of one page that keeps plain arrays, and wellspaced's Steiner points in it: 'batch, insert, repeat'.
//
//     array_mesher FILE [BETA]     FILE: a .poly of points in a box
//
// The mesher is Bowyer and Watson's: the tetrahedra whose circumspheres hold a new point make room for those that join it to their
// outline. It knows nothing of wellspaced but two exact predicates; yours may have its own.
#include <wellspaced/wellspaced.hpp>

#include <algorithm>
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
        std::int32_t sign = 0;
        wsp::check(wsp_orientation(points[t[0]].data(), points[t[1]].data(), points[t[2]].data(), points[t[3]].data(), &sign));
        return sign;
    }
    int side_of_sphere(const tetrahedron& t, const wsp::point& p) const {
        std::int32_t sign = 0;
        wsp::check(wsp_side_of_sphere(points[t[0]].data(), points[t[1]].data(), points[t[2]].data(), points[t[3]].data(),
                                      p.data(), &sign));
        return sign;
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

// The whole connection to wellspaced: returns the number of rounds.
int refine(mesher& mesh, const wsp::sampler_options& options) {
    for (int round = 0;; ++round) {
        mesh.compact();
        const wsp::mesh_batch batch(wsp::mesh_arrays(mesh.points, mesh.tetrahedra, mesh.neighbours), options);
        if (batch.empty()) {
            if (batch.refused() > 0) std::printf("%zu bad tetrahedra could not be mended\n", batch.refused());
            return round;
        }
        for (const wsp_steiner_point& p : batch.points()) mesh.insert({p.xyz[0], p.xyz[1], p.xyz[2]}, p.tetrahedron);
    }
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
    const int rounds = refine(mesh, wsp::sampler_options(radius_edge));
    const std::size_t added = mesh.points.size() - before;

    // Beside it, the same domain in wellspaced's own triangulation, one edge after the other.
    wsp::plc box;
    box.add_box(low, high);
    box.add_points(input);
    wsp::triangulation own(box);
    wsp::refine_options alone(radius_edge);
    alone.sparsify = WSP_SPARSIFY_OFF;  // rounds take nothing away again
    const std::size_t sequential = own.refine(alone).steiner;
    std::printf("%zu points in, %zu added in %d rounds (%zu one by one: ratio %.3f), %zu tetrahedra\n", before, added, rounds,
                sequential, double(added) / double(sequential), mesh.tetrahedra.size());
    // A tenth more, and ten points where there are few.
    return added > sequential + sequential / 10 + 10;
}
