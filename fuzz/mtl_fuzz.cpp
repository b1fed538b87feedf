// libFuzzer target of MTL libraries: statements become materials, or an Error says why not.
#include "load/mtl.h"

#include <tessera/error.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    tessera::LoadOptions options;
    options.max_bytes = 16 << 20;
    tessera::LoadContext context("fuzzed.obj", options);
    try {
        for (const tessera::MtlMaterial& m :
             tessera::read_mtl_text(context, {reinterpret_cast<const char*>(data), size}, "fuzzed.mtl"))
            if (!(m.opacity >= 0 && m.opacity <= 1) || !std::isfinite(m.shininess)) std::abort();
    } catch (const tessera::Error& error) {
        if (error.code() != tessera::ErrorCode::kInput && error.code() != tessera::ErrorCode::kLimit) std::abort();
    }
    return 0;
}
