#include "simd/record_kernels.h"

#include "simd/records.h"

namespace tessera::TESSERA_ISA_NAMESPACE {
namespace {

constexpr int kWidth = kLanes<Float>;

void put(float* planes, int plane, Float v) { store(planes + plane * kWidth, v); }
Float get(const float* planes, int plane) { return load<Float>(planes + plane * kWidth); }

void load_four(const float* const* records, float* planes) {
    Float a, b, c, d;
    load_records([records](int lane) { return records[lane]; }, a, b, c, d);
    put(planes, 0, a);
    put(planes, 1, b);
    put(planes, 2, c);
    put(planes, 3, d);
}

void store_four(float* const* records, const float* planes) {
    store_records([records](int lane) { return records[lane]; }, get(planes, 0), get(planes, 1), get(planes, 2),
                  get(planes, 3));
}

void load_three(const float* records, float* planes) {
    Float a, b, c;
    load_triples(records, a, b, c);
    put(planes, 0, a);
    put(planes, 1, b);
    put(planes, 2, c);
}

float least(const float* lanes) { return least_lane(load<Float>(lanes)); }

std::uint32_t move_to_front(std::uint32_t bits, const float* lanes, float* front) {
    const Mask mask = mask_of_bits<Mask>(bits);
    store(front, compress(load<Float>(lanes), mask));
    return mask_bits(mask);
}

}  // namespace

const RecordTable& record_table() {
    static constexpr RecordTable kTable{kWidth, &load_four, &store_four, &load_three, &least, &move_to_front};
    return kTable;
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
