#include "geometry/normals.h"

#include "core/fp_environment.h"
#include "geometry/gather.h"
#include "geometry/triangles.h"

#include <tessera/transform.h>

#include <cstddef>

namespace tessera {

void compute_flat_normals(std::span<const Vec3> positions, std::span<Vec3> normals) {
    const FpEnvironment exact;
    for (std::size_t i = 0; i + 2 < positions.size(); i += 3) {
        const Vec3 plane = triangle_normal(positions[i], positions[i + 1], positions[i + 2]);
        const Vec3 n = plane == Vec3{} ? kDegenerateNormal : plane;
        normals[i] = normals[i + 1] = normals[i + 2] = n;
    }
}

Primitive with_flat_normals(const Primitive& primitive) {
    if (!has_triangles(primitive.mode)) return primitive;
    Primitive result = gather_vertices(primitive, TriangleList(primitive).indices());
    result.tangents.clear();
    for (MorphTarget& target : result.targets) {
        target.normals.clear();
        target.tangents.clear();
    }
    result.normals.resize(result.positions.size());
    compute_flat_normals(result.positions, result.normals);
    return result;
}

}  // namespace tessera
