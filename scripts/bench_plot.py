#!/usr/bin/env python3
"""A picture of what scripts/bench measured: grouped bars on a logarithmic scale, as SVG.

    scripts/bench_plot.py report.json > bench.svg        (report.json: what scripts/bench --json wrote)
"""

import json
import math
import sys
from xml.sax.saxutils import escape

# Key of the summary, legend and colour; blues are Tessera's, oranges the peer's, greys the plain ones.
SERIES = [("ours_all", "Tessera, {threads} threads", "#0b3c6f"), ("ours_1", "Tessera, 1 thread", "#3b82c4"),
          ("isa_scalar", "Tessera, 1 thread, scalar", "#a9cbe8"),
          ("llvmpipe_all", "llvmpipe, {threads} threads", "#c2571a"), ("llvmpipe_1", "llvmpipe, 1 thread", "#f0a468"),
          ("reference", "reference", "#9a9a9a")]
WIDTH, LEFT, RIGHT, TOP, BOTTOM = 1180, 70, 20, 92, 90
PLOT_HEIGHT = 400


def text(x, y, content, size=12, anchor="start", weight="normal", rotate=None, color="#222"):
    turn = f' transform="rotate({rotate} {x:.1f} {y:.1f})"' if rotate is not None else ""
    return (f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" text-anchor="{anchor}" font-weight="{weight}" '
            f'fill="{color}"{turn}>{escape(content)}</text>')


def shortest(value):
    return f"{value:.0f}" if value >= 100 else f"{value:.1f}" if value >= 10 else f"{value:.2f}"


def svg(report):
    rows = report["summary"]
    series = [(k, n.format(**report), c) for k, n, c in SERIES if any(r.get(k) for r in rows)]
    values = [r[k] for r in rows for k, _, _ in series if r.get(k)]
    grid = [step * 10.0**decade for decade in range(-3, 7) for step in range(1, 10)]
    labelled = [value for value in grid if f"{value:.0e}"[0] in "125"]
    low = max(value for value in labelled if value <= min(values))
    high = min(value for value in labelled if value > 1.3 * max(values))  # with room for the figures

    def y(value):
        return TOP + PLOT_HEIGHT * (1 - math.log(value / low) / math.log(high / low))

    height = TOP + PLOT_HEIGHT + BOTTOM
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{height}" '
           f'viewBox="0 0 {WIDTH} {height}" font-family="sans-serif">',
           f'<rect width="{WIDTH}" height="{height}" fill="white"/>',
           text(LEFT, 26, "Milliseconds per frame (less is better, logarithmic)", 17, weight="bold"),
           text(LEFT, 46, report["title"], 12, color="#555")]
    x = LEFT
    for _, name, color in series:
        out.append(f'<rect x="{x:.1f}" y="60" width="12" height="12" fill="{color}"/>')
        out.append(text(x + 17, 70, name))
        x += 36 + 6.6 * len(name)

    for value in grid:
        if low <= value <= high:
            line = "#bbb" if f"{value:.0e}"[0] == "1" else "#eee"
            out.append(f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y(value):.1f}" y2="{y(value):.1f}" stroke="{line}"/>')
            if value in labelled:
                out.append(text(LEFT - 8, y(value) + 4, f"{value:g}", 11, "end", color="#555"))

    group = (WIDTH - LEFT - RIGHT) / len(rows)
    bar = min(0.84 * group / len(series), 24)
    for i, row in enumerate(rows):
        present = [(row[k], c) for k, _, c in series if row.get(k)]
        x = LEFT + group * (i + 0.5) - bar * len(present) / 2
        for value, color in present:
            out.append(f'<rect x="{x:.1f}" y="{y(value):.1f}" width="{bar - 1:.1f}" '
                       f'height="{TOP + PLOT_HEIGHT - y(value):.1f}" fill="{color}"/>')
            out.append(text(x + bar / 2 + 3, y(value) - 4, shortest(value), 9, rotate=-90, color="#444"))
            x += bar
        out.append(text(LEFT + group * (i + 0.5), TOP + PLOT_HEIGHT + 18, row["workload"], 11,
                        "end" if group < 110 else "middle", rotate=-30 if group < 110 else None))
    out.append(f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{TOP + PLOT_HEIGHT}" y2="{TOP + PLOT_HEIGHT}" stroke="#222"/>')
    return "\n".join(out + ["</svg>", ""])


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with open(sys.argv[1], encoding="utf-8") as file:
        sys.stdout.write(svg(json.load(file)))
