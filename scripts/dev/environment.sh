# Sourced by scripts/test, scripts/dev/check, scripts/dev/docs and scripts/dev/soak: the project's folder, its tools from PyPI, and lists of results.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

# Tests write the names of skipped tests to this file, with the reason. A script called by another one adds to its list.
mkdir -p target
if [ -z "${ROCKING_BLOCK_SKIPPED-}" ]; then
  export ROCKING_BLOCK_SKIPPED=$PWD/target/skipped.txt
  : >"$ROCKING_BLOCK_SKIPPED"
fi

# Git's bash on Windows, where Python has other names and folders.
case ${OSTYPE:-} in
msys* | cygwin*) python=.venv/Scripts/python.exe system_python=python ;;
*) python=.venv/bin/python system_python=python3 ;;
esac
# Compiles the dependencies that do little work without optimization.
quick=$PWD/scripts/dev/quick.toml
cargo() {
  command cargo --config "$quick" "$@"
}
# Optimized, so that they share the libraries of `cargo run --release`: a package whose dependencies have other features, as those
# left out here, would have these compiled once more. The engine of the Python package is tested from Python.
cargo_test=(cargo test --release --locked --workspace ${ROCKING_BLOCK_FEATURES:+--features "$ROCKING_BLOCK_FEATURES"}
  --exclude importer-tests --exclude packaging --exclude rocking-benches --exclude rocking-block-fmu3-wasm --exclude rocking-block-python)
# The program and the FMUs.
cargo_release=(build --release --locked ${ROCKING_BLOCK_FEATURES:+--features "$ROCKING_BLOCK_FEATURES"})
made=$(realpath --canonicalize-missing "${CARGO_TARGET_DIR:-target}")/release

# Runs a command under a heading, and prints its duration and its CPU time.
TIMEFORMAT=$'== %0R s, %0U s of CPU'
step() {
  printf '\n== %s\n' "$*"
  time "$@"
}

# Installs requirement files into .venv.
install() {
  [ -x "$python" ] || "$system_python" -m venv .venv
  "$python" -m pip install --quiet --disable-pip-version-check "${@/#/--requirement=}"
}

# Prints the skipped tests, and how often each was skipped.
report_skipped() {
  printf '\n== skipped: %s\n' "$(wc -l <"$ROCKING_BLOCK_SKIPPED")"
  sort "$ROCKING_BLOCK_SKIPPED" | uniq -c
}
