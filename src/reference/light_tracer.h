// Light by recursion: at a surface point the light of the lights, with shadow rays, and that of the mirrored and
// refracted directions, found by rays of their own (Whitted 1980, "An improved illumination model for shaded display").
// The oracle of the packet ray tracer, with a hierarchy and an intersection test of its own. Single-threaded.
#pragma once

#include "reference/bvh.h"
#include "reference/surface_sampler.h"
#include "shading/media.h"
#include "shading/traced_shade.h"

#include <vector>

namespace tessera {

struct ReferenceTransport {
    bool shadows = true, bounces = true;
    int max_depth = 8;
    float least = 0.002f;
    float background[3] = {0, 0, 0};
};

// What comes along a ray: radiance, and how much of the background is seen along it.
struct TracedLight {
    Vec3T<float> light, passed;
};

class LightTracerReference {
  public:
    LightTracerReference(const Frame& frame, const Bvh& bvh, const ShadingContext& context,
                         const ReferenceTransport& settings);

    // Radiance and alpha of what is seen of a triangle at a picture position.
    ShadedPoint<float> shade(std::uint32_t triangle, SamplePosition at, SurfaceSampler& sampler);

  private:
    struct Ray {
        ConeRay<float> cone;
        float times;  // what its light counts for at most
        Media media;
        int depth = 0, passes = 0, channel = 0;
        bool straight = true;  // it was never mirrored
    };
    // A point on its way through shading.
    struct Point {
        SurfacePoint<float> surface;
        std::uint32_t triangle;
        float footprint, size, times;
    };
    struct Hit {
        std::uint32_t triangle;
        double t;
    };

    TracedLight trace(const Ray& ray);
    TracedLight shade_point(const Point& point, const Ray& from, bool camera, float& alpha);
    TracedShade<float> shade_here(const Point& point, const Boundary& boundary);
    Vec3T<float> arriving(const Point& point, const LightSample<float>& light);
    TracedLight miss(const Ray& ray) const;
    bool nearest(const Ray& ray, Hit& hit);
    RaySurface<float> surface_at(std::uint32_t triangle, const ConeRay<float>& ray, float spread);
    std::uint32_t material_of(std::uint32_t triangle) const { return frame_.instance_of(triangle).material; }

    const Frame& frame_;
    const Bvh& bvh_;
    const ShadingContext& context_;
    const ReferenceTransport settings_;
    float spread_;
    std::vector<float> sizes_;  // largest coordinates, by instance
};

}  // namespace tessera
