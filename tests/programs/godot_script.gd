extends SceneTree

# Says of each file on the command line what Godot has imported.

func _init():
	for word in OS.get_cmdline_args():
		if word.ends_with(".glb"):
			var packed = load("res://" + word)
			var found = find_mesh(packed.instance()) if packed else null
			if found:
				look(word, found.mesh)
		elif word.ends_with(".obj"):
			var mesh = load("res://" + word)
			if mesh:
				look(word, mesh)
	quit()

func find_mesh(node):
	if node is MeshInstance:
		return node
	for child in node.get_children():
		var found = find_mesh(child)
		if found:
			return found
	return null

func numbers(p):
	return [p.x, p.y, p.z]

func look(word, mesh):
	var arrays = mesh.surface_get_arrays(0)
	var places = arrays[Mesh.ARRAY_VERTEX]
	var corners = arrays[Mesh.ARRAY_INDEX]
	# AABB.expand() rounds at each call: after millions of them it is some millimetres short.
	var low = places[0]
	var high = places[0]
	for p in places:
		low = Vector3(min(low.x, p.x), min(low.y, p.y), min(low.z, p.z))
		high = Vector3(max(high.x, p.x), max(high.y, p.y), max(high.z, p.z))
	# Godot takes triangles clockwise from outside.
	var volume = 0.0
	for i in range(0, corners.size(), 3):
		volume += places[corners[i]].dot(places[corners[i + 2]].cross(places[corners[i + 1]])) / 6.0
	var answer = {
		"file": word,
		"triangles": corners.size() / 3,
		"low": numbers(low),
		"high": numbers(high),
		"volume": volume,
	}
	var colors = arrays[Mesh.ARRAY_COLOR]
	if colors != null and colors.size() > 0:
		var sum = [0.0, 0.0, 0.0]
		for c in colors:
			sum[0] += c.r
			sum[1] += c.g
			sum[2] += c.b
		answer["color"] = [sum[0] / colors.size(), sum[1] / colors.size(), sum[2] / colors.size()]
	var material = mesh.surface_get_material(0)
	if material:
		answer["materials"] = [material.resource_name]
		answer["shown"] = material.vertex_color_use_as_albedo
	print("ANSWER " + to_json(answer))
