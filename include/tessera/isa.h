// Instruction sets that the kernels are compiled for, and the choice between them. The choice never
// changes a picture, only the time it takes. On processors other than x86-64 there is only `scalar`,
// and a library may be built with fewer than all (the CMake option TESSERA_ISAS).
#pragma once

#include <tessera/export.h>

#include <cstdint>
#include <string>

namespace tessera {

// kAuto: TESSERA_ISA of the environment if set, else the best that the processor has.
enum class Isa : std::uint8_t { kAuto, kScalar, kSse4, kAvx2, kAvx512 };
// "auto", "scalar", "sse4", "avx2", "avx512".
TESSERA_API const char* name(Isa isa);
// Whether the library has it, and this processor and operating system can run it (true for kAuto).
TESSERA_API bool isa_supported(Isa isa);
// The best supported one, whatever the environment says.
TESSERA_API Isa best_isa();
// kUsage when the name is unknown or the instruction set is not supported.
TESSERA_API Isa parse_isa(const std::string& name);
// What kAuto stands for here; any other value itself. Throws kUsage when `isa`, or TESSERA_ISA for
// kAuto, names none or one that is missing.
TESSERA_API Isa resolve_isa(Isa isa);

}  // namespace tessera
