// Kernels of labels, compiled once per instruction set.
#include "tile/label_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

void label(const LabelJob& job) { label_tile(job); }
void label_surfaces(const LabelSurfaceJob& job) { label_surfaces_of(job); }

}  // namespace tessera::TESSERA_ISA_NAMESPACE
