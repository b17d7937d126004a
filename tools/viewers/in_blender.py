"""Opens a result of `dynasurf ventricle` in Blender, prints what Blender sees and draws the heart at end systole.

blender -b -noaudio --python-exit-code 1 -P tools/viewers/in_blender.py -- RESULT PICTURE.png
"""

import json
import pathlib
import sys

import bmesh
import bpy
import mathutils
import numpy

if "bool" not in vars(numpy):
    numpy.bool = bool  # Debian's Blender 3.4 imports glTF by a name that Debian's NumPy 1.24 has no more

folder, picture = pathlib.Path(sys.argv[-2]), sys.argv[-1]
results = json.loads((folder / "results.json").read_text())
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=str(folder / "cycle.glb"))
scene = bpy.context.scene
walls = {o.name: o for o in bpy.data.objects if o.type == "MESH"}
cycle_s = (results["study"]["cycle_ms"] or 1000) / 1000


def volume_ml(wall):
    """Of the wall as it is shown at this frame."""
    shown = wall.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = bmesh.new()
    mesh.from_mesh(shown.to_mesh())
    volume = mesh.calc_volume() * 1e6
    mesh.free()
    return volume


def show(gate):
    frame = gate / len(results["gates"]) * cycle_s * scene.render.fps / scene.render.fps_base
    scene.frame_set(int(frame), subframe=frame % 1)


seen = []
for gate in range(len(results["gates"])):
    show(gate)
    seen.append([volume_ml(walls[name]) for name in ("endo", "epi")])
show(results["es_gate"] - 1)

box = [walls["epi"].matrix_world @ mathutils.Vector(corner) for corner in walls["epi"].bound_box]
middle = sum(box, mathutils.Vector()) / 8
size = max((a - b).length for a in box for b in box)


def add(kind, data, place):
    thing = bpy.data.objects.new(kind, data)
    thing.location = place
    thing.rotation_euler = (middle - thing.location).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(thing)
    return thing


scene.camera = add("camera", bpy.data.cameras.new("camera"), middle + size * mathutils.Vector((0.4, -1.9, 0.7)))
scene.camera.data.clip_start = size / 100
sun = bpy.data.lights.new("sun", "SUN")
sun.energy = 4
add("sun", sun, middle + size * mathutils.Vector((2, -2, 3)))
scene.world = bpy.data.worlds.new("world")
scene.world.use_nodes = True
scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.03, 0.04, 0.05, 1)
scene.render.engine = "CYCLES"  # needs no screen
scene.cycles.samples = 24
scene.cycles.use_denoising = False
scene.view_settings.view_transform = "Standard"
scene.render.resolution_x, scene.render.resolution_y = 900, 700
scene.render.filepath = str(pathlib.Path(picture).resolve())
bpy.ops.render.render(write_still=True)
shapes = {name: len(o.data.shape_keys.key_blocks) for name, o in walls.items()}
print("seen " + json.dumps({"shapes": shapes, "volumes_ml": seen, "actions": sorted(a.name for a in bpy.data.actions)}))
