"""Says of each file after "--" what Blender makes of it. Debian's Blender 3.4 needs numpy.bool, which newer numpy lacks."""
import numpy
numpy.bool = bool

import json
import sys

import bmesh
import bpy

for path in sys.argv[sys.argv.index("--") + 1:]:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if path.endswith(".glb"):
        bpy.ops.import_scene.gltf(filepath=path)
    elif path.endswith(".obj"):
        bpy.ops.wm.obj_import(filepath=path)
    else:
        bpy.ops.import_mesh.ply(filepath=path)
    meshes = [o for o in bpy.data.objects if o.type == "MESH"]
    made = meshes[0]
    shape = bmesh.new()
    shape.from_mesh(made.data)
    shape.transform(made.matrix_world)
    origin = made.get("world_origin")
    print("ANSWER " + json.dumps({
        "file": path,
        "triangles": sum(len(f.verts) - 2 for f in shape.faces),
        "volume": abs(shape.calc_volume(signed=True)),
        "top": max(v.co.z for v in shape.verts),
        "colors": len(made.data.color_attributes) > 0,
        "origin": list(origin) if origin else None,
    }), flush=True)
    shape.free()
