#!/usr/bin/env python3
"""Writes the scenes of this folder: make_scenes.py [FOLDER]. The same bytes on every run.

Units: metres, W/sr for point and spot lights, W/(m^2 sr) for emission.
Cornell box: measured data of the Cornell University Program of Computer Graphics
(https://www.graphics.cornell.edu/online/box/data.html), millimetres there; RGB reflectances
0.725 0.71 0.68 (white), 0.63 0.065 0.05 (red), 0.14 0.45 0.091 (green), emission 17 12 4.
Variants of the back block and the lights: Nilles 2017 (light injection), section 7; the spot light
on the floor and the room corner: the same, section 6.
"""

import base64
import json
import math
import os
import re
import struct
import sys
import zlib

# --- Cornell box, millimetres ---------------------------------------------------------------------

# Quads, counter-clockwise as seen from inside the room, or from outside of the blocks.
FLOOR = [(552.8, 0, 0), (0, 0, 0), (0, 0, 559.2), (549.6, 0, 559.2)]
CEILING = [(556, 548.8, 0), (556, 548.8, 559.2), (0, 548.8, 559.2), (0, 548.8, 0)]
BACK_WALL = [(549.6, 0, 559.2), (0, 0, 559.2), (0, 548.8, 559.2), (556, 548.8, 559.2)]
GREEN_WALL = [(0, 0, 559.2), (0, 0, 0), (0, 548.8, 0), (0, 548.8, 559.2)]
RED_WALL = [(552.8, 0, 0), (549.6, 0, 559.2), (556, 548.8, 559.2), (556, 548.8, 0)]
# 0.8 mm below the ceiling, facing down.
AREA_LIGHT = [(343, 548, 227), (343, 548, 332), (213, 548, 332), (213, 548, 227)]
# Foot of each block, counter-clockwise as seen from above (with x to the left, z away).
SHORT_BLOCK = ([(130, 65), (82, 225), (240, 272), (290, 114)], 165)
TALL_BLOCK = ([(423, 247), (265, 296), (314, 456), (472, 406)], 330)


def block(foot, height):
    """Top and sides. There is no bottom: the block stands on the floor."""
    quads = [[(x, height, z) for x, z in foot]]
    for (x0, z0), (x1, z1) in zip(foot, foot[1:] + foot[:1]):
        quads.append([(x1, 0, z1), (x1, height, z1), (x0, height, z0), (x0, 0, z0)])
    return quads


def centre_of(foot):
    return sum(x for x, _ in foot) / 4, sum(z for _, z in foot) / 4


# --- Building glTF ----------------------------------------------------------------------------------


class Gltf:
    def __init__(self, title):
        self.data = b""
        self.json = {
            "asset": {"version": "2.0", "generator": "make_scenes.py", "extras": {"title": title}},
            "extensionsUsed": [],
            "extensionsRequired": [],
            "scene": 0,
            "scenes": [{"nodes": []}],
            "extensions": {},
        }

    def add(self, kind, item):
        """Appends to one of the top-level lists; the result is the index there."""
        items = self.json.setdefault(kind, [])
        items.append(item)
        return len(items) - 1

    def use(self, *names, required=False):
        kinds = ["extensionsUsed"] + (["extensionsRequired"] if required else [])
        for kind in kinds:
            self.json[kind] = sorted(set(self.json[kind]) | set(names))

    def accessor(self, kind, values):
        """A new buffer view of floats, or of 16-bit indices for SCALAR integers."""
        indices = kind == "SCALAR" and isinstance(values[0], int)
        flat = values if kind == "SCALAR" else [number for value in values for number in value]
        packed = struct.pack(f"<{len(flat)}{'H' if indices else 'f'}", *flat)
        self.data += b"\0" * (-len(self.data) % 4)
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(packed)}
        self.data += packed
        item = {
            "bufferView": self.add("bufferViews", view),
            "componentType": 5123 if indices else 5126,
            "count": len(values),
            "type": kind,
        }
        if kind == "VEC3" or (kind == "SCALAR" and not indices):
            stored = struct.unpack(f"<{len(flat)}f", packed)
            size = 3 if kind == "VEC3" else 1
            item["min"] = [min(stored[c::size]) for c in range(size)]
            item["max"] = [max(stored[c::size]) for c in range(size)]
        return self.add("accessors", item)

    def mesh(self, name, quads, material, uvs=None, scale=0.001):
        """Quads without normals: flat. All vertices are of their own quad."""
        positions = [tuple(x * scale for x in corner) for quad in quads for corner in quad]
        indices = [4 * q + i for q in range(len(quads)) for i in (0, 1, 2, 0, 2, 3)]
        primitive = {
            "attributes": {"POSITION": self.accessor("VEC3", positions)},
            "indices": self.accessor("SCALAR", indices),
            "material": material,
        }
        if uvs:
            primitive["attributes"]["TEXCOORD_0"] = self.accessor("VEC2", uvs)
        return self.add("meshes", {"name": name, "primitives": [primitive]})

    def node(self, name, **members):
        index = self.add("nodes", {"name": name, **members})
        self.json["scenes"][0]["nodes"].append(index)
        return index

    def light(self, name, light, position, direction=None):
        self.use("KHR_lights_punctual")
        lights = self.json["extensions"].setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        lights.append({"name": name, **light})
        members = {"translation": list(position)}
        if direction:
            members["rotation"] = looking_along(direction)
        members["extensions"] = {"KHR_lights_punctual": {"light": len(lights) - 1}}
        self.node(name, **members)

    def camera(self, name, eye, at, yfov, aspect=None):
        view = {"yfov": rounded(yfov), "znear": 0.001}
        if aspect:
            view["aspectRatio"] = aspect
        index = self.add("cameras", {"name": name, "type": "perspective", "perspective": view})
        direction = [a - e for a, e in zip(at, eye)]
        return self.node(
            name, camera=index, translation=list(eye), rotation=looking_along(direction)
        )

    def shape(self, name, shape, material, **members):
        self.use("KHR_implicit_shapes", "QL_shape_material", required=True)
        shapes = self.json["extensions"].setdefault("KHR_implicit_shapes", {"shapes": []})["shapes"]
        shapes.append(shape)
        extensions = {
            "KHR_implicit_shapes": {"shape": len(shapes) - 1},
            "QL_shape_material": {"material": material},
        }
        self.node(name, **members, extensions=extensions)

    def text(self):
        if self.data:
            uri = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
            self.json["buffers"] = [{"byteLength": len(self.data), "uri": uri}]
        kept = {key: value for key, value in self.json.items() if value not in ([], {})}
        text = json.dumps(kept, indent=2)
        # Lists of numbers on one line.
        return re.sub(r"\[[-+.\de,\s]+\]", lambda m: " ".join(m.group().split()), text) + "\n"


def looking_along(direction):
    """The rotation (x, y, z, w) that turns -z to the direction and keeps x horizontal."""
    length = math.sqrt(sum(c * c for c in direction))
    x, y, z = (c / length for c in direction)
    yaw = math.atan2(-x, -z)
    pitch = math.asin(max(-1.0, min(1.0, y)))
    sy, cy, sp, cp = math.sin(yaw / 2), math.cos(yaw / 2), math.sin(pitch / 2), math.cos(pitch / 2)
    return [rounded(c) for c in (cy * sp, sy * cp, -sy * sp, cy * cp)]


def rounded(value):
    """Steps over differences between mathematical libraries; no negative zero."""
    return round(value, 12) + 0.0


# --- Materials --------------------------------------------------------------------------------------


def lambert(gltf, name, color):
    """Exactly Lambert for those who know the extension, nearly so for others."""
    gltf.use("QL_materials_phong")
    return gltf.add(
        "materials",
        {
            "name": name,
            "pbrMetallicRoughness": {
                "baseColorFactor": [*color, 1],
                "metallicFactor": 0,
                "roughnessFactor": 1,
            },
            "extensions": {"QL_materials_phong": {"kd": 1, "diffuseColor": list(color)}},
        },
    )


def phong(gltf, name, color, exponent):
    gltf.use("QL_materials_phong")
    # For programs without the extension: alpha^2 = 2 / (n + 2), Walter et al., "Microfacet models for
    # refraction through rough surfaces", EGSR 2007, for a lobe about the half vector.
    roughness = rounded((2 / (exponent + 2)) ** 0.25)
    return gltf.add(
        "materials",
        {
            "name": name,
            "pbrMetallicRoughness": {
                "baseColorFactor": [*color, 1],
                "metallicFactor": 1,
                "roughnessFactor": roughness,
            },
            "extensions": {
                "QL_materials_phong": {
                    "kd": 0,
                    "ks": 1,
                    "exponent": exponent,
                    "specularColor": list(color),
                }
            },
        },
    )


def mirror(gltf, name):
    gltf.use("QL_materials_phong")
    return gltf.add(
        "materials",
        {
            "name": name,
            "pbrMetallicRoughness": {"metallicFactor": 1, "roughnessFactor": 0},
            "extensions": {"QL_materials_phong": {"kd": 0, "kr": 1}},
        },
    )


def glass(gltf, name, ior, thickness):
    gltf.use("QL_materials_phong")
    index = clear(gltf, name, ior, thickness)
    extensions = gltf.json["materials"][index]["extensions"]
    extensions["QL_materials_phong"] = {"kd": 0, "kt": 1, "ior": ior}
    return index


def clear(gltf, name, ior, thickness):
    """Smooth glass by the Khronos extensions alone."""
    gltf.use("KHR_materials_ior", "KHR_materials_transmission", "KHR_materials_volume")
    return gltf.add(
        "materials",
        {
            "name": name,
            "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0},
            "extensions": {
                "KHR_materials_ior": {"ior": ior},
                "KHR_materials_transmission": {"transmissionFactor": 1},
                "KHR_materials_volume": {"thicknessFactor": thickness},
            },
        },
    )


def emitter(gltf, name, color, radiance):
    gltf.use("KHR_materials_emissive_strength", "QL_materials_phong")
    strength = max(radiance)
    index = lambert(gltf, name, color)
    material = gltf.json["materials"][index]
    material["emissiveFactor"] = [c / strength for c in radiance]
    material["extensions"]["KHR_materials_emissive_strength"] = {"emissiveStrength": strength}
    return index


WHITE = (0.725, 0.71, 0.68)
RED = (0.63, 0.065, 0.05)
GREEN = (0.14, 0.45, 0.091)


# --- The Cornell scenes -----------------------------------------------------------------------------


def cornell(title, tall_material=None):
    gltf = Gltf(title)
    white = lambert(gltf, "white", WHITE)
    red = lambert(gltf, "red", RED)
    green = lambert(gltf, "green", GREEN)
    tall = tall_material(gltf) if tall_material else white
    for name, quads, material in (
        ("floor", [FLOOR], white),
        ("ceiling", [CEILING], white),
        ("back_wall", [BACK_WALL], white),
        ("green_wall", [GREEN_WALL], green),
        ("red_wall", [RED_WALL], red),
    ):
        gltf.node(name, mesh=gltf.mesh(name, quads, material))
    for name, (foot, height), material in (
        ("short_block", SHORT_BLOCK, white),
        ("tall_block", TALL_BLOCK, tall),
    ):
        # Around its own axis, so that it can be turned.
        x, z = centre_of(foot)
        local = [(fx - x, fz - z) for fx, fz in foot]
        mesh = gltf.mesh(name, block(local, height), material)
        gltf.node(name, mesh=mesh, translation=[rounded(x / 1000), 0, rounded(z / 1000)])
    # Focal length 35 mm, film of 25 mm.
    gltf.camera("camera", (0.278, 0.273, -0.8), (0.278, 0.273, 0), 2 * math.atan(12.5 / 35), 1)
    return gltf


def add_point_light(gltf):
    # In the middle, right under the ceiling.
    gltf.light("point_light", {"type": "point", "intensity": 0.1}, (0.278, 0.48, 0.2796))
    return gltf


def add_spot_light(gltf):
    # In the front left corner of the floor, to the back right corner of the ceiling. The camera
    # looks along +z: left is +x.
    gltf.use("QL_lights_spot_exponent")
    position, target = (0.53, 0.02, 0.02), (0, 0.5488, 0.5592)
    light = {
        "type": "spot",
        "intensity": 0.3,
        "spot": {"innerConeAngle": 0, "outerConeAngle": rounded(math.radians(60))},
        "extensions": {"QL_lights_spot_exponent": {"exponent": 2}},
    }
    gltf.light("spot_light", light, position, [t - p for t, p in zip(target, position)])
    return gltf


def add_area_light(gltf):
    light = emitter(gltf, "light", (0.78, 0.78, 0.78), (17, 12, 4))
    gltf.node("light", mesh=gltf.mesh("light", [AREA_LIGHT], light))
    return gltf


def animate(gltf, node, path, times, values):
    kind = "VEC4" if path == "rotation" else "VEC3"
    sampler = {
        "input": gltf.accessor("SCALAR", [float(t) for t in times]),
        "output": gltf.accessor(kind, values),
        "interpolation": "LINEAR",
    }
    animations = gltf.json.setdefault("animations", [{"channels": [], "samplers": []}])
    animations[0]["samplers"].append(sampler)
    target = {"node": node, "path": path}
    animations[0]["channels"].append(
        {"sampler": len(animations[0]["samplers"]) - 1, "target": target}
    )


def find_node(gltf, name):
    return next(i for i, node in enumerate(gltf.json["nodes"]) if node["name"] == name)


def about_y(degrees):
    half = math.radians(degrees) / 2
    return (0.0, math.sin(half), 0.0, math.cos(half))


def moving_camera():
    """0.1 m/s sideways and up, 1 degree/s about the vertical: 3 pixels a frame of 512 at 24/s."""
    gltf = add_point_light(cornell("Cornell box, moving camera"))
    camera = find_node(gltf, "camera")
    path = [(0.228, 0.253, -0.8), (0.328, 0.253, -0.8), (0.328, 0.333, -0.75)]
    animate(gltf, camera, "translation", [0, 1, 2], path)
    animate(gltf, camera, "rotation", [0, 2], [about_y(179), about_y(181)])
    return gltf


def moving_block():
    """The short block turns by 45 degrees a second: its corners move 2 to 3 pixels a frame."""
    gltf = add_point_light(cornell("Cornell box, moving block"))
    turns = [about_y(angle) for angle in (0, 45, 90)]
    animate(gltf, find_node(gltf, "short_block"), "rotation", [0, 1, 2], turns)
    return gltf


# --- Other scenes -----------------------------------------------------------------------------------


def png(width, height, pixels):
    """8-bit RGB, stored without compression: the same bytes from every library."""

    def chunk(kind, data):
        check = zlib.crc32(kind + data)
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", check)

    rows = b"".join(
        b"\0" + bytes(c for pixel in pixels[y * width : (y + 1) * width] for c in pixel)
        for y in range(height)
    )
    stored = b"\x78\x01\x01" + struct.pack("<HH", len(rows), len(rows) ^ 0xFFFF) + rows
    stored += struct.pack(">I", zlib.adler32(rows))
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", stored) + chunk(b"IEND", b"")
    )


def checker_material(gltf):
    light, dark = (225, 222, 215), (70, 90, 120)
    pixels = [light if (x + y) % 2 == 0 else dark for y in range(8) for x in range(8)]
    uri = "data:image/png;base64," + base64.b64encode(png(8, 8, pixels)).decode()
    image = gltf.add("images", {"name": "checker", "uri": uri})
    sampler = gltf.add(
        "samplers", {"magFilter": 9728, "minFilter": 9728, "wrapS": 10497, "wrapT": 10497}
    )
    texture = gltf.add("textures", {"sampler": sampler, "source": image})
    return gltf.add(
        "materials",
        {
            "name": "checker",
            "pbrMetallicRoughness": {
                "baseColorTexture": {"index": texture},
                "metallicFactor": 0,
                "roughnessFactor": 0.9,
            },
        },
    )


def shapes():
    gltf = Gltf("Spheres and cones on a floor")
    floor = [(-2, 0, 2), (2, 0, 2), (2, 0, -2), (-2, 0, -2)]
    uvs = [(0, 2), (2, 2), (2, 0), (0, 0)]
    checker = checker_material(gltf)
    gltf.node("floor", mesh=gltf.mesh("floor", [floor], checker, uvs, scale=1))
    gold = gltf.add(
        "materials",
        {
            "name": "gold",
            "pbrMetallicRoughness": {
                "baseColorFactor": [1, 0.78, 0.34, 1],
                "metallicFactor": 1,
                "roughnessFactor": 0.3,
            },
        },
    )
    sphere = {"type": "sphere", "sphere": {"radius": 0.3}}
    cone = {"height": 0.7, "radiusBottom": 0.3, "radiusTop": 0}
    stump = {"height": 0.4, "radiusBottom": 0.2, "radiusTop": 0.1}
    for name, shape, material, position in (
        ("diffuse_sphere", sphere, lambert(gltf, "clay", RED), (-0.75, 0.3, -0.3)),
        ("glossy_sphere", sphere, gold, (0, 0.3, -0.5)),
        ("glass_sphere", sphere, clear(gltf, "glass", 1.5, 0.6), (0.35, 0.3, 0.35)),
        (
            "cone",
            {"type": "cylinder", "cylinder": cone},
            lambert(gltf, "green", GREEN),
            (0.85, 0.35, -0.4),
        ),
        (
            "stump",
            {"type": "cylinder", "cylinder": stump},
            lambert(gltf, "white", WHITE),
            (-0.4, 0.2, 0.5),
        ),
    ):
        gltf.shape(name, shape, material, translation=list(position))
    lamp = [(-0.4, 2, -0.4), (0.4, 2, -0.4), (0.4, 2, 0.4), (-0.4, 2, 0.4)]
    light = emitter(gltf, "lamp", (0.78, 0.78, 0.78), (6, 6, 6))
    gltf.node("lamp", mesh=gltf.mesh("lamp", [lamp], light, scale=1))
    gltf.light("point_light", {"type": "point", "intensity": 1.5}, (-1.2, 1.6, 1.2))
    gltf.camera("camera", (0, 1.1, 2.8), (0, 0.3, 0), math.radians(38))
    return gltf


def room_corner():
    """Fits the Lucy statue of the Stanford repository at a scale of 1/1000 (1.6 m tall)."""
    gltf = Gltf("Corner of a room without ceiling")
    x0, x1, y0, y1, z0, z1 = -0.5, 2.3, -0.606, 1.9, -0.8, 2.0
    for name, quad, color in (
        ("floor", [(x0, y0, z1), (x1, y0, z1), (x1, y0, z0), (x0, y0, z0)], WHITE),
        ("back_wall", [(x0, y0, z0), (x1, y0, z0), (x1, y1, z0), (x0, y1, z0)], GREEN),
        ("left_wall", [(x0, y0, z1), (x0, y0, z0), (x0, y1, z0), (x0, y1, z1)], RED),
    ):
        gltf.node(name, mesh=gltf.mesh(name, [quad], lambert(gltf, name, color), scale=1))
    gltf.use("QL_lights_spot_exponent")
    light = {
        "type": "spot",
        "intensity": 25,
        "spot": {"innerConeAngle": 0, "outerConeAngle": rounded(math.radians(60))},
        "extensions": {"QL_lights_spot_exponent": {"exponent": 2}},
    }
    gltf.light("spot_light", light, (2.1, 1.5, 1.9), (-1.5, -1.3, -1.9))
    gltf.camera("camera", (2.0, 0.7, 3.4), (0.65, 0.15, 0.1), math.radians(40))
    return gltf


def flat():
    """All pixels see the same: a few millimetres of a floor below a strip lamp, which is so placed
    that the light of its points on the floor is nearly uniform in strength."""
    gltf = Gltf("Flat scene")
    floor = [(-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)]
    gltf.node("floor", mesh=gltf.mesh("floor", [floor], lambert(gltf, "white", WHITE), scale=1))
    lamp = [(0.3, 1, -0.02), (0.6, 1, -0.02), (0.6, 1, 0.02), (0.3, 1, 0.02)]
    light = emitter(gltf, "lamp", (0, 0, 0), (10, 10, 10))
    gltf.node("lamp", mesh=gltf.mesh("lamp", [lamp], light, scale=1))
    gltf.camera("camera", (-0.3, 0.4, 0.1), (0, 0, 0), math.radians(0.3))
    return gltf


def sponza_lights():
    """Lights and cameras only: to be loaded together with Crytek's Sponza (in metres)."""
    gltf = Gltf("Lights and cameras for Sponza")
    gltf.light("above", {"type": "point", "intensity": 400}, (-0.5, 12, -0.3))
    gltf.light("left_of_lion", {"type": "point", "intensity": 6}, (-9.8, 1.5, 2.9))
    gltf.light("right_of_lion", {"type": "point", "intensity": 6}, (-9.8, 1.5, -3.5))
    views = (
        ("nave", (6.96, 1.79, -0.31), (-9.41, 3.34, 0.61), 75),
        ("lion", (-4.0, 1.6, -0.3), (-11.0, 1.5, -0.3), 60),
        ("arcade", (5.5, 5.6, -0.3), (-6.0, 1.8, 1.4), 60),
    )
    for name, eye, at, degrees in views:
        gltf.camera(name, eye, at, math.radians(degrees))
    # 1.2 m/s along the nave, a little sideways: up to 3 pixels a frame of 480 x 270 at 24/s.
    gltf.camera("walk", (6.96, 1.79, -0.31), (-9.41, 3.34, 0.61), math.radians(75))
    path = [(6.96, 1.79, -0.31), (5.46, 1.83, -0.71), (3.96, 1.79, -0.31)]
    animate(gltf, find_node(gltf, "walk"), "translation", [0, 1.25, 2.5], path)
    return gltf


def scenes():
    yield "cornell_point", add_point_light(cornell("Cornell box, point light"))
    back = {
        "phong": lambda gltf: phong(gltf, "phong_40", WHITE, 40),
        "mirror": lambda gltf: mirror(gltf, "mirror"),
        "glass": lambda gltf: glass(gltf, "glass", 1.45, 0.165),
    }
    for name, material in back.items():
        title = f"Cornell box, point light, back block: {name}"
        yield f"cornell_{name}", add_point_light(cornell(title, material))
    yield "cornell_area", add_area_light(cornell("Cornell box, area light"))
    yield "cornell_spot", add_spot_light(cornell("Cornell box, spot light on the floor"))
    yield "cornell_moving_camera", moving_camera()
    yield "cornell_moving_block", moving_block()
    yield "shapes", shapes()
    yield "room_corner", room_corner()
    yield "flat", flat()
    yield "sponza_lights", sponza_lights()


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else os.path.dirname(os.path.abspath(__file__))
    for name, gltf in scenes():
        with open(os.path.join(folder, name + ".gltf"), "w", encoding="utf-8") as file:
            file.write(gltf.text())


if __name__ == "__main__":
    main()
