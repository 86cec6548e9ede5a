#!/bin/bash
# Blender 3.4.1's modifier "Volume to Mesh" moves the surface of an OpenVDB level set by half a voxel along x, y and z.
#
# The guess: the mesh lies where OpenVDB's own volumeToMesh puts it, which Blender calls, since the samples of a grid lie at whole
# index coordinates; a sphere about (0, 0, 0) becomes a mesh about (0, 0, 0).
# What it does: it adds half the size of the voxels that it meshes with, here 1 m of 2 m; where the modifier resamples to 1 m,
# that is 0.5 m. (Its source says: "Better align generated mesh with volume (see T85312)".)
# To be right all the same: move the mesh by minus half a voxel on each axis.
#
# Fetches Debian 12's packages with all that they need (400 MB) into a temporary folder (2 GB), installs nothing, and fails if
# any of this changes.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
chmod 755 .
mkdir -p archives/partial tree
: >status  # as if nothing were installed, so that all is fetched
apt-get install -y -q --download-only --no-install-recommends -o Dir::State::status="$work/status" \
  -o Dir::Cache::archives="$work/archives" blender=3.4.1+dfsg-2+b1 python3-numpy python3-openvdb >log 2>&1 ||
  { tail -n 20 log >&2; exit 1; }
for package in archives/*.deb; do dpkg-deb -x "$package" tree; done
rm -r archives

libraries=$(find tree/lib tree/usr/lib -name '*.so*' -printf '%h\n' | sort -u | sed "s|^|$work/|" | paste -sd:)
# Blender takes Python's modules from beside the first python3 of PATH.
export PATH="$work/tree/usr/bin:$PATH" BLENDER_SYSTEM_SCRIPTS="$work/tree/usr/share/blender/scripts" \
  BLENDER_SYSTEM_DATAFILES="$work/tree/usr/share/blender/datafiles" HOME="$work"
inside() {
  "$work/tree/lib64/ld-linux-x86-64.so.2" --library-path "$libraries" "$work/tree/usr/bin/$1" "${@:2}"
}

cat >sphere.py <<'PY'
import pyopenvdb

grid = pyopenvdb.createLevelSetSphere(radius=10.0, center=(0, 0, 0), voxelSize=2.0, halfWidth=3.0)
grid.name = "surface"
points, _, _ = grid.convertToPolygons(isovalue=0, adaptivity=0)
middle = (points.min(axis=0) + points.max(axis=0)) / 2
print("SEEN OpenVDB " + ".".join(map(str, pyopenvdb.LIBRARY_VERSION)) + ": middle", *(f"{x:.3f}" for x in middle))
pyopenvdb.write("sphere.vdb", grids=[grid])
PY
cat >look.py <<'PY'
import os

import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.object.volume_import(filepath=os.path.abspath("sphere.vdb"))
volume = next(o for o in bpy.data.objects if o.type == "VOLUME")
for mode, size in (("GRID", 2.0), ("VOXEL_SIZE", 1.0)):
    made = bpy.data.objects.new("made", bpy.data.meshes.new("made"))
    bpy.context.scene.collection.objects.link(made)
    modifier = made.modifiers.new("made", "VOLUME_TO_MESH")
    modifier.object, modifier.grid_name, modifier.threshold = volume, "surface", 0
    modifier.resolution_mode, modifier.voxel_size = mode, size
    mesh = made.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    places = [v.co for v in mesh.vertices]
    middle = [(min(p[k] for p in places) + max(p[k] for p in places)) / 2 for k in range(3)]
    print(f"SEEN Blender {bpy.app.version_string}, {mode} {size:g} m: middle", *(f"{x:.3f}" for x in middle))
PY
PYTHONPATH="$work/tree/usr/lib/python3/dist-packages" PYTHONHOME="$work/tree/usr" inside python3.11 sphere.py |
  sed 's/-0\.000/0.000/g' >seen
inside blender -b --factory-startup -noaudio --python-exit-code 1 --python look.py >blender.log 2>&1 ||
  { tail -n 20 blender.log >&2; exit 1; }
grep '^SEEN' blender.log >>seen
cat >known <<'TXT'
SEEN OpenVDB 10.0.1: middle 0.000 0.000 0.000
SEEN Blender 3.4.1, GRID 2 m: middle 1.000 1.000 1.000
SEEN Blender 3.4.1, VOXEL_SIZE 1 m: middle 0.500 0.500 0.500
TXT
cat seen
diff known seen >difference || { echo "Before, this was seen:"; cat known; exit 1; }
