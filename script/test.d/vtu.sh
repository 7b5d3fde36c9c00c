#!/bin/sh
# The command's files of meshes, read by another program (Debian's python3-meshio).
set -eu
cd "$(dirname "$0")/../.."
PATH="${CARGO_HOME:-$HOME/.cargo}/bin:$PATH"
cargo build --locked --quiet --release --features cli --bin wellspaced
for check in vtu formats; do
    /usr/bin/python3 cpp_tests/check_$check.py "${CARGO_TARGET_DIR:-target}/release/wellspaced"
done
