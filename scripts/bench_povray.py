"""POV-Ray on the Whitted workloads of scripts/bench_rays: the same meshes, camera, light and rays, as POV-Ray's files.

The formulas are those of bench/peers/embree_scenes.h. POV-Ray's x axis is turned round, so that its space is right-handed
as ours. One hard shadow, one mirrored ray with its shadow, facets without normals, a sample per pixel.
"""

import math
import re
import shutil
import subprocess
import sys
from pathlib import Path

WIDTH, HEIGHT = 1920, 1080


def installed():
    return shutil.which("povray") is not None


def sphere(around, down):
    """Radius 1 around (0, 1, 0): positions and faces."""
    positions = []
    for j in range(down + 1):
        for k in range(around):
            theta, phi = math.pi * j / down, 2 * math.pi * k / around
            positions.append((math.sin(theta) * math.cos(phi), 1 + math.cos(theta), math.sin(theta) * math.sin(phi)))
    faces = []
    for j in range(down):
        for k in range(around):
            a, b = j * around + k, j * around + (k + 1) % around
            if j > 0:
                faces.append((a, b, b + around))
            if j < down - 1:
                faces.append((a, b + around, a + around))
    return positions, faces


def height(x, z):
    return (0.40 * math.sin(1.7 * x) * math.cos(1.3 * z) + 0.15 * math.sin(5.1 * x + 1.3) * math.sin(4.3 * z)
            + 0.05 * math.sin(17 * x) * math.cos(19 * z))


def height_field(n):
    """n x n cells on [-5, 5]^2."""
    positions, faces = [], []
    for j in range(n + 1):
        for k in range(n + 1):
            x, z = -5 + 10 * k / n, -5 + 10 * j / n
            positions.append((x, height(x, z), z))
    for j in range(n):
        for k in range(n):
            a = j * (n + 1) + k
            c = a + n + 1
            faces += [(a, c, a + 1), (a + 1, c, c + 1)]
    return positions, faces


GROUND = [(-20, 0, -20), (20, 0, -20), (20, 0, 20), (-20, 0, 20)], [(0, 2, 1), (0, 3, 2)]
SCENES = {  # by workload: meshes, where the camera is and what it looks at
    "sphere100k": (lambda: [sphere(316, 159), GROUND], (0, 1.6, 3.6), (0, 0.9, 0)),
    "heightfield100k": (lambda: [height_field(224)], (0, 3, 6), (0, 0, 0)),
}
COLORS = [(0.8, 0.4, 0.3), (0.7, 0.7, 0.7)]


def vector(v):
    return "<" + ",".join(f"{x:.9g}" for x in v) + ">"


def mesh(positions, faces, color):
    points = ",\n".join(vector(p) for p in positions)
    corners = ",\n".join(f"<{a},{b},{c}>" for a, b, c in faces)
    return (f"mesh2 {{ vertex_vectors {{ {len(positions)},\n{points} }}\nface_indices {{ {len(faces)},\n{corners} }}\n"
            f"pigment {{ color rgb {vector(color)} }} finish {{ ambient 0.1 diffuse 0.7 reflection 0.25 }} }}\n")


def scene(name):
    """The text of a workload's file."""
    meshes, eye, target = SCENES[name]
    across = math.degrees(2 * math.atan(math.tan(math.radians(45) / 2) * WIDTH / HEIGHT))
    return (f"#version 3.7;\nglobal_settings {{ assumed_gamma 1 max_trace_level 2 }}\n"
            f"background {{ color rgb <0.6,0.7,0.9> }}\nlight_source {{ <4,6,3> color rgb 1 }}\n"
            f"camera {{ perspective location {vector(eye)} right <{-WIDTH / HEIGHT:.9g},0,0> up <0,1,0> "
            f"angle {across:.9g} look_at {vector(target)} }}\n"
            + "".join(mesh(*m, color) for m, color in zip(meshes(), COLORS)))


def measure(name, threads, folder):
    """Milliseconds of the tracing alone, and how many shadow rays it cast. The file is kept in `folder`."""
    path = Path(folder) / f"{name}.pov"
    if not path.exists():
        path.write_text(scene(name))
    line = ["povray", f"+I{path}", f"+W{WIDTH}", f"+H{HEIGHT}", f"+WT{threads}", "-D", "-F", "-A", "-J", "+Q9"]
    result = subprocess.run(line, capture_output=True, text=True, cwd=folder)
    seconds = re.search(r"Trace Time:.*\((\d+\.\d+) seconds\)", result.stderr)
    shadows = re.search(r"Shadow Ray Tests:\s*(\d+)", result.stderr)
    if result.returncode != 0 or not seconds or not shadows:
        sys.exit(f"povray: {result.stderr.strip()[-2000:]}")
    return {"ms": 1e3 * float(seconds.group(1)), "shadow_rays": int(shadows.group(1))}
