#!/bin/bash
# glTF-Transform 4.5.1 (npm @gltf-transform/cli) silently loses extras that its commands were not asked to touch.
#
# The guess: what has different extras is not the same, so that dedup and join leave it apart, as they do with materials of
# different extras; and merge of one file keeps what copy keeps.
# What it does: join, a part of optimize, puts meshes of two nodes into the first node, whose extras then stand for both; dedup
# takes two meshes that differ in their extras alone for one; join drops the extras of primitives; merge drops those of the asset
# and of the root, also of a single file. No command prints a word about it.
# What it means: an origin in the nodes' extras does not survive optimize where several origins were merged, and one in the
# asset's does not survive merge. Write both, and merge only files of one origin.
#
# Fetches its package into a temporary folder, installs nothing, and fails if any of this changes.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
echo '{"private": true}' >package.json
npm install --silent --no-audit --no-fund --ignore-scripts @gltf-transform/cli@4.5.1 >log 2>&1 || { cat log >&2; exit 1; }

cat >look.mjs <<'JS'
import {execFileSync} from 'node:child_process';
import {readFileSync, writeFileSync} from 'node:fs';

// Two triangles, each a mesh of a node of its own; everything that can have extras has them, and says there what it is.
const positions = new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]), indices = new Uint16Array([0, 1, 2, 0]);
const data = Buffer.concat([Buffer.from(positions.buffer), Buffer.from(indices.buffer)]);
const is = (who) => ({who});
const document = {
  asset: {version: '2.0', extras: is('asset')}, extras: is('root'), scene: 0,
  scenes: [{nodes: [0, 1], extras: is('scene')}],
  nodes: [{name: 'a', mesh: 0, extras: is('node a')}, {name: 'b', mesh: 1, translation: [5, 0, 0], extras: is('node b')}],
  meshes: [0, 1].map((k) => ({extras: is('mesh ' + k), primitives: [
    {attributes: {POSITION: 0}, indices: 1, material: k, extras: is('primitive ' + k)}]})),
  materials: [{name: 'rock', extras: is('material')}, {name: 'rock', extras: is('material')}],
  accessors: [{bufferView: 0, componentType: 5126, count: 3, type: 'VEC3', min: [0, 0, 0], max: [1, 1, 0]},
              {bufferView: 1, componentType: 5123, count: 3, type: 'SCALAR'}],
  bufferViews: [{buffer: 0, byteOffset: 0, byteLength: 36}, {buffer: 0, byteOffset: 36, byteLength: 6}],
  buffers: [{byteLength: data.length}],
};
const write = (name, json) => {
  let text = Buffer.from(JSON.stringify(json));
  text = Buffer.concat([text, Buffer.alloc(-text.length & 3, ' ')]);
  const head = Buffer.alloc(20), chunk = Buffer.alloc(8);
  [0x46546c67, 2, 28 + text.length + data.length, text.length, 0x4e4f534a].forEach((x, i) => head.writeUInt32LE(x, 4 * i));
  [data.length, 0x004e4942].forEach((x, i) => chunk.writeUInt32LE(x, 4 * i));
  writeFileSync(name, Buffer.concat([head, text, chunk, data]));
};
const run = (...words) => execFileSync('node_modules/.bin/gltf-transform', words, {encoding: 'utf8', stdio: 'pipe'});
// Which of the extras are left, and how many meshes.
const left = (name) => {
  const bytes = readFileSync(name), text = bytes.toString('utf8', 20, 20 + bytes.readUInt32LE(12));
  const extras = [...text.matchAll(/"who":"([^"]*)"/g)].map((found) => found[1]).sort().join(', ');
  return `meshes ${JSON.parse(text).meshes.length}: ${extras}`;
};

write('same.glb', document);
document.materials[1].extras = is('another material');
write('other.glb', document);
const all = 'mesh 0, mesh 1, node a, node b, primitive 0, primitive 1, root, scene';
const known = [
  ['copy', 'same.glb', `meshes 2: asset, material, material, ${all}`],
  ['dedup', 'same.glb', 'meshes 1: asset, material, mesh 0, node a, node b, primitive 0, root, scene'],
  ['dedup', 'other.glb', `meshes 2: another material, asset, material, ${all}`],  // right: extras of materials are compared
  ['join', 'same.glb', 'meshes 1: asset, material, mesh 0, node a, root, scene'],
  ['join', 'other.glb', `meshes 2: another material, asset, material, ${all}`],
  ['optimize', 'same.glb', 'meshes 1: asset, material, mesh 0, node a, root, scene'],
  ['merge', 'same.glb', `meshes 2: material, material, ${all.replace('root, ', '')}`],
];
console.log('glTF-Transform ' + run('--version').trim());
let wrong = 0;
for (const [command, file, wanted] of known) {
  const words = run(command, file, 'out.glb');
  const got = left('out.glb');
  wrong += got !== wanted;
  console.log(`${command} ${file}: ${got}` + (got === wanted ? '' : `, where "${wanted}" was seen before`));
  if (/extras/i.test(words)) console.log('It speaks of extras now: ' + words), ++wrong;
}
process.exit(wrong > 0 ? 1 : 0);
JS
node look.mjs
