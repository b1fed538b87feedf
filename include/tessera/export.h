// Visibility of the public symbols. The library is compiled with hidden visibility; what a
// public header declares with TESSERA_API is what an embedder can link against.
#pragma once

#define TESSERA_API __attribute__((visibility("default")))
