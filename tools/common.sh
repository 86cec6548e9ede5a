# shellcheck shell=bash
# Sourced by the scripts in the root and in tools/. Sets `root`, and stops on the first error.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
export NINJA_STATUS='building %f of %t, %es  '

say() { printf '\n== %s\n' "$*"; }

seconds() { printf '%dm%02ds' $(($1 / 60)) $(($1 % 60)); }

# build PRESET [TARGET...]: configures when there is no build tree yet (ninja itself runs CMake again when
# its files change) and builds.
build() {
  local preset=$1
  shift
  local dir=$root/build/$preset
  if [[ ! -f $dir/build.ninja ]]; then
    say "configuring $preset"
    (cd "$root" && cmake --preset "$preset" --log-level=WARNING >/dev/null)
  fi
  say "building $preset"
  local targets=()
  [[ $# -gt 0 ]] && targets=(--target "$@")
  cmake --build "$dir" "${targets[@]}"
}

# The project's C++ files, one a line, relative to the root.
sources() {
  (cd "$root" && find src apps tests bench examples \( -name '*.cpp' -o -name '*.h' \) -type f 2>/dev/null | sort)
}
