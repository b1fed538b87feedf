#include "trace/embree_device.h"

#include <tessera/error.h>

#include <algorithm>
#include <limits>

namespace tessera {
namespace {

// Nothing about threads: `threads=` would limit oneTBB for the whole host. No files of the user's either.
const char* configuration(Isa isa) {
#if defined(__x86_64__)
    switch (isa) {
        case Isa::kAvx512:
            return "isa=avx512,ignore_config_files=1";
        case Isa::kAvx2:
            return "isa=avx2,ignore_config_files=1";
        case Isa::kSse4:
            return "isa=sse4.2,ignore_config_files=1";
        default:
            return "isa=sse2,ignore_config_files=1";
    }
#else
    static_cast<void>(isa);
    return "ignore_config_files=1";
#endif
}

}  // namespace

EmbreeDevice::EmbreeDevice(Isa isa, std::uint64_t max_bytes)
    : max_bytes_(
          static_cast<std::int64_t>(std::min<std::uint64_t>(max_bytes, std::numeric_limits<std::int64_t>::max() / 2))),
      device_(rtcNewDevice(configuration(isa))) {
    if (!device_) {
        throw Error(ErrorCode::kInternal,
                    "Embree cannot start: error " + std::to_string(static_cast<int>(rtcGetDeviceError(nullptr))));
    }
    if (!rtcGetDeviceProperty(device_.get(), RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED) ||
        !rtcGetDeviceProperty(device_.get(), RTC_DEVICE_PROPERTY_FILTER_FUNCTION_SUPPORTED))
        throw Error(ErrorCode::kInternal, "this Embree was built without ray masks or filter functions");
    if (rtcGetDeviceProperty(device_.get(), RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED)) packet_width_ = 8;
    if (rtcGetDeviceProperty(device_.get(), RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)) packet_width_ = 16;
    rtcSetDeviceErrorFunction(device_.get(), note_error, this);
    rtcSetDeviceMemoryMonitorFunction(device_.get(), note_memory, this);
}

SceneHandle EmbreeDevice::new_scene(RTCBuildQuality quality, unsigned flags) {
    SceneHandle scene(rtcNewScene(device_.get()));
    check();
    rtcSetSceneBuildQuality(scene.get(), quality);
    rtcSetSceneFlags(scene.get(), static_cast<RTCSceneFlags>(flags | RTC_SCENE_FLAG_ROBUST |
                                                             RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
    return scene;
}

GeometryHandle EmbreeDevice::new_geometry(RTCGeometryType type) {
    GeometryHandle geometry(rtcNewGeometry(device_.get(), type));
    check();
    return geometry;
}

void EmbreeDevice::check() {
    const std::lock_guard lock(mutex_);
    if (error_ == RTC_ERROR_NONE) return;
    const RTCError error = error_;
    error_ = RTC_ERROR_NONE;
    if (over_limit_.exchange(false))
        throw Error(ErrorCode::kLimit,
                    "tracing this scene needs more than the " + std::to_string(max_bytes_) + " bytes that it may use");
    if (error == RTC_ERROR_OUT_OF_MEMORY)
        throw Error(ErrorCode::kLimit, "there is not enough memory to trace this scene");
    throw Error(ErrorCode::kInternal, "Embree: " + error_text_);
}

void EmbreeDevice::claim(std::uint64_t bytes) {
    if (note_memory(this, static_cast<ssize_t>(bytes), false)) return;
    note_error(this, RTC_ERROR_OUT_OF_MEMORY, "");
    check();
}

void EmbreeDevice::note_error(void* self, RTCError code, const char* text) {
    auto& device = *static_cast<EmbreeDevice*>(self);
    const std::lock_guard lock(device.mutex_);
    if (device.error_ != RTC_ERROR_NONE) return;
    device.error_ = code;
    try {
        device.error_text_ = text ? text : "";
    } catch (...) {  // nothing may leave through Embree; the code says enough
    }
}

// Embree asks before it allocates, or tells once it has (`done`); then memory counts even when it is refused,
// because it will be given back.
bool EmbreeDevice::note_memory(void* self, ssize_t bytes, bool done) {
    auto& device = *static_cast<EmbreeDevice*>(self);
    const std::int64_t total = device.bytes_ += bytes;
    if (bytes <= 0 || total <= device.max_bytes_) return true;
    if (!done) device.bytes_ -= bytes;
    device.over_limit_ = true;
    return false;
}

}  // namespace tessera
