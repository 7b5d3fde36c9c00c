/* Refines a cube's corners and a point near one: small, but it runs the whole library. */
#include <stdio.h>

#include <wellspaced.h>

static int failed(const char *call) {
    fprintf(stderr, "%s: %s\n", call, wsp_last_error());
    return 1;
}

int main(void) {
    double xyz[3 * 9];
    wsp_triangulation *triangulation = NULL;
    wsp_refine_options options;
    wsp_report report;
    int i, k;

    for (i = 0; i < 8; ++i)
        for (k = 0; k < 3; ++k)
            xyz[3 * i + k] = i >> k & 1 ? 1.0 : -1.0;
    xyz[24] = xyz[25] = xyz[26] = 0.9;

    if (wsp_abi_version() != WSP_ABI_VERSION) {
        fprintf(stderr, "header and library disagree\n");
        return 1;
    }
    if (wsp_triangulation_new(NULL, &triangulation) < 0)
        return failed("new");
    if (wsp_triangulation_insert(triangulation, xyz, 9, NULL, NULL) < 0)
        return failed("insert");
    if (wsp_refine_options_init(&options, sizeof options) < 0 || wsp_report_init(&report, sizeof report) < 0)
        return failed("init");
    options.radius_edge = 1.5;
    if (wsp_refine(triangulation, &options, NULL, &report) != WSP_DONE)
        return failed("refine");
    wsp_triangulation_free(triangulation);
    printf("%s: %lu tetrahedra, %lu bad\n", wsp_version(), (unsigned long)report.tetrahedra,
           (unsigned long)report.bad);
    return report.bad != 0 || report.tetrahedra == 0;
}
