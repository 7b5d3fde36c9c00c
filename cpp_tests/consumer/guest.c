/* A plugin that uses the library for itself: it refines a cube and answers with the number of tetrahedra, 0 on failure. */
#include <wellspaced.h>

size_t guest_refine(double radius_edge);

size_t guest_refine(double radius_edge) {
    const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1}, p[6] = {0.5, 0.5, 0.5, 0.51, 0.5, 0.5};
    wsp_plc *plc = NULL;
    wsp_triangulation *mesh = NULL;
    wsp_refine_options options;
    size_t tetrahedra = 0;

    if (wsp_plc_new(&plc) == WSP_DONE && wsp_plc_add_box(plc, low, high, 1, NULL) == WSP_DONE &&
        wsp_plc_add_points(plc, p, 2, NULL, NULL) == WSP_DONE &&
        wsp_triangulation_from_plc(plc, NULL, NULL, &mesh) == WSP_DONE &&
        wsp_refine_options_init(&options, sizeof options) == WSP_DONE) {
        options.radius_edge = radius_edge;
        if (wsp_refine(mesh, &options, NULL, NULL) == WSP_DONE) wsp_triangulation_counts(mesh, NULL, &tetrahedra);
    }
    wsp_triangulation_free(mesh);
    wsp_plc_free(plc);
    return tetrahedra;
}
