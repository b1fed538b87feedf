// The clipping step that all polygon clipping is made of: a closed polygon against one plane, in
// homogeneous coordinates and double precision (Sutherland and Hodgman 1974).
#pragma once

#include <vector>

namespace tessera {

struct HomogeneousPoint {
    double x, y, z, w;
};

// inside + (outside - inside) * t: always from the inside end, so that two polygons that share an edge
// get the same new vertex whichever way they run along it.
inline HomogeneousPoint lerp(const HomogeneousPoint& inside, const HomogeneousPoint& outside, double t) {
    return {inside.x + (outside.x - inside.x) * t, inside.y + (outside.y - inside.y) * t,
            inside.z + (outside.z - inside.z) * t, inside.w + (outside.w - inside.w) * t};
}

// Keeps what has distance(vertex) >= 0. `out` is overwritten; it must not be `in`.
template <class Vertex, class Distance>
void clip_by_plane(const std::vector<Vertex>& in, std::vector<Vertex>& out, const Distance& distance) {
    out.clear();
    for (std::size_t i = 0; i < in.size(); ++i) {
        const Vertex &a = in[i], &b = in[i + 1 < in.size() ? i + 1 : 0];
        const double da = distance(a), db = distance(b);
        if (da >= 0) out.push_back(a);
        if ((da >= 0) == (db >= 0)) continue;
        out.push_back(da >= 0 ? lerp(a, b, da / (da - db)) : lerp(b, a, db / (db - da)));
    }
}

// Distances, up to a factor, to the near plane (0) and to the sides of a volume `guard` times as wide as the picture (1
// to 4): not negative inside.
inline double guard_distance(const HomogeneousPoint& p, int plane, double guard) {
    const double g = guard * p.w;
    switch (plane) {
        case 0:
            return p.w - p.z;
        case 1:
            return g + p.x;
        case 2:
            return g - p.x;
        case 3:
            return g + p.y;
        default:
            return g - p.y;
    }
}

}  // namespace tessera
