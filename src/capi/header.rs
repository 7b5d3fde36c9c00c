//! Test: `include/wellspaced.h` is what cbindgen makes of this directory now.
//!
//! With WSP_BLESS=1 in the environment it is written instead (`script/header` does that).

use std::path::Path;

/// The files in the order in which the header shall tell them.
const FILES: [&str; 13] = [
    "status",
    "options",
    "control",
    "plc",
    "check",
    "triangulation",
    "view",
    "boundary",
    "steps",
    "batch",
    "refine",
    "sampler",
    "mesh_batch",
];

#[test]
fn header_is_up_to_date() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(root.join("cbindgen.toml")).expect("cbindgen.toml");
    // Files, not the crate: the core's own constants are no part of the interface.
    let mut builder = cbindgen::Builder::new().with_config(config);
    for file in FILES {
        builder = builder.with_src(root.join("src/capi").join(file).with_extension("rs"));
    }
    let mut made = Vec::new();
    builder.generate().expect("cbindgen").write(&mut made);
    let made = String::from_utf8(made).expect("cbindgen writes UTF-8");

    let path = root.join("include/wellspaced.h");
    if std::env::var_os("WSP_BLESS").is_some_and(|value| value == "1") {
        std::fs::write(&path, &made).expect("write the header");
        return;
    }
    let there = std::fs::read_to_string(&path).unwrap_or_default();
    let line = there.lines().zip(made.lines()).position(|(a, b)| a != b).unwrap_or(there.lines().count()) + 1;
    assert!(there == made, "include/wellspaced.h differs from src/capi from line {line} on: run script/header");
}

#[test]
fn every_file_of_the_interface_is_in_the_header() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/capi");
    for entry in std::fs::read_dir(root).expect("src/capi") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|extension| extension == "rs") {
            let text = std::fs::read_to_string(&path).expect("UTF-8");
            let name = path.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default().to_owned();
            let exports = text.contains("#[unsafe(no_mangle)]\npub");
            assert_eq!(exports, FILES.contains(&name.as_str()), "{name}.rs: FILES and exported functions disagree");
        }
    }
}

#[test]
fn the_headers_version_is_the_crates() {
    use super::status::{WSP_VERSION_MAJOR, WSP_VERSION_MINOR, WSP_VERSION_PATCH};
    let version = format!("{WSP_VERSION_MAJOR}.{WSP_VERSION_MINOR}.{WSP_VERSION_PATCH}");
    assert_eq!(version, env!("CARGO_PKG_VERSION"));
}
