# A box is shot: Kerf breaks it where the ray hits it, 4 ms a frame, and rigid bodies take its place.
#   --picture FILE.png   after the arguments of Godot: draws the end, and quits
extends Spatial

const MILLISECONDS = 4.0  # of each frame, for Kerf
const ENERGY = 900.0      # J: new walls take 100 J a square metre
const DENSITY = 500.0     # kg/m³
const SHOT_AT = 30        # frames of 1/60 s
const END_AT = 270

var library = GDNative.new()
var floor_body
var box
var solid
var breaking = null
var struck = {}  # what the ray hit
var frames = 0
var frames_of_break = 0
var pieces = []

func kerf(name, arguments):
	return library.call_native("standard_varcall", name, arguments)

func _ready():
	library.library = load("res://kerf.gdnlib")
	if not library.initialize():
		return stop("the library does not load: build it as docs/c.md says")
	$camera.look_at_from_position(Vector3(1.5, 1.5, 2.6), Vector3(0, 0.15, 0), Vector3.UP)
	$sun.look_at_from_position(Vector3(2, 5, 3), Vector3.ZERO, Vector3.UP)
	floor_body = make_body(StaticBody.new(), BoxShape.new(), CubeMesh.new(), Color(0.5, 0.5, 0.48))
	floor_body.get_child(0).shape.extents = Vector3(6, 0.5, 6)
	floor_body.get_child(1).mesh.size = Vector3(12, 1, 12)
	floor_body.translation.y = -0.5
	var mesh = CubeMesh.new()
	mesh.size = Vector3(1, 1, 1)
	box = make_body(RigidBody.new(), BoxShape.new(), mesh, Color(0.7, 0.45, 0.25))
	box.get_child(0).shape.extents = Vector3(0.5, 0.5, 0.5)
	box.mass = DENSITY
	box.translation.y = 0.5
	solid = kerf("solid", [mesh.get_faces()])
	if solid == null:
		stop("the box is no solid")

func _exit_tree():
	library.terminate()

func make_body(body, shape, mesh, color):
	var collision = CollisionShape.new()
	collision.shape = shape
	var drawn = MeshInstance.new()
	var material = SpatialMaterial.new()
	material.albedo_color = color
	drawn.mesh = mesh
	drawn.material_override = material
	body.add_child(collision)
	body.add_child(drawn)
	add_child(body)
	return body

func _physics_process(_delta):
	frames += 1
	if frames == SHOT_AT:
		shoot(Vector3(0.1, 0.8, 4), Vector3(0, 0, -1))
	elif breaking != null and pieces.empty():
		frames_of_break += 1
		if kerf("go_on", [breaking, MILLISECONDS]) == 1:
			fall_apart()
	elif frames == END_AT:
		finish()

func shoot(from, direction):
	struck = get_world().direct_space_state.intersect_ray(from, from + 100 * direction)
	if struck.empty() or struck.collider != box:
		return stop("the shot misses the box")
	struck.direction = direction
	var turn = box.global_transform.basis.inverse()
	breaking = kerf("hit", [solid, box.to_local(struck.position), turn * direction, ENERGY, MILLISECONDS])
	if breaking == null:
		stop("the box does not break")

# A body for each piece, about its centroid; those near the impact fly off.
func fall_apart():
	for told in kerf("pieces", [breaking]):
		var shape = ConvexPolygonShape.new()
		shape.points = moved(told[3], -told[1])
		shape.margin = 0.002
		var color = Color.from_hsv(0.07, 0.3 + 0.5 * randf(), 0.6 + 0.25 * randf())
		var piece = make_body(RigidBody.new(), shape, drawn_mesh(moved(told[2], -told[1])), color)
		piece.mass = DENSITY * told[0]
		piece.global_transform = box.global_transform.translated(told[1])
		var away = piece.global_transform.origin.distance_to(struck.position)
		piece.linear_velocity = box.linear_velocity + 3.0 * struck.direction / (1 + 20 * away * away)
		piece.set_meta("volume", told[0])
		pieces.append(piece)
	for handle in [breaking, solid]:
		kerf("release", [handle])
	box.queue_free()

func moved(points, by):
	for i in points.size():
		points[i] += by
	return points

# Triangles with normals of their own: edges of pieces are sharp.
func drawn_mesh(corners):
	var tool = SurfaceTool.new()
	tool.begin(Mesh.PRIMITIVE_TRIANGLES)
	tool.add_smooth_group(false)
	for corner in corners:
		tool.add_vertex(corner)
	tool.generate_normals()
	return tool.commit()

func finish():
	var volume = 0.0
	var lowest = 1e9
	var highest = -1e9
	for piece in pieces:
		volume += piece.get_meta("volume")
		lowest = min(lowest, piece.translation.y)
		highest = max(highest, piece.translation.y)
	print("%d pieces after %d frames, volume %.6f, centroids from %.3f to %.3f" % [pieces.size(), frames_of_break, volume, lowest, highest])
	var arguments = OS.get_cmdline_args()
	var picture = Array(arguments).find("--picture")
	if picture >= 0:
		var image = get_viewport().get_texture().get_data()
		image.flip_y()
		image.save_png(arguments[picture + 1])
	if pieces.size() < 5 or abs(volume - 1) > 1e-6 or lowest < 0 or highest > 1:
		return stop("the box did not fall into pieces")
	get_tree().quit()

func stop(sentence):
	printerr("kerf: " + sentence)
	set_physics_process(false)
	get_tree().quit(1)
