// libjpeg's error handling, replaced: its default prints and exits. An error, or a warning that means
// damaged pixels, writes a message and jumps back to guarded_jpeg(), which returns false. No object
// with a destructor lives in a frame that such a jump leaves.
#pragma once

#include <csetjmp>
#include <cstddef>
#include <cstdio>

#include <jpeglib.h>

namespace tessera {

struct JpegErrors {
    jpeg_error_mgr manager;  // first, so that a pointer to it is one to the whole
    std::jmp_buf jump;
    char failure[JMSG_LENGTH_MAX];
};

// Sets up `errors` and returns what belongs into the `err` field of a libjpeg structure.
jpeg_error_mgr* install_jpeg_errors(JpegErrors& errors);

// Leaves with `message`. To be called under guarded_jpeg() only.
[[noreturn]] void jpeg_failure(j_common_ptr info, const char* message);

// Calls step(); false when libjpeg reported an error in it.
template <class Step>
[[gnu::noinline]] bool guarded_jpeg(JpegErrors& errors, const Step& step) {
    if (setjmp(errors.jump) != 0) return false;
    step();
    return true;
}

}  // namespace tessera
