// gmsh makes the surface of a solid, wellspaced fills it, and gmsh has the mesh back, to save it or to compute on. Its surfaces and curves take
// the faces and edges of the new mesh, which conforms to them.
#include <gmsh.h>
#include <wellspaced/wellspaced.hpp>

#include <algorithm>
#include <array>
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

    // The nodes of gmsh's surface mesh become points of the domain, its plane surfaces facets; the nodes on them stay. Equal points apart, a point's
    // vertex has its number.
    std::vector<std::size_t> tags;
    std::vector<double> xyz, parameters;
    std::vector<std::pair<int, int>> entity_of;  // of each node: what it lies on
    gmsh::vectorpair entities;
    gmsh::model::getEntities(entities);
    for (const auto& entity : entities) {
        std::vector<std::size_t> some;
        std::vector<double> places;
        gmsh::model::mesh::getNodes(some, places, parameters, entity.first, entity.second);
        tags.insert(tags.end(), some.begin(), some.end());
        xyz.insert(xyz.end(), places.begin(), places.end());
        entity_of.insert(entity_of.end(), some.size(), entity);
    }
    std::map<std::size_t, std::uint32_t> number;
    for (std::size_t i = 0; i < tags.size(); ++i) number[tags[i]] = static_cast<std::uint32_t>(i);
    wsp::plc domain;
    domain.add_points(xyz);
    const auto node_at = [&](int point) {
        std::vector<std::size_t> node;
        std::vector<double> place, none;
        gmsh::model::mesh::getNodes(node, place, none, 0, point);
        return number[node[0]];
    };
    for (std::size_t surface = 0; surface < sides.size(); ++surface) {
        std::vector<std::uint32_t> polygon;
        for (int point : sides[surface]) polygon.push_back(node_at(point));
        domain.add_facet(polygon, static_cast<std::int32_t>(surface) + 1);
    }
    // Markers tell whose faces and edges come back: gmsh's tags of surfaces and curves.
    for (const auto& [ends, tag] : line) {
        const std::array<std::uint32_t, 2> segment{node_at(ends.first), node_at(ends.second)};
        domain.add_segments({&segment, 1}, {&tag, 1});
    }
    wsp::triangulation mesh(domain);
    const wsp::report done = mesh.refine(2.0);

    // gmsh's own mesh gives way to it; a discrete volume takes the tetrahedra. New nodes belong to what they lie on.
    const wsp::mesh_view view = mesh.view();
    const wsp::boundary_view boundary = mesh.boundary();
    gmsh::model::mesh::clear();
    const int volume = gmsh::model::addDiscreteEntity(3);
    std::size_t last = *std::max_element(tags.begin(), tags.end());
    std::map<std::uint32_t, int> curve_of;
    for (std::size_t i = 0; i < boundary.edges.size(); ++i) curve_of[boundary.edge_segments[i]] = boundary.edge_markers[i];
    std::vector<std::size_t> node_of(tags);
    struct entity_nodes {
        std::vector<std::size_t> tags;
        std::vector<double> xyz;
    };
    std::map<std::pair<int, int>, entity_nodes> nodes_on;
    for (std::size_t v = 0; v < view.vertices.size(); ++v) {
        if (v >= tags.size()) {
            const std::uint32_t element = boundary.vertex_elements[v];
            const int kind = boundary.vertex_kinds[v];
            node_of.push_back(++last);
            entity_of.push_back(kind == WSP_ON_SEGMENT ? std::make_pair(1, curve_of.at(element))
                                : kind == WSP_ON_FACET ? std::make_pair(2, static_cast<int>(element) + 1)
                                                       : std::make_pair(3, volume));
        }
        entity_nodes& list = nodes_on[entity_of[v]];
        list.tags.push_back(node_of[v]);
        list.xyz.insert(list.xyz.end(), view.vertices.data() + 3 * v, view.vertices.data() + 3 * v + 3);
    }
    for (const auto& [entity, list] : nodes_on) gmsh::model::mesh::addNodes(entity.first, entity.second, list.tags, list.xyz);
    std::map<int, std::vector<std::size_t>> lines, triangles;
    for (std::size_t i = 0; i < boundary.edges.size(); ++i)
        for (std::uint32_t v : boundary.edges[i]) lines[boundary.edge_markers[i]].push_back(node_of[v]);
    for (std::size_t i = 0; i < boundary.faces.size(); ++i)
        for (std::uint32_t v : boundary.faces[i]) triangles[boundary.face_markers[i]].push_back(node_of[v]);
    for (const auto& [curve, nodes] : lines) gmsh::model::mesh::addElementsByType(curve, 1, {}, nodes);
    for (const auto& [surface, nodes] : triangles) gmsh::model::mesh::addElementsByType(surface, 2, {}, nodes);
    std::vector<std::size_t> connectivity;
    for (const auto& t : view.tetrahedra)
        for (std::uint32_t v : t) connectivity.push_back(node_of[v]);
    gmsh::model::mesh::addElementsByType(volume, 4, {}, connectivity);

    std::vector<std::size_t> back, back_nodes;
    gmsh::model::mesh::getElementsByType(4, back, back_nodes, volume);
    std::printf("%zu surface nodes from gmsh, %zu added, %zu tetrahedra in gmsh's volume %d, worst radius-edge ratio %.3f\n",
                tags.size(), done.steiner, back.size(), volume, done.worst_radius_edge);

    // The mesh that gmsh has conforms: each of its triangles is a face of one tetrahedron, and no other face belongs to but one.
    std::map<std::array<std::size_t, 3>, int> faces;
    const auto face = [&](std::size_t a, std::size_t b, std::size_t c) -> int& {
        std::array<std::size_t, 3> key{a, b, c};
        std::sort(key.begin(), key.end());
        return faces[key];
    };
    for (std::size_t i = 0; i < back_nodes.size(); i += 4) {
        const std::size_t* t = back_nodes.data() + i;
        ++face(t[0], t[1], t[2]), ++face(t[0], t[1], t[3]), ++face(t[0], t[2], t[3]), ++face(t[1], t[2], t[3]);
    }
    std::vector<std::size_t> surface_elements, surface_nodes;
    gmsh::model::mesh::getElementsByType(2, surface_elements, surface_nodes);
    bool conforms = !surface_nodes.empty();
    for (std::size_t i = 0; i < surface_nodes.size(); i += 3)
        conforms = conforms && face(surface_nodes[i], surface_nodes[i + 1], surface_nodes[i + 2])++ == 1;
    for (const auto& [nodes, count] : faces) conforms = conforms && count == 2;
    std::printf("%zu triangles on its surfaces, %s\n", surface_elements.size(), conforms ? "which conform" : "which DON'T CONFORM");
    const bool good = conforms && back.size() == done.tetrahedra && done.status == WSP_DONE;
    gmsh::finalize();
    return !good;
}
