// Handles on several threads at once, as the header allows: distinct handles, readers of one handle, a control that another thread cancels, the threads of one
// bulk insertion and of one pass over Steiner points. For thread checkers.
//
//   concurrent [POINTS]
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

#include "wellspaced/wellspaced.hpp"

namespace {

std::vector<double> scattered(std::size_t count, std::uint64_t state) {
    std::vector<double> xyz(3 * count);
    for (double& x : xyz) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        x = static_cast<double>(state >> 11) / 9007199254740992.0;
    }
    return xyz;
}

std::atomic<int> faults{0};

void require(bool holds, const char* what) {
    if (holds) return;
    std::fprintf(stderr, "concurrent: %s: %s\n", what, wsp_last_error());
    ++faults;
}

wsp_triangulation* triangulation(std::uint32_t threads) {
    wsp_triangulation_options options;
    wsp_triangulation_options_init(&options, sizeof options);
    options.threads = threads;
    wsp_triangulation* t = nullptr;
    require(wsp_triangulation_new(&options, &t) == WSP_DONE, "new");
    return t;
}

void own_handle(std::size_t count, std::uint64_t seed) {
    const auto points = scattered(count, seed);
    wsp_triangulation* t = triangulation(1);
    require(wsp_triangulation_insert(t, points.data(), count, nullptr, nullptr) == WSP_DONE, "insert");
    require(wsp_refine(t, nullptr, nullptr, nullptr) >= 0, "refine");
    require(wsp_triangulation_validate(t, WSP_VALIDATE_TOPOLOGY, 0) == WSP_DONE, "validate");
    wsp_triangulation_free(t);
}

void read(const wsp_triangulation* t) {
    wsp_mesh_view view;
    wsp_mesh_view_init(&view, sizeof view);
    require(wsp_triangulation_view(t, &view) == WSP_DONE && view.tetrahedra_count > 0, "view");
    const double p[3] = {0.5, 0.5, 0.5};
    wsp_location location;
    require(wsp_triangulation_locate(t, p, WSP_NONE, &location) == WSP_DONE, "locate");
    std::size_t bad = 0;
    require(wsp_bad_short_edges(t, 1.5, nullptr, 0, &bad) == WSP_DONE && bad > 0, "bad edges");
}

template <class... Work>
void at_once(Work... work) {
    std::vector<std::thread> threads;
    (threads.emplace_back(work), ...);
    for (auto& thread : threads) thread.join();
}

}  // namespace

int main(int argc, char** argv) {
    const std::size_t count = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 20000;
    // Which instructions the processor has is looked up at the first use and stored atomically, as every thread would store it: valgrind's checkers don't know
    // atomics, and they can't be told of one place without all that reads it.
    own_handle(50, 5);
    at_once([=] { own_handle(count / 8, 1); }, [=] { own_handle(count / 8, 2); });

    const auto points = scattered(count, 3);
    wsp_triangulation* t = triangulation(1);
    require(wsp_triangulation_insert(t, points.data(), count, nullptr, nullptr) == WSP_DONE, "insert");
    at_once([=] { read(t); }, [=] { read(t); }, [=] { read(t); });

    wsp_control* control = nullptr;
    require(wsp_control_new(nullptr, nullptr, &control) == WSP_DONE, "control");
    at_once([=] { require(wsp_refine(t, nullptr, control, nullptr) >= 0, "refine"); }, [=] { wsp_control_cancel(control); });
    wsp_control_free(control);
    require(wsp_triangulation_validate(t, WSP_VALIDATE_TOPOLOGY, 0) == WSP_DONE, "validate");
    wsp_triangulation_free(t);

    // So many that they are divided among threads.
    const std::size_t many = 70000;
    const auto cloud = scattered(many, 4);
    t = triangulation(2);
    require(wsp_triangulation_insert(t, cloud.data(), many, nullptr, nullptr) == WSP_DONE, "insert many");
    wsp_triangulation_free(t);

    t = triangulation(2);
    require(wsp_triangulation_insert(t, points.data(), count / 8, nullptr, nullptr) == WSP_DONE, "insert");
    require(wsp_refine(t, nullptr, nullptr, nullptr) >= 0, "refine");
    require(wsp_sparsify_mesh(t, 2.0, WSP_SPARSIFY_QUICK, nullptr, nullptr) >= 0, "sparsify");
    wsp_triangulation_free(t);
    std::printf("%d faults\n", faults.load());
    return faults != 0;
}
