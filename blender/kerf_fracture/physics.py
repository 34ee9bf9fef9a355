"""Rigid bodies for pieces, and fixed constraints that break for the bonds between them."""

import bpy

from . import build


def world(scene):
    """The scene's rigid body world, made when it is not there, with its collections."""
    if scene.rigidbody_world is None:
        bpy.ops.rigidbody.world_add()
    found = scene.rigidbody_world
    for name, kind in (("collection", "RigidBodyWorld"), ("constraints", "RigidBodyConstraints")):
        if getattr(found, name) is None:
            setattr(found, name, bpy.data.collections.new(kind))
    return found


def step_seconds(scene):
    """The length of a step of the rigid body world. Blender compares the impulse in one step with a constraint's threshold."""
    fps = scene.render.fps / scene.render.fps_base
    found = world(scene)
    return found.time_scale / (fps * found.substeps_per_frame)


def add_bodies(scene, pieces, hulls, density, at_rest, like):
    """Makes the pieces rigid bodies. Their shapes are the hulls that are their children, or else their own convex hulls. `like`, the
    broken object, gives friction and bounciness, and leaves the world."""
    found = world(scene)
    old = like.rigid_body
    for piece in pieces:
        found.collection.objects.link(piece)
        body = piece.rigid_body
        body.type, body.mass = "ACTIVE", max(density * piece["volume"], 1e-3)  # Blender's least mass
        body.collision_shape, body.use_margin, body.collision_margin = "CONVEX_HULL", True, 0.0
        if old:
            body.friction, body.restitution = old.friction, old.restitution
            body.collision_collections = old.collision_collections
        if at_rest:
            body.use_deactivation = body.use_start_deactivated = True
    for hull in hulls:
        found.collection.objects.link(hull)
        hull.rigid_body.collision_shape, hull.rigid_body.use_margin, hull.rigid_body.collision_margin = "CONVEX_HULL", True, 0.0
        hull.parent.rigid_body.collision_shape = "COMPOUND"
    if old:
        with bpy.context.temp_override(object=like):
            bpy.ops.rigidbody.object_remove()


def release(scene, pieces):
    """Pieces follow the animated object that they are below until the present frame, and are bodies from the next on."""
    first, now = world(scene).point_cache.frame_start, scene.frame_current
    for piece in pieces:
        for kinematic, frame in ((True, min(first, now)), (False, now + 1)):
            piece.rigid_body.kinematic = kinematic
            piece.keyframe_insert("rigid_body.kinematic", frame=frame)


def add_bonds(scene, source, above, pieces, bonds, strength):
    """Adds an empty for each bond, with a fixed constraint that breaks at `strength`, in force per area, times the bond's area."""
    found = world(scene)
    below = build.collection(f"{source.name} Bonds", above)
    seconds = step_seconds(scene)
    made = []
    for bond in bonds:
        empty = bpy.data.objects.new(f"{source.name}_bond_{bond.a:03}_{bond.b:03}", None)
        empty.empty_display_size = 0.25 * bond.area**0.5
        below.objects.link(empty)
        build.place(empty, source, bond.centroid)
        found.constraints.objects.link(empty)
        constraint = empty.rigid_body_constraint
        constraint.type, constraint.object1, constraint.object2 = "FIXED", pieces[bond.a], pieces[bond.b]
        constraint.disable_collisions = True
        constraint.use_breaking, constraint.breaking_threshold = True, strength * bond.area * seconds
        empty["area"] = bond.area
        made.append(empty)
    return made
