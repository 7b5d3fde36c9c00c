// The floating-point mode of a host: WELLSPACED_TEST_MODE says which, and each call of the library is made in it. Around the calls the mode is the
// usual one, in which what is compared with works.
#ifndef WELLSPACED_TEST_HOST_MODE_HPP
#define WELLSPACED_TEST_HOST_MODE_HPP

#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#if defined(__x86_64__) || defined(_M_X64)
#include <immintrin.h>
#endif

namespace host_mode {

#if defined(__x86_64__) || defined(_M_X64)
using word = std::uint32_t;
inline word get() { return _mm_getcsr(); }
inline void set(word mode) { _mm_setcsr(mode); }
inline word bits(const std::string& name) {
    if (name == "down") return 0x2000;
    if (name == "up") return 0x4000;
    if (name == "zero") return 0x6000;
    if (name == "ftz") return 0x8000;
    if (name == "daz") return 0x0040;
    if (name == "up_ftz_daz") return 0x4000 | 0x8040;
#elif defined(__aarch64__)
using word = std::uint64_t;
inline word get() {
    word mode;
    asm volatile("mrs %0, fpcr" : "=r"(mode));
    return mode;
}
inline void set(word mode) { asm volatile("msr fpcr, %0" : : "r"(mode)); }
inline word bits(const std::string& name) {
    if (name == "up") return word{1} << 22;
    if (name == "down") return word{2} << 22;
    if (name == "zero") return word{3} << 22;
    // Results and operands alike.
    if (name == "ftz" || name == "daz") return word{1} << 24;
    if (name == "up_ftz_daz") return word{1} << 22 | word{1} << 24;
#else
#error "no floating-point modes are known for this processor"
#endif
    throw std::runtime_error("WELLSPACED_TEST_MODE: no mode is called " + name);
}

// What differs from the usual mode.
inline word asked() {
    static const word mode = [] {
        const char* name = std::getenv("WELLSPACED_TEST_MODE");
        return name == nullptr || *name == '\0' ? word{0} : bits(name);
    }();
    return mode;
}

// Calls the library in the mode asked for, which it must leave as it was.
template <class Call>
auto in_mode(const Call& call) {
    const word usual = get(), mode = usual | asked();
    set(mode);
    const auto answer = call();
    const word left = get();
    set(usual);
    if (left != mode) throw std::runtime_error("the library has changed the floating-point mode");
    return answer;
}

}  // namespace host_mode

#endif
