#include "geometry/clip.h"

#include <tessera/clip.h>
#include <tessera/error.h>

#include <utility>

namespace tessera {
namespace {

struct Vertex {
    HomogeneousPoint position;
    std::vector<double> attributes;
};

Vertex lerp(const Vertex& inside, const Vertex& outside, double t) {
    Vertex v{lerp(inside.position, outside.position, t), inside.attributes};
    for (std::size_t i = 0; i < v.attributes.size(); ++i)
        v.attributes[i] += (outside.attributes[i] - inside.attributes[i]) * t;
    return v;
}

// Signed distance, up to a factor, to one plane of the view volume; not negative inside.
double distance(const HomogeneousPoint& p, std::uint32_t plane) {
    switch (plane) {
        case kClipLeft:
            return p.x + p.w;
        case kClipRight:
            return p.w - p.x;
        case kClipBottom:
            return p.y + p.w;
        case kClipTop:
            return p.w - p.y;
        case kClipNear:
            return p.w - p.z;
        default:
            return p.z;
    }
}

}  // namespace

std::uint32_t out_code(Vec4 p) {
    std::uint32_t code = 0;
    for (std::uint32_t plane = 1; plane <= kClipFar; plane <<= 1)
        if (!(distance({p.x, p.y, p.z, p.w}, plane) >= 0)) code |= plane;
    return code;
}

ClipPolygon clip_polygon(const ClipPolygon& polygon, std::uint32_t planes) {
    const std::size_t count = polygon.positions.size();
    const auto per_vertex = static_cast<std::size_t>(polygon.attributes_per_vertex);
    if (polygon.attributes_per_vertex < 0 || polygon.attributes.size() != count * per_vertex)
        throw Error(ErrorCode::kUsage, "clip_polygon: attributes do not match the vertices");
    std::vector<Vertex> in, out;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec4& p = polygon.positions[i];
        const auto first = polygon.attributes.begin() + static_cast<std::ptrdiff_t>(i * per_vertex);
        in.push_back({{p.x, p.y, p.z, p.w}, {first, first + static_cast<std::ptrdiff_t>(per_vertex)}});
    }
    for (std::uint32_t plane = 1; plane <= kClipFar; plane <<= 1) {
        if (!(planes & plane)) continue;
        clip_by_plane(in, out, [plane](const Vertex& v) { return distance(v.position, plane); });
        std::swap(in, out);
    }
    ClipPolygon result;
    result.attributes_per_vertex = polygon.attributes_per_vertex;
    if (in.size() < 3) return result;
    for (const Vertex& v : in) {
        const HomogeneousPoint& p = v.position;
        result.positions.push_back(
            {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z), static_cast<float>(p.w)});
        for (const double a : v.attributes) result.attributes.push_back(static_cast<float>(a));
    }
    return result;
}

}  // namespace tessera
