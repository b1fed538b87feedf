#include "image/jpeg_error.h"

#include <jerror.h>

namespace tessera {
namespace {

JpegErrors& errors_of(j_common_ptr info) { return *reinterpret_cast<JpegErrors*>(info->err); }

[[noreturn]] void on_error(j_common_ptr info) {
    JpegErrors& errors = errors_of(info);
    info->err->format_message(info, errors.failure);
    std::longjmp(errors.jump, 1);
}

// Warnings that leave every pixel as it was meant: extra bytes, odd version numbers and the like.
bool is_harmless(int code) {
    return code == JWRN_ADOBE_XFORM || code == JWRN_EXTRANEOUS_DATA || code == JWRN_JFIF_MAJOR ||
           code == JWRN_TOO_MUCH_DATA || code == JWRN_BOGUS_ICC;
}

void on_message(j_common_ptr info, int level) {
    if (level < 0 && !is_harmless(info->err->msg_code)) on_error(info);
}

void no_output(j_common_ptr) {}

}  // namespace

jpeg_error_mgr* install_jpeg_errors(JpegErrors& errors) {
    jpeg_error_mgr* manager = jpeg_std_error(&errors.manager);
    manager->error_exit = on_error;
    manager->emit_message = on_message;
    manager->output_message = no_output;
    errors.failure[0] = '\0';
    return manager;
}

void jpeg_failure(j_common_ptr info, const char* message) {
    JpegErrors& errors = errors_of(info);
    std::snprintf(errors.failure, sizeof errors.failure, "%s", message);
    std::longjmp(errors.jump, 1);
}

}  // namespace tessera
