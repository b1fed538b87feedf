// Rays of a wave: of the camera, towards a light, mirrored, and as packets.
#include "trace_kernel_cases.h"
#include "trace_kernel_wave.h"

#include <algorithm>

namespace tessera::bench {
namespace {

void append_numbers(Bytes& bytes, const WaveArrays& arrays, int first, int last, std::uint32_t count) {
    for (int number = first; number <= last; ++number) append(bytes, arrays[number], count);
}

// Packets that kernels write, and what they wrote.
struct Packets {
    std::vector<WavePacket> all;

    explicit Packets(std::size_t count) : all(count, WavePacket(kMeetsAll)) {}
    void clear() {
        for (WavePacket& packet : all) packet = WavePacket(kMeetsAll);
    }
    Bytes bytes() const {
        Bytes bytes;
        append(bytes, all.data(), all.size());
        return bytes;
    }
};

struct PacketState {
    BenchWave wave;
    Packets packets;

    explicit PacketState(const Place& place) : wave(place), packets(static_cast<std::size_t>(BenchWave::kPackets)) {}
    WavePacket& packet(std::uint32_t first) { return packets.all[first / kPacketWidth]; }
};

TraceWork primary_rays_work(const Place& place) {
    const auto state = std::make_shared<PacketState>(place);
    std::vector<PrimaryRaysJob> jobs;
    for (int n = 0; n < BenchWave::kPackets; ++n)
        jobs.push_back(state->wave.primary_rays(n, state->packets.all[static_cast<std::size_t>(n)]));
    TraceWork work{};
    work.items = std::uint64_t{kRuns} * kPacketWidth * jobs.size();
    work.clear = [=] { state->packets.clear(); };
    work.run = [=](const TracingKernels& kernels) {
        return seconds_of_runs([&] {
            for (const PrimaryRaysJob& job : jobs) kernels.primary_rays(job);
        });
    };
    work.output = [=] { return state->packets.bytes(); };
    return work;
}

TraceWork pack_work(const Place& place, bool shadows) {
    const auto state = std::make_shared<PacketState>(place);
    const std::uint32_t rays = shadows ? state->wave.shadows() : state->wave.mirrored();
    std::vector<PackJob> jobs;
    for (std::uint32_t first = 0; first < rays; first += kPacketWidth) {
        WavePacket& packet = state->packet(first);
        jobs.push_back(shadows ? state->wave.pack_shadow_rays(first, packet)
                               : state->wave.pack_mirrored_rays(first, packet));
    }
    TraceWork work{};
    work.items = std::uint64_t{kRuns} * rays;
    work.clear = [=] { state->packets.clear(); };
    work.run = [=](const TracingKernels& kernels) {
        return seconds_of_runs([&] {
            for (const PackJob& job : jobs) kernels.pack(job);
        });
    };
    // Behind the last ray lies what no one may trace.
    work.output = [=] {
        Bytes bytes;
        for (std::uint32_t ray = 0; ray < rays; ++ray) {
            const WavePacket& packet = state->packet(ray);
            const auto lane = ray % kPacketWidth;
            append(bytes, packet.valid + lane, 1);
            const RayPacket<kPacketWidth>& r = packet.rays;
            for (const float* numbers : {r.org_x, r.org_y, r.org_z, r.dir_x, r.dir_y, r.dir_z, r.t_near, r.t_far})
                append(bytes, numbers + lane, 1);
        }
        return bytes;
    };
    return work;
}

TraceWork find_hits_work(const Place& place) {
    const auto state = std::make_shared<PacketState>(place);
    for (int n = 0; n < BenchWave::kPackets; ++n) {
        WavePacket& packet = state->packets.all[static_cast<std::size_t>(n)];
        trace_kernels(Isa::kScalar).primary_rays(state->wave.primary_rays(n, packet));
        state->wave.scene().nearest(packet.valid, packet.rays, true, true, nullptr, true);
    }
    const auto found = std::make_shared<std::vector<PacketHits>>(state->packets.all.size());
    TraceWork work{};
    work.items = std::uint64_t{kRuns} * kPacketWidth * found->size();
    work.clear = [=] { std::fill(found->begin(), found->end(), PacketHits{}); };
    work.run = [=](const TracingKernels& kernels) {
        return seconds_of_runs([&] {
            for (std::size_t n = 0; n < found->size(); ++n) kernels.find_hits(state->packets.all[n], (*found)[n]);
        });
    };
    work.output = [=] {
        Bytes bytes;
        for (const PacketHits& hits : *found) {
            append(bytes, &hits.count, 1);
            append(bytes, &hits.rays, 1);
            append(bytes, hits.lane, hits.count);
            append(bytes, hits.which, kPacketWidth);
        }
        return bytes;
    };
    return work;
}

TraceWork shadow_rays_work(const Place& place) {
    const auto state = std::make_shared<WaveJob<ShadowRaysJob>>(place, &BenchWave::shadow_rays);
    TraceWork work{};
    work.items = std::uint64_t{kRuns} * state->wave.samples();
    work.clear = [=] {
        ShadowRaysJob& job = state->job;
        std::fill_n(job.rays[0], 6 * job.rays.stride, -1.0f);
        std::fill_n(job.t_far, job.count, -1.0f);
        std::fill_n(job.point, job.count, ~0u);
        job.made = 0;
    };
    work.run = [=](const TracingKernels& kernels) { return seconds_of_runs([&] { kernels.shadow_rays(state->job); }); };
    work.output = [=] {
        const ShadowRaysJob& job = state->job;
        Bytes bytes;
        append(bytes, &job.made, 1);
        append_numbers(bytes, job.rays, kOriginX, kDirectionZ, job.made);
        append(bytes, job.t_far, job.made);
        append(bytes, job.point, job.made);
        return bytes;
    };
    return work;
}

TraceWork spawn_work(const Place& place) {
    const auto state = std::make_shared<WaveJob<SpawnJob>>(place, &BenchWave::spawn);
    TraceWork work{};
    work.items = std::uint64_t{kRuns} * state->wave.samples();
    work.clear = [=] {
        const WaveArrays& rays = state->job.rays;
        std::fill_n(rays[0], kRayNumbers * rays.stride, -1.0f);
    };
    work.run = [=](const TracingKernels& kernels) {
        return seconds_of_runs([&] {
            state->job.made = state->job.faint = 0;
            kernels.spawn(state->job);
        });
    };
    work.output = [=] {
        const SpawnJob& job = state->job;
        Bytes bytes;
        append(bytes, &job.made, 1);
        append(bytes, &job.faint, 1);
        append_numbers(bytes, job.rays, 0, kRayNumbers - 1, job.made);
        return bytes;
    };
    return work;
}

}  // namespace

std::vector<TraceCase> ray_cases() {
    std::vector<TraceCase> cases;
    for (const Place& place : {kSphere, kTerrain}) {
        const auto name = [&](const char* kernel) { return std::string(kernel) + "/" + place.workload; };
        cases.push_back({name("primary_rays"), [=] { return primary_rays_work(place); }});
        cases.push_back({name("find_hits"), [=] { return find_hits_work(place); }});
        cases.push_back({name("shadow_rays"), [=] { return shadow_rays_work(place); }});
        cases.push_back({name("pack_shadow"), [=] { return pack_work(place, true); }});
        cases.push_back({name("spawn"), [=] { return spawn_work(place); }});
        cases.push_back({name("pack_mirrored"), [=] { return pack_work(place, false); }});
    }
    return cases;
}

}  // namespace tessera::bench
