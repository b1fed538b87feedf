#include "trace/trace_visibility.h"

#include <algorithm>
#include <cstring>

namespace tessera {
namespace {

constexpr int kSquare = 4;  // pixels, the side of what a packet sees

std::size_t slot_of(std::uint32_t number, std::size_t slots) {
    return static_cast<std::size_t>(number * 0x9e3779b1u >> 7) & (slots - 1);  // Knuth's multiplicative hash
}

}  // namespace

void TraceVisibility::begin(const TraceSource& source) {
    source_ = &source;
    rays_.emplace(source.frame->projection);
    surface_.emplace(*source.frame, *source.shading);
    sheer_surface_.emplace(*source.frame, *source.shading);
    rays = hits = 0;
}

bool TraceVisibility::enter(const TileArea& area) {
    area_ = area;
    return source_->frame->triangle_count > 0;
}

// --- triangles of the tile ----------------------------------------------------------------------

void TraceVisibility::forget_triangles() {
    constexpr std::size_t kSlots = 1024;
    if (table_.size() < kSlots) table_.resize(kSlots);
    std::fill(table_.begin(), table_.end(), Slot{});
    last_instance_ = kNoHit;
    gathered_ = true;
}

void TraceVisibility::grow_table(const VisibleTile& tile) {
    table_.assign(2 * table_.size(), Slot{});
    for (std::uint32_t i = 0; i < tile.triangle_count; ++i) {
        const std::uint32_t key = number(tile.triangles[i]);
        std::size_t at = slot_of(key, table_.size());
        while (table_[at].ordinal != 0) at = (at + 1) & (table_.size() - 1);
        table_[at] = {key, i + 1};
    }
}

std::uint32_t TraceVisibility::ordinal_of(std::uint32_t instance, std::uint32_t triangle, VisibleTile& tile) {
    if (instance == last_instance_ && triangle == last_triangle_) return last_ordinal_;
    last_instance_ = instance;
    last_triangle_ = triangle;
    const std::uint32_t key = number({triangle, instance});
    std::size_t at = slot_of(key, table_.size());
    for (; table_[at].ordinal != 0; at = (at + 1) & (table_.size() - 1))
        if (table_[at].number == key) return last_ordinal_ = table_[at].ordinal;
    const std::uint32_t count = tile.triangle_count;
    if (count > 0) gathered_ = gathered_ && tile.triangles[count - 1].instance == instance;
    tile.triangles.reserve(count + 1, count);
    tile.triangles[count] = {triangle, instance};
    tile.triangle_count = last_ordinal_ = count + 1;
    table_[at] = {key, last_ordinal_};
    if (2 * std::size_t{tile.triangle_count} > table_.size()) grow_table(tile);
    return last_ordinal_;
}

// Gives the triangles of an instance ordinals that follow each other (a counting sort).
void TraceVisibility::gather_instances(VisibleTile& tile) {
    const std::uint32_t count = tile.triangle_count;
    if (gathered_ || count == 0) return;
    std::uint32_t least = kNoHit, most = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        least = std::min(least, tile.triangles[i].instance);
        most = std::max(most, tile.triangles[i].instance);
    }
    instance_count_.assign(most - least + 2, 0);
    for (std::uint32_t i = 0; i < count; ++i) ++instance_count_[tile.triangles[i].instance - least + 1];
    for (std::size_t i = 1; i < instance_count_.size(); ++i) instance_count_[i] += instance_count_[i - 1];
    new_ordinal_.resize(count + 1);
    new_ordinal_[0] = 0;
    sorted_.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t to = instance_count_[tile.triangles[i].instance - least]++;
        sorted_[to] = tile.triangles[i];
        new_ordinal_[i + 1] = to + 1;
    }
    std::copy(sorted_.begin(), sorted_.end(), tile.triangles.data());
    for (std::uint32_t& o : tile.ordinal) o = new_ordinal_[o];
    for (TileFragment& f : tile.fragments) f.ordinal = new_ordinal_[f.ordinal];
}

// --- rays ---------------------------------------------------------------------------------------

std::uint32_t TraceVisibility::place(int x, int y) const {
    const int block = y / kBlockSide * (area_.side / kBlockSide) + x / kBlockSide;
    return static_cast<std::uint32_t>(block * kBlockPixels + y % kBlockSide * kBlockSide + x % kBlockSide);
}

void TraceVisibility::find(SamplePosition offset, bool counted, VisibleTile& tile) {
    const std::uint64_t rays_before = rays, hits_before = hits;
    forget_triangles();
    tile.triangle_count = 0;
    tile.fragments.clear();
    std::fill(tile.ordinal.begin(), tile.ordinal.end(), 0u);
    for (int y = 0; y < area_.height; y += kSquare)
        for (int x = 0; x < area_.width; x += kSquare) see_square(x, y, offset, tile);
    gather_instances(tile);
    if (source_->depths || !tile.fragments.empty()) find_depths(offset, tile);
    tile.sort_fragments(source_->frame->instances.data());
    if (!counted) rays = rays_before, hits = hits_before;
}

void TraceVisibility::see_square(int x, int y, SamplePosition offset, VisibleTile& tile) {
    const ProjectionView& projection = source_->frame->projection;
    RayPacket<kPacketWidth>& packet = packet_.rays;
    const int columns = std::min(kSquare, area_.width - x), rows = std::min(kSquare, area_.height - y);
    const PrimaryRaysJob job{
        *rays_,          source_->scene->trace_from_camera(), area_.x0 + x, area_.y0 + y, offset, columns, rows,
        projection.near, distance_of_depth(projection, 0.0f), &packet_};
    source_->kernels->primary_rays(job);
    rays += static_cast<std::uint64_t>(columns * rows);
    const bool looks = source_->scene->has_undecided();
    sheer_.clear();
    source_->scene->nearest(packet_.valid, packet, true, true, looks ? &sheer_ : nullptr, true);
    PacketHits found;
    source_->kernels->find_hits(packet_, found);
    if (found.count > 0) {
        std::uint32_t ordinals[kPacketWidth + 1] = {0};
        for (std::uint32_t i = 0; i < found.count; ++i)
            ordinals[i + 1] = ordinal_of(packet.instance[found.lane[i]], packet.triangle[found.lane[i]], tile);
        hits += found.rays;
        std::uint32_t* const first = tile.ordinal.data() + place(x, y);
        for (int lane = 0; lane < kPacketWidth; ++lane)
            first[lane / kSquare * kBlockSide + lane % kSquare] = ordinals[found.which[lane]];
    }
    if (!sheer_.empty()) see_sheer(x, y, offset, tile);
}

// Cut-outs and transparent surfaces: which of them are there, and before or behind what, by their depth in the picture.
void TraceVisibility::see_sheer(int x, int y, SamplePosition offset, VisibleTile& tile) {
    sort_by_triangle(sheer_);
    for (const SheerHit& hit : sheer_) {
        const int px = x + static_cast<int>(hit.lane) % kSquare, py = y + static_cast<int>(hit.lane) / kSquare;
        const std::uint32_t pixel = place(px, py);
        const SamplePosition at{256 * (area_.x0 + px) + offset.x, 256 * (area_.y0 + py) + offset.y};
        if (!sheer_surface_->select(hit.instance, hit.triangle)) continue;
        const float depth = sheer_surface_->depth(at);
        if (!(depth > 0.0f)) continue;
        const MaterialView& material = sheer_surface_->material(hit.instance);
        if (material.alpha_mode == AlphaMode::kBlend) {
            tile.add_fragment({pixel, ordinal_of(hit.instance, hit.triangle, tile), depth}, source_->max_fragments);
            continue;
        }
        if (const std::uint32_t before = tile.ordinal[pixel]; before != 0) {
            const TileTriangle& opaque = tile.triangles[before - 1];
            surface_->select(opaque.instance, opaque.triangle);
            const float nearest = surface_->depth(at);
            if (depth < nearest || (depth == nearest && number(opaque) < number({hit.triangle, hit.instance})))
                continue;
        }
        if (sheer_surface_->alpha(at) < material.alpha_cutoff) continue;
        if (tile.ordinal[pixel] == 0) ++hits;
        tile.ordinal[pixel] = ordinal_of(hit.instance, hit.triangle, tile);
    }
}

// Of the nearest opaque surfaces.
void TraceVisibility::find_depths(SamplePosition offset, VisibleTile& tile) {
    for (std::uint32_t pixel = 0; pixel < tile.ordinal.size(); ++pixel) {
        tile.depth[pixel] = 0.0f;
        if (tile.ordinal[pixel] == 0) continue;
        const TilePixel p(pixel, area_.side);
        const TileTriangle& t = tile.triangles[tile.ordinal[pixel] - 1];
        surface_->select(t.instance, t.triangle);
        tile.depth[pixel] = surface_->depth({256 * (area_.x0 + p.x) + offset.x, 256 * (area_.y0 + p.y) + offset.y});
    }
}

}  // namespace tessera
