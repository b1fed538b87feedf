// libFuzzer target of one mesh format, which TESSERA_FUZZED names by its extension: a file from memory,
// without a folder, under tight limits. A scene that loads must be valid and within the limits; anything
// else must be an Error with a one-line message.
#include <tessera/error.h>
#include <tessera/load.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    tessera::LoadOptions options;
    options.max_bytes = 64 << 20;
    options.max_triangles = 1 << 20;
    options.threads = 1;
    try {
        const tessera::Scene scene = tessera::load_scene_from_memory({reinterpret_cast<const std::byte*>(data), size},
                                                                     "", options, TESSERA_FUZZED);
        tessera::validate(scene);
        std::uint64_t triangles = 0;
        for (const tessera::Mesh& mesh : scene.meshes)
            for (const tessera::Primitive& p : mesh.primitives)
                if (p.mode == tessera::PrimitiveMode::kTriangles)
                    triangles += (p.indices.empty() ? p.positions.size() : p.indices.size()) / 3;
        if (triangles > options.max_triangles) std::abort();
    } catch (const tessera::Error& error) {
        // A loaded scene that is not valid is our fault, and so is anything internal.
        if (error.code() != tessera::ErrorCode::kInput && error.code() != tessera::ErrorCode::kLimit) std::abort();
        if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
    }
    return 0;
}
