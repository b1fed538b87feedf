#include "shading/lookup.h"

namespace tessera::TESSERA_ISA_NAMESPACE {
namespace {

void run(const LookupJob& job) {
    for (int i = 0; i < job.count; i += kLanes<Float>) {
        Float in[kLookupInputs];
        for (int k = 0; k < kLookupInputs; ++k) in[k] = load<Float>(job.inputs + k * job.count + i);
        const Vec4T<Float> c = sample_texture(*job.texture, in[0], in[1], Footprint<Float>{in[2], in[3], in[4], in[5]});
        const Float out[kLookupResults] = {c.x, c.y, c.z, c.w};
        for (int k = 0; k < kLookupResults; ++k) store(job.results + k * job.count + i, as_uint(out[k]));
    }
}

}  // namespace

const LookupTable& lookup_table() {
    static constexpr LookupTable kTable{&run};
    return kTable;
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
