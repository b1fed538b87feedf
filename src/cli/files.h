// Bytes in and out of the command. A file is written under a temporary name beside its place and
// renamed, so that a failure leaves nothing behind; what exists and is no plain file (a device, a
// pipe) is written to directly. "-" is standard input or output. Throws tessera::Error.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tessera::cli {

// All of standard input; kLimit when it exceeds `max_bytes`.
std::vector<std::byte> read_stdin(std::uint64_t max_bytes);

// All of a plain file; kInput, naming it, when it is none or cannot be read. Never waits, as for a pipe.
std::vector<std::byte> read_file(const std::string& path);

bool is_folder(const std::string& path);
// Makes the folders in which `path` lies, where they are missing.
void make_folders_of(const std::string& path);
// Throws kOutput now if nothing could be written in the folder; "" is the current one.
void check_folder_writable(const std::string& folder);
// Throws kOutput now if `path` could not be written later: no such folder, or a folder itself.
void check_writable(const std::string& path);
void write_output(const std::string& path, std::span<const std::byte> data);
void write_output(const std::string& path, std::string_view text);

}  // namespace tessera::cli
