tool
extends EditorScenePostImport

func post_import(scene):
	for child in scene.get_children():
		if child is MeshInstance:
			var material = child.mesh.surface_get_material(0)
			material.vertex_color_use_as_albedo = true
			if material.resource_path != "":
				ResourceSaver.save(material.resource_path, material)
	return scene
