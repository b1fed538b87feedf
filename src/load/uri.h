// URIs of a scene's files. What a URI names must lie below the scene's folder, whatever it says and
// whatever links are there; only data: URIs may have a scheme.
#pragma once

#include "load/context.h"
#include "load/file.h"

#include <string>
#include <string_view>

namespace tessera {

bool is_data_uri(std::string_view uri);
// The bytes of a data: URI (base64, percent-encoded or both), charged to the context. White space in base64 and missing
// padding are passed over.
Bytes decode_data_uri(LoadContext& context, std::string_view uri, const std::string& place);

// Replaces %XX; throws kInput for a broken escape.
std::string percent_decode(const LoadContext& context, std::string_view text, const std::string& place);

// Opens the regular file that a relative URI names below `folder` ("": none may be used). Throws
// kInput for anything that leaves the folder: an absolute path, "..", a scheme, a symbolic link that
// points outside; and for backslashes, zero characters and whatever is not a regular file.
FileHandle open_below(const LoadContext& context, const std::string& folder, std::string_view uri,
                      const std::string& place);

// The relative path that a URI says, after the rules that need no file system but that of "..".
std::string checked_path(const LoadContext& context, std::string_view uri, const std::string& place);
// Where a relative path leads from a folder of an archive, by the same rules and without ".": ".." may lead to
// folders above, but not out of the archive.
std::string path_from(const LoadContext& context, const std::string& folder, const std::string& path,
                      const std::string& place);

// The same as open_below() for a plain path, in which nothing is escaped.
FileHandle open_path_below(const LoadContext& context, const std::string& folder, const std::string& path,
                           const std::string& place);

}  // namespace tessera
