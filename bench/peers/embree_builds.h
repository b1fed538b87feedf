// Hierarchies of bare Embree with what the renderer asks of Embree: robust, over the mesh's own arrays; of medium
// quality where meshes stand still, else of low quality, dynamic and to be refitted. One thread at a time.
#pragma once

#include "bench/peers/embree_runs.h"

namespace peers {

// Embree reads vertices by 16 bytes: the last one needs 4 bytes more, which must not be another page's.
inline void pad_vertices(Mesh& mesh) { mesh.positions.reserve(mesh.positions.size() + 1); }

class BareHierarchy {
  public:
    explicit BareHierarchy(RTCDevice device) : device_(device) {}
    ~BareHierarchy() { release(); }
    BareHierarchy(const BareHierarchy&) = delete;
    BareHierarchy& operator=(const BareHierarchy&) = delete;

    // The meshes, padded, must outlive the hierarchy; those without triangles are left out. `moving`: refit() follows.
    void build(std::initializer_list<const Mesh*> meshes, bool moving) {
        release();
        scene_ = rtcNewScene(device_);
        rtcSetSceneBuildQuality(scene_, moving ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_MEDIUM);
        rtcSetSceneFlags(scene_, moving ? RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC : RTC_SCENE_FLAG_ROBUST);
        for (const Mesh* mesh : meshes)
            if (mesh->triangles() > 0) attach(*mesh, moving);
        rtcCommitScene(scene_);
    }
    // After the vertices of the first mesh were written over.
    void refit() {
        const RTCGeometry geometry = rtcGetGeometry(scene_, 0);
        rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
        rtcCommitGeometry(geometry);
        rtcCommitScene(scene_);
    }
    void release() {
        if (scene_ != nullptr) rtcReleaseScene(scene_);
        scene_ = nullptr;
    }
    RTCScene scene() const { return scene_; }

  private:
    void attach(const Mesh& mesh, bool moving) {
        const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.positions.data(), 0, 12,
                                   mesh.positions.size());
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.indices.data(), 0, 12,
                                   mesh.triangles());
        if (moving) rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_REFIT);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
    }

    RTCDevice device_;
    RTCScene scene_ = nullptr;
};

// A wave that runs through a mesh: `moved` are the vertices of `rest` at a phase.
inline void wave_through(const std::vector<vec3>& rest, int phase, vec3* moved) {
    for (const vec3& p : rest) *moved++ = vec3(p.x, p.y + 0.01f * std::sin(p.x * 3 + static_cast<float>(phase)), p.z);
}

}  // namespace peers
