#!/bin/sh
# Runs the Khronos glTF validator on GLB files: fails on any error, warning, info or hint.
#   tests/gltf_validate.sh [--install] FILE...
# The validator is the npm package gltf-validator, looked for in build/node (or $TAFONI_NODE); --install puts
# it there. Exit code 77: it is not installed, so nothing was checked.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
folder=${TAFONI_NODE:-$here/../build/node}
if [ "${1:-}" = --install ]; then
  shift
  if [ ! -d "$folder/node_modules/gltf-validator" ] && command -v npm >/dev/null; then
    mkdir -p "$folder"
    npm install --silent --no-audit --no-fund --prefix "$folder" gltf-validator@2.0.0-dev.3.10 >&2 || true
  fi
fi
if ! command -v node >/dev/null || [ ! -d "$folder/node_modules/gltf-validator" ]; then
  echo "gltf_validate: skipped, the npm package gltf-validator is not installed in $folder" >&2
  exit 77
fi
[ $# -gt 0 ] || exit 0
TAFONI_NODE=$folder exec node "$here/gltf_validate.mjs" "$@"
