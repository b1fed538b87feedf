// The Embree device of one EmbreeScene: handles that release themselves, one limit on memory, and errors as exceptions.
// Any number of threads may allocate at a time; the rest is for one thread.
#pragma once

#include <tessera/isa.h>

#include <embree3/rtcore.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <type_traits>

namespace tessera {

struct ReleaseEmbree {
    void operator()(RTCDevice d) const { rtcReleaseDevice(d); }
    void operator()(RTCScene s) const { rtcReleaseScene(s); }
    void operator()(RTCGeometry g) const { rtcReleaseGeometry(g); }
};
using SceneHandle = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseEmbree>;
using GeometryHandle = std::unique_ptr<std::remove_pointer_t<RTCGeometry>, ReleaseEmbree>;

class EmbreeDevice {
  public:
    EmbreeDevice(Isa isa, std::uint64_t max_bytes);
    EmbreeDevice(const EmbreeDevice&) = delete;
    EmbreeDevice& operator=(const EmbreeDevice&) = delete;

    // Every scene is robust (no ray slips between triangles) and takes the filter of a trace call.
    SceneHandle new_scene(RTCBuildQuality quality, unsigned flags = RTC_SCENE_FLAG_NONE);
    GeometryHandle new_geometry(RTCGeometryType type);

    // Rays in the widest packets that Embree takes as they are.
    int packet_width() const { return packet_width_; }

    // Throws the first error since the last check: kLimit for memory, else kInternal.
    void check();
    // Memory of ours that hierarchies need: counted like Embree's own, kLimit beyond the limit.
    void claim(std::uint64_t bytes);
    void give_back(std::uint64_t bytes) { bytes_ -= static_cast<std::int64_t>(bytes); }

    std::uint64_t bytes() const { return static_cast<std::uint64_t>(bytes_.load()); }

  private:
    static void note_error(void* self, RTCError code, const char* text);
    static bool note_memory(void* self, ssize_t bytes, bool done);

    const std::int64_t max_bytes_;
    int packet_width_ = 4;
    std::atomic<std::int64_t> bytes_{0};
    std::atomic<bool> over_limit_{false};
    std::mutex mutex_;
    RTCError error_ = RTC_ERROR_NONE;  // the first
    std::string error_text_;
    std::unique_ptr<std::remove_pointer_t<RTCDevice>, ReleaseEmbree> device_;  // goes first: it still counts
};

// Memory of ours, as long as it lives.
class MemoryClaim {
  public:
    explicit MemoryClaim(EmbreeDevice& device) : device_(device) {}
    ~MemoryClaim() { clear(); }
    MemoryClaim(const MemoryClaim&) = delete;
    MemoryClaim& operator=(const MemoryClaim&) = delete;

    void add(std::uint64_t bytes) {
        device_.claim(bytes);
        bytes_ += bytes;
    }
    void clear() {
        device_.give_back(bytes_);
        bytes_ = 0;
    }

  private:
    EmbreeDevice& device_;
    std::uint64_t bytes_ = 0;
};

}  // namespace tessera
