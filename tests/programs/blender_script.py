"""Says of each file after "--" what Blender makes of it. Debian's Blender 3.4 needs numpy.bool, which newer numpy lacks.

Files joined by "+" are imported into one and the same scene; of these it says which materials the objects have.
"""
import numpy
numpy.bool = bool

import json
import sys

import bpy


def bring_in(path):
    if path.endswith(".glb"):
        bpy.ops.import_scene.gltf(filepath=path)
    elif path.endswith("_zup.obj"):
        bpy.ops.wm.obj_import(filepath=path, forward_axis="Y", up_axis="Z")
    elif path.endswith(".obj"):
        bpy.ops.wm.obj_import(filepath=path)
    elif path.endswith(".vdb"):
        bpy.ops.object.volume_import(filepath=path)
        volume = next(o for o in bpy.data.objects if o.type == "VOLUME")
        made = bpy.data.objects.new("made", bpy.data.meshes.new("made"))
        bpy.context.scene.collection.objects.link(made)
        modifier = made.modifiers.new("made", "VOLUME_TO_MESH")
        modifier.object, modifier.grid_name, modifier.threshold = volume, "surface", 0
        modifier.resolution_mode = "GRID"
        graph = bpy.context.evaluated_depsgraph_get()
        made.data = bpy.data.meshes.new_from_object(made.evaluated_get(graph))
        made.modifiers.clear()
    elif path.endswith(".stl"):
        bpy.ops.import_mesh.stl(filepath=path)
    else:
        bpy.ops.import_mesh.ply(filepath=path)


def meshes():
    return [o for o in bpy.data.objects if o.type == "MESH"]


def numbers(items, name, width, type=numpy.float32):
    out = numpy.empty(len(items) * width, type)
    items.foreach_get(name, out)
    return out.reshape(-1, width)


def mean_color(mesh):
    """Of the vertices, linear."""
    if not mesh.color_attributes:
        return None
    attribute = mesh.color_attributes[0]
    colors = numbers(attribute.data, "color", 4)[:, :3].astype(numpy.float64)
    if attribute.domain == "CORNER":
        of_vertices = numpy.zeros((len(mesh.vertices), 3))
        of_vertices[numbers(mesh.loops, "vertex_index", 1, numpy.int32)[:, 0]] = colors
        colors = of_vertices
    return colors.mean(axis=0).tolist()


def look(path):
    made = meshes()[0]
    mesh = made.data
    mesh.calc_loop_triangles()
    mesh.calc_normals_split()
    turn = numpy.array(made.matrix_world)
    places = numbers(mesh.vertices, "co", 3).astype(numpy.float64) @ turn[:3, :3].T + turn[:3, 3]
    corners = numbers(mesh.loop_triangles, "vertices", 3, numpy.int32)
    a, b, c = (places[corners[:, k]] for k in range(3))
    across = numpy.cross(b - a, c - a)
    areas = numpy.linalg.norm(across, axis=1) / 2
    loops = numbers(mesh.loop_triangles, "loops", 3, numpy.int32)
    shading = numbers(mesh.loops, "normal", 3)[loops].sum(axis=1) @ turn[:3, :3].T
    origin = made.get("world_origin")
    return {
        "triangles": len(corners),
        "low": places.min(axis=0).tolist(),
        "high": places.max(axis=0).tolist(),
        "area": float(areas.sum()),
        "volume": float((a * across).sum() / 6),
        # The share of the area whose normals for shading look into the rock.
        "inward": float(areas[(shading * across).sum(axis=1) < 0].sum() / areas.sum()),
        "color": mean_color(mesh),
        "smooth": mesh.has_custom_normals,
        "origin": list(origin) if origin else None,
        "crs": made.get("crs"),
        "materials": [slot.name for slot in made.material_slots],
    }


for word in sys.argv[sys.argv.index("--") + 1:]:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for path in word.split("+"):
        bring_in(path)
    if "+" in word:
        said = {"materials": sorted(slot.name for o in meshes() for slot in o.material_slots)}
    else:
        said = look(word)
    print("ANSWER " + json.dumps({"file": word, **said}), flush=True)
