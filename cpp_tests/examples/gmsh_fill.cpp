// gmsh makes the surface of a solid, wellspaced fills it, and gmsh has the volume mesh back, to save it or to compute on.
#include <gmsh.h>
#include <wellspaced/wellspaced.hpp>

#include <algorithm>
#include <cstdio>
#include <map>

int main() {
    gmsh::initialize();
    gmsh::option::setNumber("General.Verbosity", 2);
    gmsh::model::add("bracket");

    // A bracket: an outline with a slanted side and a corner that goes inwards, drawn out along y. One of its corners has a small edge length.
    const double outline[6][2] = {{0, 0}, {4, 0}, {4, 1.5}, {2, 1.5}, {1.5, 3.5}, {0, 3.5}};
    const int n = 6;
    std::vector<std::vector<int>> sides(2);  // the points of each plane surface: first the two ends
    for (int i = 0; i < n; ++i) {
        const int next = (i + 1) % n;
        gmsh::model::geo::addPoint(outline[i][0], 0, outline[i][1], i == 0 ? 0.1 : 2, i + 1);
        gmsh::model::geo::addPoint(outline[i][0], 3, outline[i][1], 2, n + i + 1);
        sides[0].push_back(i + 1);
        sides[1].push_back(n + i + 1);
        sides.push_back({i + 1, next + 1, n + next + 1, n + i + 1});
    }
    std::map<std::pair<int, int>, int> line;
    for (std::size_t i = 0; i < sides.size(); ++i) {
        std::vector<int> loop;
        for (std::size_t k = 0; k < sides[i].size(); ++k) {
            const int a = sides[i][k], b = sides[i][(k + 1) % sides[i].size()];
            int& made = line[std::minmax(a, b)];
            if (made == 0) made = gmsh::model::geo::addLine(std::min(a, b), std::max(a, b));
            loop.push_back(a < b ? made : -made);
        }
        gmsh::model::geo::addPlaneSurface({gmsh::model::geo::addCurveLoop(loop)}, static_cast<int>(i) + 1);
    }
    gmsh::model::geo::synchronize();
    gmsh::model::mesh::generate(2);

    // The nodes of gmsh's surface mesh become points of the domain, its plane surfaces facets; the nodes on them stay.
    std::vector<std::size_t> tags;
    std::vector<double> xyz, parameters;
    gmsh::model::mesh::getNodes(tags, xyz, parameters);
    std::map<std::size_t, std::uint32_t> number;
    for (std::size_t i = 0; i < tags.size(); ++i) number[tags[i]] = static_cast<std::uint32_t>(i);
    wsp::plc domain;
    domain.add_points(xyz);
    for (std::size_t surface = 0; surface < sides.size(); ++surface) {
        std::vector<std::uint32_t> polygon;
        for (int point : sides[surface]) {
            std::vector<std::size_t> node;
            std::vector<double> place, none;
            gmsh::model::mesh::getNodes(node, place, none, 0, point);
            polygon.push_back(number[node[0]]);
        }
        domain.add_facet(polygon, static_cast<std::int32_t>(surface) + 1);
    }
    wsp::triangulation mesh(domain);
    const wsp::report done = mesh.refine(2.0);

    // A discrete volume takes it.
    const wsp::mesh_view view = mesh.view();
    const int volume = gmsh::model::addDiscreteEntity(3);
    std::size_t last = *std::max_element(tags.begin(), tags.end());
    std::vector<std::size_t> node_of(view.vertices.size()), new_tags, connectivity, element_tags;
    std::vector<double> new_xyz;
    for (std::size_t v = 0; v < node_of.size(); ++v) {
        if (v < tags.size()) {
            node_of[v] = tags[v];
            continue;
        }
        new_tags.push_back(node_of[v] = ++last);
        new_xyz.insert(new_xyz.end(), view.vertices.data() + 3 * v, view.vertices.data() + 3 * v + 3);
    }
    for (const auto& t : view.tetrahedra)
        for (std::uint32_t v : t) connectivity.push_back(node_of[v]);
    gmsh::model::mesh::addNodes(3, volume, new_tags, new_xyz);
    gmsh::model::mesh::addElementsByType(volume, 4, {}, connectivity);

    std::vector<std::size_t> back, back_nodes;
    gmsh::model::mesh::getElementsByType(4, back, back_nodes, volume);
    std::printf("%zu surface nodes from gmsh, %zu added, %zu tetrahedra in gmsh's volume %d, worst radius-edge ratio %.3f\n",
                tags.size(), done.steiner, back.size(), volume, done.worst_radius_edge);
    const bool good = back.size() == done.tetrahedra && done.status == WSP_DONE;
    gmsh::finalize();
    return !good;
}
