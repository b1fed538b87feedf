#!/usr/bin/env python3
"""Makes the scenes of this folder: `scenes/generate.py` (or `generate.py --check`: are they as made?).

Each function below is one scene. Light is in lux (directional) and candela (point, spot); the
intensities are those of a bright room, so a camera with automatic exposure shows them well.
"""

import math
import pathlib
import sys
import tempfile

sys.dont_write_bytecode = True  # the scenes' folder holds scenes
from gltf_builder import Document, about, box, cylinder, lathe, moved, pixels_of, quad, sphere, sub, unit, write_png

PHONG = "TESSERA_materials_phong"
UNLIT = "KHR_materials_unlit"
STRENGTH = "KHR_materials_emissive_strength"


def srgb(code):
    """Linear colour of "#rrggbb"."""
    values = [int(code[i:i + 2], 16) / 255 for i in (1, 3, 5)]
    return [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in values]


def glow(color, strength):
    return {"emissiveFactor": list(color), "extensions": {STRENGTH: {"emissiveStrength": strength}}}


# --- textures -----------------------------------------------------------------------------------


def textures(folder):
    def checker(x, y):
        if x % 64 in (0, 63) or y % 64 in (0, 63):
            return (150, 146, 140)  # the joint between the tiles
        return (226, 221, 212) if (x // 64 + y // 64) % 2 == 0 else (64, 78, 92)

    def dimples(x, y):
        # Round dimples in a staggered grid, as a tangent-space normal map with +Y up.
        cell = 32
        v = y / cell
        u = x / cell + (0.5 if int(v) % 2 else 0.0)
        dx, dy = (u % 1) - 0.5, 0.5 - (v % 1)
        r = math.hypot(dx, dy)
        if r >= 0.42 or r == 0:
            return (128, 128, 255)
        slope = -0.75 * math.sin(math.pi * r / 0.42)
        n = [-slope * dx / r, -slope * dy / r, 1.0]
        length = math.sqrt(sum(c * c for c in n))
        return tuple(round(127.5 + 127.5 * c / length) for c in n)

    def leaf(x, y):
        u, v = (x + 0.5) / 128 - 0.5, 0.5 - (y + 0.5) / 128
        t = v + 0.42  # 0 at the stem's end, up the leaf
        width = 0.34 * math.sin(math.pi * min(max(t / 0.88, 0), 1)) ** 0.8 * (1 - 0.35 * t)
        teeth = 0.012 * math.cos(t * 75)
        inside = 0.04 < t < 0.86 and abs(u) < width + teeth
        stem = v < -0.30 and abs(u) < 0.014
        rib = abs(u) < 0.012 or abs((t - abs(u) * 0.9) % 0.13 - 0.065) < 0.007
        shade = 0.82 + 0.18 * t - 0.25 * abs(u)
        color = (168, 196, 104) if rib else (92, 150, 66)
        return tuple(round(c * shade) for c in color) + (255 if inside or stem else 0,)

    def lattice(x, y):
        hole = ((x % 32) - 15.5) ** 2 + ((y % 32) - 15.5) ** 2 < 110
        return (255, 255, 255, 0 if hole else 255)

    write_png(folder / "checker.png", 128, 128, checker)
    write_png(folder / "dimples-normal.png", 128, 128, dimples)
    write_png(folder / "leaf.png", 128, 128, leaf)
    write_png(folder / "lattice.png", 64, 64, lattice)


# --- scenes ---------------------------------------------------------------------------------------


def cornell_box():
    doc = Document("Cornell box")
    white = doc.material("white", (0.73, 0.71, 0.68), roughness=0.95)
    red = doc.material("red", srgb("#b3261e"), roughness=0.95)
    green = doc.material("green", srgb("#3f8f3a"), roughness=0.95)
    lamp = doc.material("lamp", (0, 0, 0), **glow((1, 0.88, 0.68), 40.0))
    room = doc.node("room")
    for name, center, right, up, material in (
            ("floor", [0, 0, 0], [1, 0, 0], [0, 0, -1], white), ("ceiling", [0, 2, 0], [1, 0, 0], [0, 0, 1], white),
            ("back wall", [0, 1, -1], [1, 0, 0], [0, 1, 0], white), ("left wall", [-1, 1, 0], [0, 0, -1], [0, 1, 0], red),
            ("right wall", [1, 1, 0], [0, 0, 1], [0, 1, 0], green)):
        doc.node(name, room, mesh=doc.mesh(name, quad(center, right, up), material))
    doc.node("lamp", room, mesh=doc.mesh("lamp", quad([0, 1.998, 0], [0.26, 0, 0], [0, 0, 0.2]), lamp))
    block = box([0.6, 0.6, 0.6])
    doc.node("short block", translation=[0.34, 0.3, 0.34], rotation=about([0, 1, 0], -17),
             mesh=doc.mesh("block", block, white))
    doc.node("tall block", translation=[-0.34, 0.6, -0.32], rotation=about([0, 1, 0], 18), scale=[1, 2, 1],
             mesh=len(doc.parts["meshes"]) - 1)
    doc.light("lamp light", "point", (1, 0.88, 0.68), 30.0, [0, 1.72, 0])
    # Stands for the light that walls throw back, which a ray caster does not follow.
    doc.light("bounced light", "point", (1, 0.9, 0.78), 34.0, [0.5, 1.3, 3.6])
    doc.camera("front", [0, 1, 3.85], [0, 1, 0], 39.5)
    doc.camera("corner", [0.75, 1.7, 2.2], [-0.25, 0.5, -0.3], 48)
    return doc


def spheres():
    doc = Document("Spheres on a checker plane")
    tiles = doc.texture("checker", "checker.png")
    floor = doc.material("tiles", (1, 1, 1), roughness=0.55, texture=tiles)
    doc.node("floor", mesh=doc.mesh("floor", quad([0, 0, 0], [40, 0, 0], [0, 0, -40], (40, 40), 8), floor))
    ball = sphere(1.0, 64, 32)
    for name, color, metallic, roughness, radius, x, z in (
            ("gold", (1.0, 0.71, 0.29), 1.0, 0.42, 1.0, 0.0, 0.0), ("copper", (0.95, 0.57, 0.46), 1.0, 0.5, 0.7, -1.95, 0.55),
            ("steel", (0.78, 0.79, 0.8), 1.0, 0.36, 0.8, 1.95, 0.2), ("red plastic", srgb("#c8342b"), 0.0, 0.22, 0.5, -0.85, 1.55),
            ("teal plastic", srgb("#1f8a8c"), 0.0, 0.3, 0.42, 0.75, 1.6), ("porcelain", srgb("#f2ede4"), 0.0, 0.15, 0.85, -2.6, -1.55),
            ("blue rubber", srgb("#33558f"), 0.0, 0.7, 0.95, 2.75, -1.7), ("olive clay", srgb("#8a8a3c"), 0.0, 0.95, 0.34, 2.05, 1.75),
            ("plum plastic", srgb("#7c3a6b"), 0.0, 0.25, 0.36, -1.75, 2.0)):
        material = doc.material(name, color, metallic, roughness)
        doc.node(name, translation=[x, radius, z], scale=[radius] * 3, mesh=doc.mesh(name, ball, material, "ball"))
    doc.light("sun", "directional", (1, 0.95, 0.86), 8.0, [4, 6, 4.5], [0, 0, 0])
    doc.light("sky", "directional", (0.72, 0.84, 1), 3.2, [-5, 3.5, 3], [0, 0, 0])
    doc.light("front", "directional", (1, 1, 1), 1.6, [0.5, 0.9, 6], [0, 0, 0])
    doc.light("rim", "directional", (1, 0.98, 0.95), 2.0, [-1.5, 5, -6], [0, 0, 0])
    doc.camera("main", [0.7, 2.9, 9.2], [0.1, 0.62, 0], 30)
    doc.camera("low", [-3.6, 0.75, 5.2], [0.1, 0.8, 0], 38)
    return doc


def lights():
    doc = Document("Kinds of light")
    plaster = doc.material("plaster", (0.78, 0.77, 0.75), roughness=0.9)
    stone = doc.material("stone", srgb("#d9d2c5"), roughness=0.6)
    wax = doc.material("wax", srgb("#efe3cc"), roughness=0.6)
    flame = doc.material("flame", (0, 0, 0), **glow((1, 0.62, 0.28), 20.0))
    doc.node("floor", mesh=doc.mesh("floor", quad([0, 0, 2], [8, 0, 0], [0, 0, -5]), plaster))
    doc.node("wall", mesh=doc.mesh("wall", quad([0, 3, -2], [8, 0, 0], [0, 3.5, 0]), plaster))
    plinth = doc.mesh("plinth", cylinder(0.55, 0.55, 0.5, 0.04), stone)
    figures = (("sphere", moved(sphere(0.48), [0, 0.98, 0])), ("cone", moved(cylinder(0.46, 0.0, 1.15), [0, 0.5, 0])),
               ("cube", moved(box([0.78, 0.78, 0.78], 0.05), [0, 0.89, 0])))
    for (name, shape), x, turn in zip(figures, (-2.6, 0, 2.6), (0, 0, 28)):
        place = doc.node(name + " place", translation=[x, 0, 0.2], rotation=about([0, 1, 0], turn))
        doc.node(name + " plinth", place, mesh=plinth)
        doc.node(name, place, mesh=doc.mesh(name, shape, stone))
    for name, color, x, height in (("red spot", (1, 0.1, 0.06), -3.1, 3.9), ("green spot", (0.1, 0.9, 0.16), 0.0, 4.1),
                                   ("blue spot", (0.08, 0.22, 1), 3.1, 3.9)):
        doc.light(name, "spot", color, 70.0, [x, height, 3.2], [x * 0.9, 1.35, -2], cone=(12, 20))
    doc.light("moon", "directional", (0.66, 0.76, 1), 0.45, [-3, 5, 6], [0, 0, 0])
    candle = doc.node("candle", translation=[1.3, 0, 1.5], mesh=doc.mesh("candle", cylinder(0.12, 0.11, 0.5, 0.02), wax))
    doc.node("flame", candle, translation=[0, 0.6, 0], scale=[0.04, 0.09, 0.04], mesh=doc.mesh("flame", sphere(1, 24, 16), flame))
    # Above the flame, which would otherwise shut it in.
    doc.light("candle light", "point", (1, 0.62, 0.28), 3.2, [0, 0.75, 0], parent=candle)
    doc.camera("main", [0, 2.15, 8.6], [0, 1.45, -0.6], 37)
    doc.camera("side", [-6.2, 2.6, 5.6], [0.2, 1.2, -0.4], 40)
    return doc


def materials():
    doc = Document("Materials side by side")
    dimples = doc.texture("dimples", "dimples-normal.png")
    lattice = doc.texture("lattice", "lattice.png")
    ball = sphere(0.46, 56, 28)
    backdrop = doc.material("backdrop", srgb("#a9afb7"), roughness=1.0)
    doc.node("backdrop", mesh=doc.mesh("backdrop", quad([0, 0, -9.5], [18, 0, 0], [0, 12, 0]), backdrop))

    def place(name, column, row, material):
        doc.node(name, translation=[column - 3.0, 1.65 - 1.1 * row, 0], mesh=doc.mesh(name, ball, material, "ball"))

    for row, (metallic, color) in enumerate(((0.0, srgb("#c5482f")), (0.5, srgb("#d29a57")), (1.0, (1.0, 0.76, 0.36)))):
        for column in range(7):
            roughness = 0.1 + 0.15 * column
            name = f"metallic {metallic:g} roughness {roughness:.2f}"
            place(name, column, row, doc.material(name, color, metallic, roughness))

    blue = srgb("#2f6fb4")

    def phong(model, **more):
        values = {"model": model, "ambient": blue, "diffuse": blue, "specular": [0.45, 0.45, 0.45], "shininess": 40.0}
        return {"extensions": {PHONG: {**values, **more}}}

    samples = (
        ("lambert", doc.material("lambert", blue, roughness=1.0, **phong("lambert", specular=[0, 0, 0]))),
        ("phong", doc.material("phong", blue, roughness=0.4, **phong("phong"))),
        ("blinn-phong", doc.material("blinn-phong", blue, roughness=0.4, **phong("blinn-phong", shininess=160.0))),
        ("unlit", doc.material("unlit", blue, extensions={UNLIT: {}})),
        ("normal map", doc.material("normal map", srgb("#e8e4da"), roughness=0.35,
                                    normalTexture={"index": dimples, "scale": 1.0,
                                                   "extensions": {"KHR_texture_transform": {"scale": [4, 2]}}})),
        ("alpha mask", doc.material("alpha mask", srgb("#3c9a5f"), roughness=0.5, texture=lattice, alphaMode="MASK",
                                    alphaCutoff=0.5, doubleSided=True)),
        ("blend", doc.material("blend", srgb("#7a4fb0"), roughness=0.2, alpha=0.45, alphaMode="BLEND")))
    doc.extensions.add("KHR_texture_transform")
    mask = doc.parts["materials"][samples[5][1]]["pbrMetallicRoughness"]["baseColorTexture"]
    mask["extensions"] = {"KHR_texture_transform": {"scale": [5, 3]}}
    for column, (name, material) in enumerate(samples):
        place(name, column, 3, material)
    doc.light("key", "directional", (1, 0.97, 0.92), 7.0, [-3.5, 5, 6], [0, 0, 0])
    doc.light("fill", "directional", (0.82, 0.9, 1), 3.0, [5, 5, 5], [0, 0, 0])
    doc.light("top", "directional", (1, 1, 1), 2.4, [1.2, 8, 3], [0, 0, 0])
    doc.camera("front", [0, 0, 15], [0, 0, 0], 22)
    doc.camera("oblique", [-6.5, 2.8, 11], [-0.2, -0.1, 0], 27)
    return doc


def hierarchy():
    doc = Document("Robot arm: a hierarchy of nodes")
    orange = doc.material("orange paint", srgb("#e8711a"), roughness=0.38)
    dark = doc.material("dark iron", srgb("#3a3f47"), metallic=0.4, roughness=0.45)
    steel = doc.material("steel", (0.66, 0.67, 0.69), metallic=1.0, roughness=0.34)
    floor = doc.material("floor", srgb("#b9c1c9"), roughness=0.9)
    cargo = doc.material("cargo", srgb("#2a7f92"), roughness=0.5)
    doc.node("floor", mesh=doc.mesh("floor", quad([0, 0, 0], [14, 0, 0], [0, 0, -14]), floor))
    bolt = doc.mesh("bolt", cylinder(0.055, 0.055, 0.07, 0.012, 24), steel)
    drum = doc.mesh("drum", moved(cylinder(0.26, 0.26, 0.62, 0.04), [0, -0.31, 0]), dark)
    cap = doc.mesh("cap", moved(cylinder(0.17, 0.17, 0.7, 0.03), [0, -0.35, 0]), steel)

    def joint(name, parent, degrees, **place):
        """A hinge about X: its drum, and the node that turns whatever hangs on it."""
        axle = doc.node(name, parent, rotation=about([1, 0, 0], degrees), **place)
        doc.node(name + " drum", axle, rotation=about([0, 0, 1], 90), mesh=drum)
        doc.node(name + " cap", axle, rotation=about([0, 0, 1], 90), mesh=cap)
        return axle

    base = doc.node("base", mesh=doc.mesh("base", cylinder(0.95, 0.85, 0.28, 0.05), dark))
    for i in range(8):  # one mesh, eight instances
        ring = doc.node(f"bolt arm {i}", base, rotation=about([0, 1, 0], 45.0 * i + 22.5))
        doc.node(f"bolt {i}", ring, translation=[0, 0.28, 0.7], mesh=bolt)
    turntable = doc.node("turntable", base, translation=[0, 0.28, 0], rotation=about([0, 1, 0], 52),
                         mesh=doc.mesh("turntable", cylinder(0.6, 0.5, 0.4, 0.05), orange))
    shoulder = joint("shoulder", turntable, 24, translation=[0, 0.62, 0])
    beam = doc.mesh("beam", moved(box([0.36, 1.5, 0.42], 0.08), [0, 0.8, 0]), orange)
    doc.node("upper arm", shoulder, mesh=beam)
    elbow = joint("elbow", shoulder, 68, translation=[0, 1.65, 0], scale=[0.82] * 3)
    doc.node("forearm", elbow, mesh=beam)
    wrist = joint("wrist", elbow, 62, translation=[0, 1.65, 0], scale=[0.66] * 3)
    doc.node("hand", wrist, translation=[0, 0.42, 0], mesh=doc.mesh("hand", box([1.0, 0.2, 0.5], 0.06), dark))
    finger = doc.mesh("finger", moved(box([0.14, 0.7, 0.36], 0.05), [0.42, 0.42, 0]), steel)
    tip = doc.mesh("fingertip", moved(box([0.3, 0.12, 0.36], 0.04), [0.36, 0.76, 0]), orange)
    for name, scale in (("right finger", [1, 1, 1]), ("left finger", [-1, 1, 1])):  # the left one is a mirror image
        side = doc.node(name, wrist, translation=[0, 0.48, 0], scale=scale, mesh=finger)
        doc.node(name + " tip", side, mesh=tip)
    crate = doc.mesh("crate", box([0.5, 0.5, 0.5], 0.04), cargo)
    for i, (x, y, z, turn) in enumerate(((1.75, 0.25, -0.35, 12), (2.4, 0.25, 0.0, --16), (2.1, 0.75, -0.18, 40))):
        doc.node(f"crate {i}", translation=[x, y, z], rotation=about([0, 1, 0], turn), mesh=crate)
    doc.light("sun", "directional", (1, 0.95, 0.87), 8.0, [4, 7, 4], [0, 0, 0])
    doc.light("sky", "directional", (0.74, 0.85, 1), 2.8, [-4, 3, 5], [0, 0, 0])
    doc.camera("main", [3.1, 2.7, 6.6], [0.75, 1.2, 0.2], 33)
    doc.camera("above", [1.0, 8.2, 2.2], [0.7, 0, 0.1], 34)
    return doc


def transparency():
    doc = Document("Transparency")
    leaf_picture = doc.texture("leaf", "leaf.png", wrap=33071)
    leaf = doc.material("leaf", (1, 1, 1), roughness=0.6, texture=leaf_picture, alphaMode="MASK", alphaCutoff=0.5,
                        doubleSided=True)
    table = doc.material("table", srgb("#dccfb8"), roughness=0.8)
    pot = doc.material("terracotta", srgb("#b5623c"), roughness=0.75)
    twig = doc.material("twig", srgb("#5b6b35"), roughness=0.8)
    doc.node("table", mesh=doc.mesh("table", quad([0, 0, 0], [12, 0, 0], [0, 0, -12]), table))
    place = doc.node("plant", translation=[-1.45, 0, 0])
    rim = moved(cylinder(0.5, 0.52, 0.16, 0.03), [0, 0.62, 0])
    doc.node("pot", place, mesh=doc.mesh("pot", cylinder(0.34, 0.46, 0.66, 0.03), pot))
    doc.node("rim", place, mesh=doc.mesh("rim", rim, pot))
    doc.node("twig", place, translation=[0, 0.7, 0], mesh=doc.mesh("twig", cylinder(0.035, 0.015, 1.25), twig))
    blade = doc.mesh("leaf", quad([0, 0.42, 0], [0.46, 0, 0], [0, 0.46, 0]), leaf)
    for i in range(13):  # leaves along the twig, by the golden angle
        t = i / 12
        turn = doc.node(f"leaf turn {i}", place, translation=[0, 0.86 + 1.05 * t, 0], rotation=about([0, 1, 0], 137.508 * i))
        doc.node(f"leaf {i}", turn, rotation=about([1, 0, 0], 78 - 52 * t), scale=[1.0 - 0.35 * t] * 3, mesh=blade)
    panes = doc.node("panes", translation=[1.35, 1.0, 0.1])
    pane = quad([0, 0, 0], [0.95, 0, 0], [0, 0.95, 0])
    for name, color, turn in (("rose pane", srgb("#d6336c"), -16), ("amber pane", srgb("#f2a20c"), 44),
                              ("blue pane", srgb("#1c7ed6"), 104)):  # three panes through one axis
        glass = doc.material(name, color, roughness=0.15, alpha=0.55, alphaMode="BLEND", doubleSided=True)
        doc.node(name, panes, rotation=about([0, 1, 0], turn), mesh=doc.mesh(name, pane, glass, "pane"))
    marble = doc.material("marble ball", srgb("#efeae2"), roughness=0.3)
    doc.node("ball", panes, translation=[0, -0.62, 0], scale=[0.38] * 3, mesh=doc.mesh("ball", sphere(), marble))
    doc.light("window", "directional", (1, 0.96, 0.88), 6.0, [2, 5, 6], [0, 0, 0])
    doc.light("room", "directional", (0.8, 0.88, 1), 3.0, [-4, 2, 6], [0, 0, 0])
    doc.camera("main", [0, 2.15, 6.8], [0, 1.0, 0], 33)
    doc.camera("panes", [1.9, 2.9, 3.6], [1.35, 0.85, 0.1], 36)
    return doc


def motion():
    """A tentacle (skin), a ball that bounces and flattens (translation, morph), a windmill (rotation)."""
    doc = Document("Motion: a skin, a morph, a hierarchy")
    floor = doc.material("floor", srgb("#b9c1c9"), roughness=0.9)
    green = doc.material("green", srgb("#4f9d4a"), roughness=0.45)
    red = doc.material("red", srgb("#c8402f"), roughness=0.35)
    wood = doc.material("wood", srgb("#8a6a48"), roughness=0.7)
    sail = doc.material("sail", srgb("#e9e2d0"), roughness=0.8)
    doc.node("floor", mesh=doc.mesh("floor", quad([0, 0, 0], [9, 0, 0], [0, 0, -9]), floor))

    # Five joints, half a metre apart; each ring of vertices follows the two that it lies between.
    bones, step, tip = 5, 0.5, 0.12
    rings = [(0.34 - (0.34 - tip) * i / 40, bones * step * i / 40, 1, 0.1, 1 - i / 40) for i in range(40, -1, -1)]
    shape = lathe([(0.0, bones * step, 0, 1, 0.0), (tip, bones * step, 0, 1, 0.0)] + rings, 32)
    tentacle = doc.mesh("tentacle", shape, green)
    joints, parent = [], doc.node("tentacle root", translation=[-1.7, 0, 0])
    for i in range(bones):
        parent = doc.node(f"joint {i}", parent, translation=[0, step if i else 0, 0])
        joints.append(parent)

    def influences(height):
        t = min(max(height / step - 0.5, 0), bones - 1)
        low = min(int(t), bones - 2)
        return [(low, 1 - (t - low)), (low + 1, t - low)]

    skin = doc.skin(tentacle, "tentacle", joints,
                    [[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -step * i, 0, 1] for i in range(bones)],
                    [influences(p[1]) for p in shape[0]])
    doc.node("tentacle", mesh=tentacle, skin=skin)

    radius = 0.55
    round_ball = sphere(radius, 48, 24)
    ball = doc.mesh("ball", round_ball, red)
    flat = [[x * 1.3, y * 0.55, z * 1.3] for x, y, z in round_ball[0]]
    doc.morph(ball, "flat ball", [sub(f, p) for f, p in zip(flat, round_ball[0])],
              [sub(unit([n[0] / 1.3, n[1] / 0.55, n[2] / 1.3]), n) for n in round_ball[1]])
    ball_node = doc.node("ball", translation=[0.35, radius, 0.6], mesh=ball)

    tower = doc.node("tower", translation=[2.2, 0, -0.6], mesh=doc.mesh("tower", cylinder(0.5, 0.3, 2.1, 0.03), wood))
    hub = doc.node("hub", tower, translation=[0, 1.85, 0.45])
    blade = doc.mesh("blade", moved(box([0.24, 1.15, 0.03], 0.012), [0.06, 0.7, 0]), sail)
    axle = doc.mesh("axle", sphere(0.11, 24, 12), wood)
    doc.node("axle", hub, mesh=axle)
    for i in range(4):
        doc.node(f"blade {i}", hub, rotation=about([0, 0, 1], 90.0 * i), mesh=blade)

    channels = []
    for i, joint in enumerate(joints):  # a wave that climbs
        swing = [22 * math.sin(math.pi / 2 * k - 0.8 * i) * (0.4 + 0.2 * i) for k in range(5)]
        channels.append((joint, "rotation", "LINEAR", [0.5 * k for k in range(5)],
                         [about([0.3, 0, 1], s) for s in swing]))
    rest, top = radius * 0.55, 2.2  # up and down again as a parabola: splines of its tangents
    channels.append((ball_node, "translation", "CUBICSPLINE", [0, 0.2, 1, 1.8, 2],
                     [v for y, enter, leave in ((rest, 0, 0), (radius, 4.1, 4.1), (top, 0, 0), (radius, -4.1, -4.1),
                                                (rest, 0, 0))
                      for v in ([0, enter, 0], [0.35, y, 0.6], [0, leave, 0])]))
    channels.append((ball_node, "weights", "LINEAR", [0, 0.2, 1.8, 2], [[1], [0], [0], [1]]))
    channels.append((hub, "rotation", "LINEAR", [0.5 * k for k in range(5)],
                     [about([0, 0, 1], -90.0 * k) for k in range(5)]))
    doc.animation("everything", channels)
    doc.light("sun", "directional", (1, 0.95, 0.87), 8.0, [4, 7, 4], [0, 0, 0])
    doc.light("sky", "directional", (0.74, 0.85, 1), 2.8, [-4, 3, 5], [0, 0, 0])
    doc.camera("main", [0.4, 2.6, 8.4], [0.3, 1.4, 0], 32)
    return doc


def lines():
    """All modes of points and lines: a knot (strip), a wire globe (lines) over a ball, rings of glass (loops), clouds of
    points with normals and without."""
    doc = Document("Points and lines")
    paper = doc.material("paper", srgb("#2b3440"), roughness=0.9)
    clay = doc.material("clay", srgb("#c9b79c"), roughness=0.6)
    ink = doc.material("ink", srgb("#f2e8cf"))
    white = doc.material("white", (1, 1, 1))
    glass = doc.material("glass", srgb("#8fd0ff"), alpha=0.5, alphaMode="BLEND")
    doc.node("floor", mesh=doc.mesh("floor", quad([0, 0, 0], [8, 0, 0], [0, 0, -6]), paper))
    doc.node("wall", mesh=doc.mesh("wall", quad([0, 3, -3], [8, 0, 0], [0, 3, 0]), paper))

    def rainbow(t):
        return [0.5 + 0.5 * math.cos(2 * math.pi * (t - shift)) for shift in (0, 1 / 3, 2 / 3)] + [1.0]

    def knot(t):
        a = 2 * math.pi * t
        r = 0.75 + 0.28 * math.cos(3 * a)
        return [r * math.cos(2 * a), r * math.sin(2 * a), 0.28 * math.sin(3 * a)]

    steps = 240
    doc.node("knot", translation=[-1.85, 1.2, 0.2], scale=[0.8] * 3, mesh=doc.strokes(
        "knot", 3, [knot(i / steps) for i in range(steps + 1)], white, [rainbow(i / steps) for i in range(steps + 1)]))

    def on_globe(latitude, longitude, radius):
        return [radius * math.cos(latitude) * math.cos(longitude), radius * math.sin(latitude),
                radius * math.cos(latitude) * math.sin(longitude)]

    rows, columns = 9, 24
    grid = [on_globe(math.pi * (r + 1) / (rows + 1) - math.pi / 2, 2 * math.pi * c / columns, 0.82)
            for r in range(rows) for c in range(columns)]
    edges = []
    for r in range(rows):
        for c in range(columns):
            edges += [r * columns + c, r * columns + (c + 1) % columns]
            if r + 1 < rows:
                edges += [r * columns + c, (r + 1) * columns + c]
    globe = doc.node("globe", translation=[0, 1.1, 0.2], mesh=doc.mesh("globe", sphere(0.8, 48, 24), clay))
    doc.node("wires", globe, mesh=doc.strokes("wires", 1, grid, ink, indices=edges))
    ring = doc.strokes("ring", 2, [[math.cos(2 * math.pi * i / 64), 0, math.sin(2 * math.pi * i / 64)]
                                   for i in range(64)], glass)
    for i in range(6):
        doc.node(f"ring {i}", globe, mesh=ring, scale=[1.0 + 0.07 * i] * 3, rotation=about([0, 0, 1], 14.0))

    turn = math.pi * (3 - math.sqrt(5))  # the golden angle
    spiral = [on_globe(math.asin(2 * (i + 0.5) / 3000 - 1), turn * i, 0.8) for i in range(3000)]
    cloud = doc.strokes("cloud", 0, spiral, clay, normals=[unit(p) for p in spiral])
    doc.node("cloud", translation=[1.85, 1.1, 0.2], mesh=cloud)
    stars = [[math.sqrt(i / 1500) * math.cos(turn * i), math.sqrt(i / 1500) * math.sin(turn * i), 0]
             for i in range(1, 1501)]
    doc.node("stars", translation=[0.2, 2.9, -2.5], scale=[2.4, 0.7, 1], mesh=doc.strokes(
        "stars", 0, stars, white, [rainbow(i / 1500) for i in range(1, 1501)]))
    doc.light("sun", "directional", (1, 0.95, 0.87), 8.0, [4, 7, 6], [0, 0, 0])
    doc.light("sky", "directional", (0.74, 0.85, 1), 2.8, [-4, 3, 5], [0, 0, 0])
    doc.camera("main", [0.2, 2.1, 7.0], [0, 1.45, 0], 36)
    return doc


def glass():
    doc = Document("Mirrors and glass")
    tiles = doc.texture("checker", "checker.png")
    floor = doc.material("tiles", (1, 1, 1), roughness=0.7, texture=tiles)
    doc.node("floor", mesh=doc.mesh("floor", quad([0, 0, 5], [14, 0, 0], [0, 0, -11], (14, 11), 4), floor))
    wall = doc.material("wall", srgb("#b9a58c"), roughness=0.95)
    doc.node("wall", mesh=doc.mesh("wall", quad([0, 4, -6], [14, 0, 0], [0, 4, 0]), wall))
    doc.node("back wall", mesh=doc.mesh("back wall", quad([0, 4, 16], [-14, 0, 0], [0, 4, 0]), wall))
    for side in (-1, 1):
        doc.node("side wall", mesh=doc.mesh(f"side wall {side}", quad([14 * side, 4, 5], [0, 0, 11 * side], [0, 4, 0]), wall))
    lid = doc.material("ceiling", srgb("#e8e4da"), roughness=1.0)
    doc.node("ceiling", mesh=doc.mesh("ceiling", quad([0, 8, 5], [14, 0, 0], [0, 0, 11]), lid))

    def clear(ior, thickness=1.0, color=None, distance=None, priority=None, dispersion=None):
        extensions = {"KHR_materials_transmission": {"transmissionFactor": 1.0}, "KHR_materials_ior": {"ior": ior}}
        if thickness:
            volume = {"thicknessFactor": thickness}
            if color:
                volume.update({"attenuationColor": list(color), "attenuationDistance": distance})
            if priority is not None:
                volume["extensions"] = {"TESSERA_volume": {"priority": priority}}
                doc.extensions.add("TESSERA_volume")
            extensions["KHR_materials_volume"] = volume
        if dispersion:
            extensions["KHR_materials_dispersion"] = {"dispersion": dispersion}
        return {"extensions": extensions}

    ball = sphere(1.0, 96, 48)

    def place(name, radius, position, material, shape=ball, shape_name="ball", **more):
        doc.node(name, translation=position, scale=[radius] * 3, mesh=doc.mesh(name, shape, material, shape_name), **more)

    place("crystal ball", 0.8, [-0.35, 0.8, 0.9], doc.material("crystal", roughness=0.0, **clear(1.5)))
    place("mirror ball", 1.0, [1.75, 1.0, -1.0], doc.material("silver", (0.95, 0.93, 0.9), 1.0, 0.0))
    place("gold ball", 0.5, [-1.5, 0.5, -1.6], doc.material("gold", (1.0, 0.77, 0.34), 1.0, 0.12))
    # A drop of water in a glass ball: where they overlap the glass, of the higher priority, fills the space.
    place("thick glass", 0.62, [-2.3, 0.62, 0.4], doc.material("bottle glass", roughness=0.0, **clear(
        1.52, color=(0.55, 0.85, 0.6), distance=0.6, priority=1)))
    place("water", 0.4, [-2.2, 0.72, 0.5], doc.material("water", roughness=0.0, **clear(1.333, priority=2)))
    ruby = doc.material("ruby", roughness=0.0, **clear(1.77, color=(0.9, 0.06, 0.12), distance=0.5))
    place("ruby block", 1.0, [1.15, 0.36, 1.25], ruby, box([0.7, 0.7, 0.7], 0.05), "block", rotation=about([0, 1, 0], 32))
    prism = doc.material("flint", roughness=0.0, **clear(1.7, dispersion=0.8))
    place("prism", 1.0, [2.35, 0.56, 0.9], prism, box([0.5, 1.1, 0.5], 0.02, 1), "prism", rotation=about([0, 1, 0], 58))
    pane = doc.material("pane", (0.75, 0.9, 1.0), roughness=0.0, doubleSided=True, **clear(1.5, 0))
    place("pane", 1.0, [-0.55, 1.1, -2.6], pane, quad([0, 0, 0], [0.9, 0, 0], [0, 1.1, 0]), "pane")
    kettle = {"model": "phong", "diffuse": srgb("#7d3c98"), "specular": [0.6, 0.6, 0.6], "shininess": 60.0,
              "ambient": srgb("#7d3c98"), "mirror": [0.3, 0.3, 0.3]}
    place("lacquer", 0.36, [0.35, 0.36, 2.0], doc.material("lacquer", srgb("#7d3c98"), extensions={PHONG: kettle}))
    doc.light("lamp", "point", (1, 0.94, 0.84), 260.0, [3.2, 6.2, 4.6])
    doc.light("other lamp", "point", (0.78, 0.87, 1), 120.0, [-6, 6.5, 3])
    doc.light("back lamp", "point", (1, 0.96, 0.9), 130.0, [0, 6.5, 11])
    doc.camera("main", [0.1, 2.3, 7.4], [-0.05, 0.85, 0], 34)
    return doc


def shapes():
    """Spheres, discs and planes by their formulas."""
    doc = Document("Spheres, discs and a plane without end")
    checker = doc.texture("checker", "checker.png")
    tiles = doc.material("tiles", (1, 1, 1), roughness=0.8, texture=checker, repeat=(0.5, 0.5))
    doc.node("ground", mesh=doc.shape("ground", tiles, "plane"))

    def ball(name, radius, x, z, material, **place):
        doc.node(name, translation=[x, radius, z], mesh=doc.shape(name, material, "sphere", radius=radius), **place)

    def gloss(color, mirror, shininess):
        return {"extensions": {PHONG: {"model": "phong", "ambient": color, "diffuse": color, "specular": [0.7, 0.7, 0.7],
                                       "shininess": shininess, "mirror": [mirror] * 3}}}

    ball("mirror", 1.0, 0.35, -0.75, doc.material("mirror", (0.9, 0.9, 0.9), 1.0, 0.05, **gloss([0.02, 0.02, 0.02], 0.9, 200.0)))
    ball("glass", 0.6, -0.75, 1.35, doc.material("glass", roughness=0.0, extensions={
        "KHR_materials_transmission": {"transmissionFactor": 1.0}, "KHR_materials_ior": {"ior": 1.5},
        "KHR_materials_volume": {"thicknessFactor": 1.2}}))
    ball("beach ball", 0.7, -2.05, -0.35, doc.material("beach ball", srgb("#f2b134"), roughness=0.5, texture=checker,
                                                      repeat=(4, 2)), rotation=about([1, 0, 0.6], 28))
    ball("golf ball", 0.34, 0.95, 1.75, doc.material("golf ball", srgb("#e8e6df"), roughness=0.35, normalTexture={
        "index": doc.texture("dimples", "dimples-normal.png"), "scale": 0.8,
        "extensions": {"KHR_texture_transform": {"scale": [6, 3]}}}))
    red = srgb("#b3261e")
    doc.node("ellipsoid", translation=[2.3, 0.55, 0.55], rotation=about([0, 1, 0], 24), scale=[1.1, 0.55, 0.6],
             mesh=doc.shape("ellipsoid", doc.material("lacquer", red, roughness=0.3, **gloss(red, 0.12, 80.0)), "sphere"))
    lattice = doc.material("lattice", srgb("#d7e0d0"), roughness=0.6, texture=doc.texture("lattice", "lattice.png"),
                           repeat=(5, 5), alphaMode="MASK", doubleSided=True)
    doc.node("round screen", translation=[-1.35, 1.3, -2.6], rotation=about([1, 0, 0], 90),
             mesh=doc.shape("round screen", lattice, "disc", radius=1.3))
    blue = srgb("#27496d")
    pane = doc.material("dark mirror", blue, 0.4, 0.1, doubleSided=True, **gloss(blue, 0.45, 120.0))
    stand = doc.node("stand", translation=[2.45, 0.95, -2.4], rotation=about([0, 1, 0], -24))
    doc.node("dark mirror", stand, rotation=about([1, 0, 0], 90), mesh=doc.shape("dark mirror", pane, "plane", size=[2.2, 1.9]))
    doc.light("sun", "directional", (1, 0.95, 0.87), 8.0, [-5, 5.2, 1.4], [0, 0, 0])
    doc.light("lamp", "point", (0.8, 0.88, 1), 60.0, [4.5, 4.2, 4.0])
    doc.camera("main", [0.3, 2.15, 7.3], [0.15, 0.66, 0], 32, zfar=None)
    doc.camera("above", [0.2, 5.2, 5.6], [0.1, 0.3, -0.3], 40, zfar=None)
    return doc


SCENES = {"cornell-box": cornell_box, "spheres": spheres, "lights": lights, "materials": materials,
          "hierarchy": hierarchy, "transparency": transparency, "motion": motion,
          "lines": lines, "glass": glass, "shapes": shapes}


def make_all(folder):
    textures(folder)
    for stem, make in SCENES.items():
        make().write(folder, stem)


def check(folder):
    """Names the files that differ from what would be made; pictures are compared by their pixels."""
    different = []
    with tempfile.TemporaryDirectory() as fresh:
        make_all(pathlib.Path(fresh))
        for made in sorted(pathlib.Path(fresh).iterdir()):
            old = folder / made.name
            read = pixels_of if made.suffix == ".png" else pathlib.Path.read_bytes
            if not old.exists() or read(old) != read(made):
                different.append(made.name)
    return different


def main():
    folder = pathlib.Path(__file__).resolve().parent
    if sys.argv[1:] == ["--check"]:
        different = check(folder)
        sys.exit("not as generate.py makes them: " + ", ".join(different) if different else 0)
    if sys.argv[1:]:
        sys.exit("usage: generate.py [--check]")
    make_all(folder)


if __name__ == "__main__":
    main()
