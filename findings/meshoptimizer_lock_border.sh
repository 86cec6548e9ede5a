#!/bin/bash
# meshoptimizer up to 0.20.0 (npm meshoptimizer; Debian 12 has 0.18): patches that were simplified with LockBorder do not join
# to a manifold. From 0.21.0 on they do here.
#
# The guess: LockBorder keeps the border as it is, so that neighbouring patches may be simplified each by itself, and put
# together are as sound as one; that is what the flag is for.
# What it does: the vertices of the border stay, but not the triangles at them. Where the border runs straight, over points in a
# row, both neighbours may leave out the same point by a triangle with hardly any area, and both make the same edge across it:
# then four triangles meet there. Each patch alone is sound. On rough but flat ground, with an error larger than the roughness,
# it happens to every pair of patches that was tried.
# What it means: with these versions, look at the edges of what was joined, and keep from the borders' chords where they repeat.
#
# Fetches its packages into a temporary folder, installs nothing, and fails if any of this changes.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
echo '{"private": true}' >package.json
npm install --silent --no-audit --no-fund --ignore-scripts old@npm:meshoptimizer@0.20.0 new@npm:meshoptimizer@0.21.0 >log 2>&1 ||
  { cat log >&2; exit 1; }

cat >look.mjs <<'JS'
// Ground of n x n cells that is rough by 5 cm, cut in two along the middle; each half is simplified within 50 cm.
function ground(n, seed) {
  const random = () => (seed = (seed * 1103515245 + 12345) & 0x7fffffff) / 0x7fffffff;
  const at = (i, j) => j * (n + 1) + i, positions = new Float32Array(3 * (n + 1) * (n + 1));
  for (let j = 0; j <= n; ++j) for (let i = 0; i <= n; ++i) positions.set([i, j, 0.05 * random()], 3 * at(i, j));
  const half = (first) => {
    const triangles = [];
    for (let j = 0; j < n; ++j)
      for (let i = first; i < first + n / 2; ++i)
        triangles.push(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1));
    return new Uint32Array(triangles);
  };
  return {positions, halves: [half(0), half(n / 2)]};
}

// Edges that more than two triangles have.
function crowded(triangles) {
  const uses = new Map();
  for (let t = 0; t < triangles.length; t += 3)
    for (let k = 0; k < 3; ++k) {
      const ends = [triangles[t + k], triangles[t + (k + 1) % 3]];
      const edge = Math.min(...ends) + '-' + Math.max(...ends);
      uses.set(edge, (uses.get(edge) ?? 0) + 1);
    }
  return [...uses.values()].filter((count) => count > 2).length;
}

const found = {};
for (const version of ['old', 'new']) {
  const {MeshoptSimplifier: simplifier} = await import(version);
  await simplifier.ready;
  let alone = 0, joined = 0;
  for (let seed = 1; seed <= 60; ++seed) {
    const {positions, halves} = ground(32 + seed % 3 * 16, 7919 * seed), scale = simplifier.getScale(positions, 3);
    const made = halves.map((half) => simplifier.simplify(half, positions, 3, 0, 0.5 / scale, ['LockBorder'])[0]);
    alone += made.some((half) => crowded(half) > 0);
    joined += crowded([...made[0], ...made[1]]) > 0;
  }
  found[version] = {alone, joined};
}
console.log(`of 60 pairs with an edge of three or more triangles: 0.20.0 ${found.old.joined} joined, ${found.old.alone} alone; ` +
            `0.21.0 ${found.new.joined} joined, ${found.new.alone} alone`);
process.exit(found.old.joined === 60 && found.new.joined === 0 && found.old.alone + found.new.alone === 0 ? 0 : 1);
JS
node look.mjs
