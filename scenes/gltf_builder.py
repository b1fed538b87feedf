"""Builds a glTF 2.0 scene in memory and writes it as readable JSON beside one .bin file.

Deterministic: numbers are rounded before they are stored, so the files are the same on every
machine. Right-handed, Y up, metres; counter-clockwise triangles are front faces. Standard library
only.
"""

import json
import math
import struct
import zlib

FLOAT, USHORT = 5126, 5123
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963


def clean(value):
    """A number rounded to six decimals, without a negative zero; containers element by element."""
    if isinstance(value, float):
        value = round(value, 6) + 0.0
        return int(value) if value == int(value) else value
    if isinstance(value, (list, tuple)):
        return [clean(v) for v in value]
    if isinstance(value, dict):
        return {k: clean(v) for k, v in value.items()}
    return value


def to_json(value, indent=0):
    """JSON with two-space indentation in which whatever fits on a line stays on one."""
    flat = json.dumps(value)
    if len(flat) + indent <= 100 or not isinstance(value, (dict, list)):
        return flat
    pad = " " * (indent + 2)
    if isinstance(value, dict):
        items = [f"{pad}{json.dumps(k)}: {to_json(v, indent + 2)}" for k, v in value.items()]
        return "{\n" + ",\n".join(items) + "\n" + " " * indent + "}"
    items = [pad + to_json(v, indent + 2) for v in value]
    return "[\n" + ",\n".join(items) + "\n" + " " * indent + "]"


def write_png(path, width, height, pixel):
    """Writes 8-bit RGB or RGBA; pixel(x, y) gives channels 0 .. 255, (0, 0) is the top left."""
    channels = len(pixel(0, 0))
    raw = b"".join(b"\0" + bytes(c for x in range(width) for c in pixel(x, y)) for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 6 if channels == 4 else 2, 0, 0, 0)
    with open(path, "wb") as f:
        f.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b""))


def pixels_of(path):
    """The uncompressed rows of a PNG that write_png() wrote."""
    data = path.read_bytes()
    start = data.index(b"IDAT")
    length = struct.unpack(">I", data[start - 4:start])[0]
    return data[:start - 4] + zlib.decompress(data[start + 4:start + 4 + length])


# --- vectors and rotations -----------------------------------------------------------------------


def sub(a, b):
    return [x - y for x, y in zip(a, b)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    length = math.sqrt(sum(x * x for x in a))
    return [x / length for x in a]


def about(axis, degrees):
    """Quaternion of a rotation about the axis, right-hand rule."""
    half = math.radians(degrees) / 2
    return [x * math.sin(half) for x in unit(axis)] + [math.cos(half)]


def looking(eye, target, up=(0, 1, 0)):
    """Quaternion that turns -Z from `eye` to `target`: for cameras, spot and directional lights."""
    z = unit(sub(eye, target))
    x = unit(cross(list(up), z))
    y = cross(z, x)
    # Shepperd's choice of the largest diagonal term keeps the division safe.
    m = [[x[i], y[i], z[i]] for i in range(3)]
    t = [m[0][0] + m[1][1] + m[2][2], m[0][0], m[1][1], m[2][2]]
    k = t.index(max(t))
    if k == 0:
        s = 2 * math.sqrt(1 + t[0])
        return [(m[2][1] - m[1][2]) / s, (m[0][2] - m[2][0]) / s, (m[1][0] - m[0][1]) / s, s / 4]
    i, j, l = k - 1, k % 3, (k + 1) % 3
    s = 2 * math.sqrt(1 + m[i][i] - m[j][j] - m[l][l])
    q = [0.0] * 4
    q[i], q[j], q[l] = s / 4, (m[j][i] + m[i][j]) / s, (m[l][i] + m[i][l]) / s
    q[3] = (m[l][j] - m[j][l]) / s
    return q


# --- shapes: (positions, normals, uvs, triangles) ---------------------------------------------------


def lathe(profile, segments=48):
    """Turns a profile of (radius, height, normal radius, normal height, v) about Y, from top to bottom."""
    positions, normals, uvs, triangles = [], [], [], []
    for r, y, nr, ny, v in profile:
        for s in range(segments + 1):
            a = 2 * math.pi * s / segments
            positions.append([r * math.sin(a), y, r * math.cos(a)])
            normals.append(unit([nr * math.sin(a), ny, nr * math.cos(a)]))
            uvs.append([s / segments, v])
    row = segments + 1
    for p in range(len(profile) - 1):
        top, bottom = profile[p], profile[p + 1]
        if top[:2] == bottom[:2]:
            continue  # a crease: the same ring with another normal
        for s in range(segments):
            a, b, c, d = p * row + s, (p + 1) * row + s, (p + 1) * row + s + 1, p * row + s + 1
            if bottom[0] > 0:
                triangles.append([a, b, c])
            if top[0] > 0:
                triangles.append([a, c, d])
    return positions, normals, uvs, triangles


def sphere(radius=1.0, segments=48, rings=24):
    profile = []
    for i in range(rings + 1):
        a = math.pi * i / rings
        ring = 0.0 if i in (0, rings) else math.sin(a)
        profile.append((radius * ring, radius * math.cos(a), ring, math.cos(a), i / rings))
    return lathe(profile, segments)


def cylinder(bottom, top, height, bevel=0.0, segments=48):
    """Stands on y = 0; radii at bottom and top (0: a cone); rounded rims of radius `bevel`."""
    slope = unit([height, bottom - top, 0])
    profile = [(0.0, height, 0, 1, 0.0)]
    steps = 4 if bevel else 0
    if top > 0:
        profile.append((top - bevel, height, 0, 1, 0.1))
    for i in range(1, steps):
        a = math.pi / 2 * i / steps
        profile.append((top - bevel + bevel * math.sin(a), height - bevel + bevel * math.cos(a), math.sin(a), math.cos(a), 0.1))
    profile.append((top, height - bevel, slope[0], slope[1], 0.2))
    profile.append((bottom, bevel, slope[0], slope[1], 0.8))
    for i in range(1, steps):
        a = math.pi / 2 * i / steps
        profile.append((bottom - bevel + bevel * math.cos(a), bevel - bevel * math.sin(a), math.cos(a), -math.sin(a), 0.9))
    profile += [(bottom - bevel, 0.0, 0, -1, 0.9), (0.0, 0.0, 0, -1, 1.0)]
    return lathe(profile, segments)


def quad(center, right, up, repeat=(1, 1), cells=1):
    """A rectangle with half-extents `right` and `up`; its front faces right x up."""
    normal = unit(cross(right, up))
    positions, normals, uvs, triangles = [], [], [], []
    for j in range(cells + 1):
        for i in range(cells + 1):
            u, v = i / cells, j / cells
            positions.append([c + (2 * u - 1) * r + (2 * v - 1) * t for c, r, t in zip(center, right, up)])
            normals.append(normal)
            uvs.append([u * repeat[0], (1 - v) * repeat[1]])
    for j in range(cells):
        for i in range(cells):
            a = j * (cells + 1) + i
            b, c, d = a + 1, a + cells + 2, a + cells + 1
            triangles += [[a, b, c], [a, c, d]]
    return positions, normals, uvs, triangles


def box(size, bevel=0.0, steps=3):
    """Centred at the origin; with a bevel, edges and corners are rounded (the Minkowski sum with a ball)."""
    half = [s / 2 for s in size]
    parts = []
    for axis in range(3):
        for side in (-1, 1):
            i, j = (axis + 1) % 3, (axis + 2) % 3
            positions, normals, uvs, triangles = [], [], [], []

            def stops(k):
                if not bevel:
                    return [-half[k], half[k]]
                arc = [bevel * n / steps for n in range(steps + 1)]
                return [-half[k] + a for a in arc] + [half[k] - bevel + a for a in arc]

            us, vs = stops(i), stops(j)
            for v in vs:
                for u in us:
                    p = [0.0] * 3
                    p[axis], p[i], p[j] = side * half[axis], u, v
                    n = [0.0] * 3
                    n[axis] = float(side)
                    if bevel:
                        inner = [max(-h + bevel, min(h - bevel, x)) for x, h in zip(p, half)]
                        n = unit(sub(p, inner))
                        p = [c + bevel * x for c, x in zip(inner, n)]
                    positions.append(p)
                    normals.append(n)
                    uvs.append([(u / half[i] + 1) / 2, (v / half[j] + 1) / 2])
            row = len(us)
            for y in range(len(vs) - 1):
                for x in range(row - 1):
                    a = y * row + x
                    b, c, d = a + 1, a + row + 1, a + row
                    triangles += [[a, b, c], [a, c, d]] if side > 0 else [[a, c, b], [a, d, c]]
            parts.append((positions, normals, uvs, triangles))
    return join(*parts)


def join(*shapes):
    positions, normals, uvs, triangles = [], [], [], []
    for p, n, t, f in shapes:
        triangles += [[i + len(positions) for i in face] for face in f]
        positions, normals, uvs = positions + p, normals + n, uvs + t
    return positions, normals, uvs, triangles


def moved(shape, offset):
    positions, normals, uvs, triangles = shape
    return [[a + b for a, b in zip(p, offset)] for p in positions], normals, uvs, triangles


# --- the document -----------------------------------------------------------------------------------


class Document:
    """A glTF asset under construction. Functions return indices, as glTF refers to its parts."""

    def __init__(self, title):
        self.title, self.data, self.extensions, self.required = title, bytearray(), set(), set()
        self.parts = {k: [] for k in ("nodes", "meshes", "materials", "textures", "samplers", "images", "cameras",
                                      "skins", "animations", "accessors", "bufferViews")}
        self.lights, self.roots, self.shapes = [], [], {}

    def add(self, kind, item):
        self.parts[kind].append(clean(item))
        return len(self.parts[kind]) - 1

    def accessor(self, name, rows, kind, component, target=None):
        form = "<%d%s" % (len(rows[0]), "f" if component == FLOAT else "H")
        packed = b"".join(struct.pack(form, *(clean(list(r)))) for r in rows)
        self.data += b"\0" * (-len(self.data) % 4)
        view = {"name": name, "buffer": 0, "byteOffset": len(self.data), "byteLength": len(packed)}
        view = self.add("bufferViews", {**view, "target": target} if target else view)
        self.data += packed
        count = len(rows) * (len(rows[0]) if kind == "SCALAR" else 1)
        item = {"name": name, "bufferView": view, "componentType": component, "count": count, "type": kind}
        if name.endswith(("positions", "times")):
            # The bounds of the stored floats, not of the numbers before rounding to single precision.
            size = 4 * len(rows[0])
            stored = [struct.unpack(form, packed[i:i + size]) for i in range(0, len(packed), size)]
            self.parts["accessors"].append({**item, "min": [min(c) for c in zip(*stored)],
                                            "max": [max(c) for c in zip(*stored)]})
            return len(self.parts["accessors"]) - 1
        return self.add("accessors", item)

    def mesh(self, name, shape, material, shape_name=None):
        """A mesh of one primitive; meshes with the same shape_name share their vertices."""
        key = shape_name or name
        if key not in self.shapes:
            positions, normals, uvs, triangles = shape
            assert len(positions) < 65536
            self.shapes[key] = {
                "attributes": {
                    "POSITION": self.accessor(key + " positions", positions, "VEC3", FLOAT, ARRAY_BUFFER),
                    "NORMAL": self.accessor(key + " normals", normals, "VEC3", FLOAT, ARRAY_BUFFER),
                    "TEXCOORD_0": self.accessor(key + " uvs", uvs, "VEC2", FLOAT, ARRAY_BUFFER)},
                "indices": self.accessor(key + " indices", triangles, "SCALAR", USHORT, ELEMENT_ARRAY_BUFFER)}
        return self.add("meshes", {"name": name, "primitives": [{**self.shapes[key], "material": material}]})

    def shape(self, name, material, kind, **numbers):
        """A mesh of one primitive that is a "sphere", a "disc" or a "plane" of TESSERA_shape."""
        self.extensions.add("TESSERA_shape")
        self.required.add("TESSERA_shape")  # no triangles stand in for it
        return self.add("meshes", {"name": name, "primitives": [
            {"attributes": {}, "material": material, "extensions": {"TESSERA_shape": {"type": kind, **numbers}}}]})

    def strokes(self, name, mode, positions, material, colors=None, normals=None, indices=None):
        """A mesh of points (mode 0), lines (1), a loop (2) or a strip of lines (3)."""
        assert len(positions) < 65536
        attributes = {"POSITION": self.accessor(name + " positions", positions, "VEC3", FLOAT, ARRAY_BUFFER)}
        if normals:
            attributes["NORMAL"] = self.accessor(name + " normals", normals, "VEC3", FLOAT, ARRAY_BUFFER)
        if colors:
            attributes["COLOR_0"] = self.accessor(name + " colors", colors, "VEC4", FLOAT, ARRAY_BUFFER)
        primitive = {"attributes": attributes, "mode": mode, "material": material}
        if indices:
            primitive["indices"] = self.accessor(name + " indices", [[i] for i in indices], "SCALAR", USHORT,
                                                 ELEMENT_ARRAY_BUFFER)
        return self.add("meshes", {"name": name, "primitives": [primitive]})

    def morph(self, mesh, name, positions, normals):
        """Adds a target to the mesh's primitive: what its vertices move and its normals change by."""
        primitive = self.parts["meshes"][mesh]["primitives"][0]
        primitive.setdefault("targets", []).append({
            "POSITION": self.accessor(name + " moved positions", positions, "VEC3", FLOAT, ARRAY_BUFFER),
            "NORMAL": self.accessor(name + " normals", normals, "VEC3", FLOAT, ARRAY_BUFFER)})
        self.parts["meshes"][mesh].setdefault("weights", []).append(0)

    def skin(self, mesh, name, joints, inverse_bind, influences):
        """`influences`: per vertex a list of up to four (joint, weight). Returns the skin."""
        rows = [list(i) + [(0, 0.0)] * (4 - len(i)) for i in influences]
        attributes = dict(self.parts["meshes"][mesh]["primitives"][0]["attributes"])
        attributes["JOINTS_0"] = self.accessor(name + " joints", [[j for j, _ in r] for r in rows], "VEC4", USHORT,
                                               ARRAY_BUFFER)
        attributes["WEIGHTS_0"] = self.accessor(name + " weights", [[float(w) for _, w in r] for r in rows], "VEC4",
                                                FLOAT, ARRAY_BUFFER)
        self.parts["meshes"][mesh]["primitives"][0]["attributes"] = attributes
        return self.add("skins", {"name": name, "joints": joints, "inverseBindMatrices": self.accessor(
            name + " inverse bind matrices", inverse_bind, "MAT4", FLOAT)})

    def animation(self, name, channels):
        """`channels`: (node, path, interpolation, times, values), values by key; of cubic splines three each."""
        samplers, targets = [], []
        for number, (node, path, interpolation, times, values) in enumerate(channels):
            label = f"{name} {number}"
            kind = {"rotation": "VEC4", "weights": "SCALAR"}.get(path, "VEC3")
            samplers.append({"input": self.accessor(label + " times", [[float(t)] for t in times], "SCALAR", FLOAT),
                             "output": self.accessor(label + " values", [[float(x) for x in v] for v in values], kind,
                                                     FLOAT),
                             "interpolation": interpolation})
            targets.append({"sampler": number, "target": {"node": node, "path": path}})
        return self.add("animations", {"name": name, "samplers": samplers, "channels": targets})

    def node(self, name, parent=None, **properties):
        index = self.add("nodes", {"name": name, **properties})
        if parent is None:
            self.roots.append(index)
        else:
            self.parts["nodes"][parent].setdefault("children", []).append(index)
        return index

    def texture(self, name, uri, wrap=10497, min_filter=9987, mag_filter=9729):
        sampler = {"name": name, "magFilter": mag_filter, "minFilter": min_filter, "wrapS": wrap, "wrapT": wrap}
        return self.add("textures", {"name": name, "source": self.add("images", {"name": name, "uri": uri}),
                                     "sampler": self.add("samplers", sampler)})

    def material(self, name, color=(1, 1, 1), metallic=0.0, roughness=0.8, texture=None, alpha=1.0, repeat=None, **more):
        """`repeat`: how often the texture goes into u and v of 0 to 1."""
        pbr = {"baseColorFactor": list(color) + [alpha], "metallicFactor": metallic, "roughnessFactor": roughness}
        if texture is not None:
            pbr["baseColorTexture"] = {"index": texture}
            if repeat:
                pbr["baseColorTexture"]["extensions"] = {"KHR_texture_transform": {"scale": list(repeat)}}
                self.extensions.add("KHR_texture_transform")
        self.extensions.update(more.get("extensions", {}))
        return self.add("materials", {"name": name, "pbrMetallicRoughness": pbr, **more})

    def camera(self, name, eye, target, yfov_degrees, znear=0.1, zfar=100.0):
        lens = {"yfov": math.radians(yfov_degrees), "znear": znear}
        if zfar:
            lens["zfar"] = zfar
        camera = {"name": name, "type": "perspective", "perspective": lens}
        return self.node(name, translation=list(eye), rotation=looking(eye, target), camera=self.add("cameras", camera))

    def light(self, name, kind, color, intensity, position, target=None, parent=None, cone=None):
        """`intensity` in lux (directional) or candela (point, spot); `cone`: inner and outer degrees."""
        item = {"name": name, "type": kind, "color": list(color), "intensity": intensity}
        if cone:
            item["spot"] = {"innerConeAngle": math.radians(cone[0]), "outerConeAngle": math.radians(cone[1])}
        self.lights.append(clean(item))
        self.extensions.add("KHR_lights_punctual")
        placed = {"translation": list(position)}
        if target is not None:
            up = (0, 1, 0) if abs(unit(sub(position, target))[1]) < 0.99 else (0, 0, 1)
            placed["rotation"] = looking(position, target, up)
        return self.node(name, parent, **placed, extensions={"KHR_lights_punctual": {"light": len(self.lights) - 1}})

    def write(self, folder, stem):
        document = {"asset": {"version": "2.0", "generator": "scenes/generate.py of Tessera",
                              "copyright": "Tessera authors, Apache-2.0"}}
        if self.extensions:
            document["extensionsUsed"] = sorted(self.extensions)
        if self.required:
            document["extensionsRequired"] = sorted(self.required)
        if self.lights:
            document["extensions"] = {"KHR_lights_punctual": {"lights": self.lights}}
        document.update({"scene": 0, "scenes": [{"name": self.title, "nodes": self.roots}]})
        document.update({k: v for k, v in self.parts.items() if v})
        if self.data:
            document["buffers"] = [{"name": stem, "byteLength": len(self.data), "uri": stem + ".bin"}]
            (folder / (stem + ".bin")).write_bytes(bytes(self.data))
        with open(folder / (stem + ".gltf"), "w", encoding="utf-8") as f:
            f.write(to_json(document) + "\n")
