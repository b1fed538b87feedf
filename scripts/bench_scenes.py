"""Scene files for scripts/bench_rays: `tessera render --stats`, a frame for each process, and what must agree."""

import statistics
from pathlib import Path

WIDTH, HEIGHT = 1920, 1080
BEFORE = ("prepare", "evaluate", "build")  # phases of a frame before it is drawn
COUNTED = ("shadow", "mirrored", "refracted", "straight")
ONE, HYBRID, REFERENCE, ALL = "trace_1", "hybrid_1", "reference", "trace_all"


def files(folder):
    """The glTF files of a folder, without those below it."""
    return sorted(p for p in Path(folder).iterdir() if p.suffix in (".gltf", ".glb"))


def draw_ms(stats):
    return sum(ms for phase, ms in stats["phases_ms"].items() if phase not in BEFORE)


def rays(stats):
    """Without those of the camera, which hybrid does not cast."""
    return sum(stats["rays"][kind] for kind in COUNTED)


def near(a, b):
    """Rays at edges may fall either way."""
    return abs(a - b) <= 1e-4 * max(a, b) + 2


def check(name, has_shapes, runs, faults):
    first = runs[ONE][0]
    for key, results in runs.items():
        if key == HYBRID and has_shapes:  # it draws spheres and discs as triangles
            continue
        for r in results:
            if not near(r["pixels_covered"], first["pixels_covered"]):
                faults.append(f"{name}: {key} hits {r['pixels_covered']}, trace on one thread {first['pixels_covered']}")
            if key != REFERENCE and not near(rays(r), rays(first)):  # the reference does not count rays
                faults.append(f"{name}: {key} casts {rays(r)} rays, trace on one thread {rays(first)}")
    for key, results in (("trace", runs[ONE] + runs[ALL]), ("hybrid", runs[HYBRID])):
        if len({r["color_hash"] for r in results}) > 1:
            faults.append(f"{name}: pictures of {key} differ between runs")


def measure(machine, path, rounds, faults):
    """Medians of a row, in milliseconds."""
    def render(engine, threads):
        return machine.render(path, engine, threads, f"{WIDTH}x{HEIGHT}")

    runs = {ONE: [], HYBRID: [], ALL: []}
    for _ in range(rounds):
        runs[ONE].append(render("trace", 1))
        runs[HYBRID].append(render("hybrid", 1))
        runs[ALL].append(render("trace", machine.threads))
    runs[REFERENCE] = [render("reference-trace", 1)]
    check(path.name, b"TESSERA_shape" in path.read_bytes(), runs, faults)
    row = {key: statistics.median(draw_ms(r) for r in results) for key, results in runs.items()}
    row["scene"] = path.name
    row["mrays"] = 1e-6 * (WIDTH * HEIGHT + rays(runs[ONE][0]))
    row["build"] = statistics.median(r["phases_ms"]["build"] for r in runs[ONE])
    row["reference_over_trace"] = row[REFERENCE] / row[ONE]
    row["mrays_per_s"] = 1e3 * row["mrays"] / row[ONE]
    row["second_thread"] = statistics.median(draw_ms(a) / draw_ms(b) for a, b in zip(runs[ONE], runs[ALL]))
    return row
