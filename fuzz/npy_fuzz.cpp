// Decodes the input as a NumPy array. What decodes must survive being written and read again; everything else
// must end in tessera::Error.
#include <tessera/error.h>
#include <tessera/planes.h>

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        const tessera::NpyArray a = tessera::decode_npy(std::as_bytes(std::span(data, size)), 1u << 18);
        const tessera::NpyArray again =
            tessera::decode_npy(tessera::encode_npy(a.width, a.height, a.components, a.type, a.values.data()));
        if (again.width != a.width || again.height != a.height || again.components != a.components ||
            again.type != a.type || again.values != a.values)
            std::abort();
    } catch (const tessera::Error&) {
        // A refusal is a good answer.
    }
    return 0;
}
