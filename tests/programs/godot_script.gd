extends SceneTree

# Says of each file on the command line what Godot has imported.

func _init():
	for word in OS.get_cmdline_args():
		if word.ends_with(".glb"):
			look(word)
	quit()

func find_mesh(node):
	if node is MeshInstance:
		return node
	for child in node.get_children():
		var found = find_mesh(child)
		if found:
			return found
	return null

func look(word):
	var packed = load("res://" + word)
	if packed == null:
		return
	var found = find_mesh(packed.instance())
	if found == null:
		return
	var arrays = found.mesh.surface_get_arrays(0)
	var material = found.mesh.surface_get_material(0)
	var colors = arrays[Mesh.ARRAY_COLOR]
	var differ = false
	if colors != null:
		for i in range(colors.size()):
			# Bytes that are misread are all 0 or 1.
			if colors[i].r > 0.02 and colors[i].r < 0.98:
				differ = true
				break
	var box = found.mesh.get_aabb()
	print("ANSWER " + to_json({
		"file": word,
		"triangles": arrays[Mesh.ARRAY_INDEX].size() / 3,
		"top": box.position.y + box.size.y,
		"material": material.resource_name,
		"shown": material.vertex_color_use_as_albedo,
		"colors_differ": differ,
	}))
