// Surface records, shading and film of a tile.
#include "raster_kernel_tile.h"

namespace tessera::bench {
namespace {

// A tile whose visible triangles have their records.
struct SurfaceTile : MiddleTile {
    std::vector<std::uint32_t> list, record_of;  // triangles that are seen; by ordinal
    std::vector<float> records;
    SurfaceLayout layout;

    explicit SurfaceTile(const std::string& workload) : MiddleTile(workload), layout(task.shading_batches.layouts[0]) {
        see();
        const auto floats = static_cast<std::uint32_t>(surface_floats(layout));
        record_of.resize(triangle_count + 1);
        for (const std::uint32_t o : seen()) {
            record_of[o] = static_cast<std::uint32_t>(list.size()) * floats;
            list.push_back(triangles[o - 1].triangle);
        }
        records.resize((list.size() + kMaxLanes) * floats);
        tile_kernels(Isa::kScalar).make_surfaces(surface_job());
    }
    SurfaceJob surface_job() {
        return {&task.source, 0, layout, list.data(), static_cast<std::uint32_t>(list.size()), records.data()};
    }
    ShadeJob shade_job() const {
        ShadeJob job{};
        job.source = &task.source;
        job.material = &frame.shading->context().materials[frame.frame.instances[0].material];
        job.layout = layout;
        job.records = records.data();
        job.record_of = record_of.data();
        return job;
    }
    // Gives every pixel to the triangle in the middle.
    void spread_middle() {
        const std::size_t block = static_cast<std::size_t>(side / kBlockSide) * static_cast<std::size_t>(side / 16) +
                                  static_cast<std::size_t>(side / 16);
        const std::uint32_t middle = ordinal[block * kBlockPixels];
        std::fill(ordinal.begin(), ordinal.end(), middle);
    }
};

// Four numbers per pixel or point.
struct Planes {
    std::vector<float> r, g, b, alpha;
    explicit Planes(std::size_t count) : r(count), g(count), b(count), alpha(count) {}
    template <class Job>
    void point(Job& job) {
        job.r = r.data();
        job.g = g.data();
        job.b = b.data();
        job.alpha = alpha.data();
    }
    void clear() {
        for (std::vector<float>* plane : {&r, &g, &b, &alpha}) std::fill(plane->begin(), plane->end(), -1.0f);
    }
    Bytes bytes(std::size_t count) const {
        Bytes all;
        for (const std::vector<float>* plane : {&r, &g, &b, &alpha}) append(all, plane->data(), count);
        return all;
    }
};

KernelWork make_surfaces_work(const std::string& workload) {
    const auto tile = std::make_shared<SurfaceTile>(workload);
    const std::size_t count = tile->list.size();
    const int numbers = kSurfaceHeader + 3 * tile->layout.count;
    KernelWork work{};
    work.items = count;
    work.clear = [=] { std::fill(tile->records.begin(), tile->records.end(), -1.0f); };
    work.run = [=](const Kernels& kernels) {
        const SurfaceJob job = tile->surface_job();
        return seconds_of([&] { kernels.make_surfaces(job); });
    };
    work.output = [=] {  // without the padding behind a record's planes
        const auto floats = static_cast<std::size_t>(surface_floats(tile->layout));
        Bytes bytes;
        for (std::size_t i = 0; i < count; ++i)
            append(bytes, &tile->records[i * floats], static_cast<std::size_t>(numbers));
        return bytes;
    };
    return work;
}

enum class Shade { kSums, kDeveloped };

KernelWork shade_tile_work(const std::string& workload, bool uniform, Shade how) {
    struct State {
        SurfaceTile tile;
        Planes sums;
        std::vector<std::uint64_t> hit;
        std::vector<std::uint8_t> pixels;
        DevelopJob film;

        explicit State(const std::string& name)
            : tile(name),
              sums(tile.ordinal.size()),
              hit(tile.ordinal.size() / kBlockPixels),
              pixels(4 * tile.ordinal.size()) {
            film = {};
            film.film = tile.settings.film;
            film.weight = 1;
            film.window = whole_tile(tile.side);
            film.rgba = pixels.data();
        }
    };
    const auto state = std::make_shared<State>(workload);
    if (uniform) state->tile.spread_middle();
    KernelWork work{};
    work.items = state->tile.covered();
    work.clear = [=] {
        state->sums.clear();
        std::fill(state->hit.begin(), state->hit.end(), 0u);
        std::fill(state->pixels.begin(), state->pixels.end(), std::uint8_t{0x5a});
    };
    work.run = [=](const Kernels& kernels) {
        const SurfaceTile& t = state->tile;
        ShadeJob job = t.shade_job();
        job.x0 = t.x0;
        job.y0 = t.y0;
        job.side = t.side;
        job.offset = {128, 128};
        job.ordinal = t.ordinal.data();
        job.first = true;
        job.develop = how == Shade::kDeveloped ? &state->film : nullptr;
        job.hit = state->hit.data();
        state->sums.point(job);
        return seconds_of([&] { kernels.shade_tile(job); });
    };
    work.output = [=] {
        Bytes bytes;
        if (how == Shade::kSums) bytes = state->sums.bytes(state->tile.ordinal.size());
        append(bytes, state->pixels.data(), state->pixels.size());
        append(bytes, state->hit.data(), state->hit.size());
        return bytes;
    };
    return work;
}

// The tile's covered pixels as a list, in their order.
KernelWork shade_points_work(const std::string& workload) {
    struct State {
        SurfaceTile tile;
        std::vector<std::int32_t> x, y;
        std::vector<std::uint32_t> list;
        Planes colors{0};

        explicit State(const std::string& name) : tile(name) {
            for (std::uint32_t pixel = 0; pixel < tile.ordinal.size(); ++pixel) {
                if (tile.ordinal[pixel] == 0) continue;
                const TilePixel p(pixel, tile.side);
                x.push_back(256 * (tile.x0 + p.x) + 128);
                y.push_back(256 * (tile.y0 + p.y) + 128);
                list.push_back(tile.ordinal[pixel]);
            }
            const std::size_t padded = list.size() + kMaxLanes;
            x.resize(padded, x.back());
            y.resize(padded, y.back());
            list.resize(padded, list.back());
            colors = Planes(padded);
        }
        std::size_t count() const { return list.size() - kMaxLanes; }
    };
    const auto state = std::make_shared<State>(workload);
    KernelWork work{};
    work.items = state->count();
    work.clear = [=] { state->colors.clear(); };
    work.run = [=](const Kernels& kernels) {
        ShadeJob job = state->tile.shade_job();
        job.x = state->x.data();
        job.y = state->y.data();
        job.list = state->list.data();
        job.count = static_cast<std::uint32_t>(state->count());
        state->colors.point(job);
        return seconds_of([&] { kernels.shade_points(job); });
    };
    work.output = [=] { return state->colors.bytes(state->count()); };
    return work;
}

// Normals and positions of a tile, by its picture of one tile.
KernelWork label_surfaces_work(const std::string& workload) {
    struct State {
        SurfaceTile tile;
        std::vector<float> normal, position;
        PictureTargets space;
        explicit State(const std::string& name)
            : tile(name), normal(3 * tile.ordinal.size()), position(3 * tile.ordinal.size()) {}
    };
    const auto state = std::make_shared<State>(workload);
    KernelWork work{};
    work.items = state->tile.covered();
    work.clear = [=] {
        std::fill(state->normal.begin(), state->normal.end(), -2.0f);
        std::fill(state->position.begin(), state->position.end(), -2.0f);
    };
    work.run = [=](const Kernels& kernels) {
        const SurfaceTile& t = state->tile;
        LabelSurfaceJob job{};
        job.source = &t.task.source;
        job.material = &t.frame.shading->context().materials[t.frame.frame.instances[0].material];
        job.labels = {.normal = true, .position = true};
        job.layout = t.layout;
        job.records = t.records.data();
        job.record_of = t.record_of.data();
        job.x0 = t.x0, job.y0 = t.y0, job.side = t.side;
        job.ordinal = t.ordinal.data();
        job.depth = t.depth.data();
        job.label_from_camera = state->space.label_from_camera;
        job.picture_width = static_cast<std::size_t>(t.side);
        job.planes.normal = state->normal.data();
        job.planes.position = state->position.data();
        return seconds_of([&] { kernels.label_surfaces(job); });
    };
    work.output = [=] {
        Bytes bytes;
        append(bytes, state->normal.data(), state->normal.size());
        append(bytes, state->position.data(), state->position.size());
        return bytes;
    };
    return work;
}

// Develops the sums of the workload's tile; `background` without any.
KernelWork develop_work(ToneMap tone_map, Encoding encoding, bool background) {
    struct State {
        SurfaceTile tile{"studio_sphere100k"};
        Planes sums{tile.ordinal.size()};
        std::vector<std::uint64_t> hit = std::vector<std::uint64_t>(tile.ordinal.size() / kBlockPixels);
        std::vector<std::uint8_t> pixels = std::vector<std::uint8_t>(4 * tile.ordinal.size());
    };
    const auto state = std::make_shared<State>();
    ShadeJob shade = state->tile.shade_job();
    shade.x0 = state->tile.x0;
    shade.y0 = state->tile.y0;
    shade.side = state->tile.side;
    shade.offset = {128, 128};
    shade.ordinal = state->tile.ordinal.data();
    shade.first = true;
    shade.hit = state->hit.data();
    state->sums.point(shade);
    tile_kernels(Isa::kScalar).shade_tile(shade);
    KernelWork work{};
    work.items = state->tile.ordinal.size();
    work.clear = [=] { std::fill(state->pixels.begin(), state->pixels.end(), std::uint8_t{0x5a}); };
    work.run = [=](const Kernels& kernels) {
        DevelopJob job{};
        job.film = state->tile.settings.film;
        job.film.tone_map = tone_map;
        job.film.encoding = encoding;
        job.weight = 1;
        job.window = whole_tile(state->tile.side);
        if (!background) state->sums.point(job);
        job.rgba = state->pixels.data();
        return seconds_of([&] { kernels.develop(job); });
    };
    work.output = [=] {
        Bytes bytes;
        append(bytes, state->pixels.data(), state->pixels.size());
        return bytes;
    };
    return work;
}

}  // namespace

std::vector<KernelCase> surface_cases() {
    std::vector<KernelCase> cases;
    cases.push_back({"make_surfaces/normal", [] { return make_surfaces_work("sphere1m"); }});
    cases.push_back({"make_surfaces/normal_uv", [] { return make_surfaces_work("soup20k"); }});
    const auto add_shade = [&](const std::string& name, const std::string& workload, bool uniform) {
        cases.push_back(
            {"shade_tile/" + name + "_sums", [=] { return shade_tile_work(workload, uniform, Shade::kSums); }});
        cases.push_back({"shade_tile/" + name + "_developed",
                         [=] { return shade_tile_work(workload, uniform, Shade::kDeveloped); }});
    };
    add_shade("one_triangle", "sphere10k", true);
    add_shade("few_triangles", "sphere10k", false);
    add_shade("many_triangles", "sphere1m", false);
    add_shade("textured", "soup20k", false);
    add_shade("studio_one_triangle", "studio_sphere100k", true);
    add_shade("studio", "studio_sphere100k", false);
    for (const char* workload : {"sphere10k", "sphere1m", "soup20k", "studio_sphere100k"})
        cases.push_back({std::string("shade_points/") + workload, [=] { return shade_points_work(workload); }});
    for (const char* workload : {"sphere10k", "sphere1m"})
        cases.push_back({std::string("label_surfaces/") + workload, [=] { return label_surfaces_work(workload); }});
    const auto add_film = [&](const char* name, ToneMap tone_map, Encoding encoding, bool background) {
        cases.push_back({std::string("develop/") + name, [=] { return develop_work(tone_map, encoding, background); }});
    };
    add_film("linear", ToneMap::kNone, Encoding::kLinear, false);
    add_film("srgb", ToneMap::kNone, Encoding::kSrgb, false);
    add_film("neutral_srgb", ToneMap::kNeutral, Encoding::kSrgb, false);
    add_film("aces_srgb", ToneMap::kAces, Encoding::kSrgb, false);
    add_film("background", ToneMap::kNeutral, Encoding::kSrgb, true);
    return cases;
}

}  // namespace tessera::bench
