//! Compiles CGAL's side of the oracle. Debian's libcgal-dev is header-only and needs GMP and MPFR.

fn main() {
    let sources = ["src/bridge.cpp", "../cgal/reference.cpp"];
    let headers = ["src/bridge.hpp", "../cgal/reference.hpp"];
    for file in sources.iter().chain(&headers).chain(&["src/lib.rs"]) {
        println!("cargo:rerun-if-changed={file}");
    }
    // Lints and documentation look at the Rust side only, and compiling CGAL takes a minute.
    println!("cargo:rerun-if-env-changed=WELLSPACED_ORACLE");
    if std::env::var_os("WELLSPACED_ORACLE").is_some_and(|value| value == "rust") {
        return;
    }
    cxx_build::bridge("src/lib.rs")
        .files(sources)
        .include("src")
        .include("../cgal")
        .std("c++17")
        .opt_level(2)
        // No debug information and no assertions of CGAL's own: they would double the time this takes.
        .debug(false)
        .define("NDEBUG", None)
        .define("CGAL_NDEBUG", None)
        // CGAL's interval arithmetic changes the rounding mode.
        .flag("-frounding-math")
        .flag("-Wno-unknown-warning-option")
        .compile("wellspaced_oracle");
    println!("cargo:rustc-link-lib=gmp");
    println!("cargo:rustc-link-lib=mpfr");
}
