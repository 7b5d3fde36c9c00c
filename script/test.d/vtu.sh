#!/bin/sh
# The command's .vtu files, read by another program (Debian's python3-meshio).
set -eu
cd "$(dirname "$0")/../.."
PATH="${CARGO_HOME:-$HOME/.cargo}/bin:$PATH"
cargo build --locked --quiet --release --features cli --bin wellspaced
/usr/bin/python3 cpp_tests/check_vtu.py "${CARGO_TARGET_DIR:-target}/release/wellspaced"
