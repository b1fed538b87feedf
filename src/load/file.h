// Reading files into memory. Only regular files are read: a FIFO or a device never hangs us. The
// file is copied, not mapped: a file that another process cuts short while we read gives an error
// instead of a signal.
#pragma once

#include "load/context.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace tessera {

// Bytes of our own, not initialised when they are made.
class Bytes {
  public:
    Bytes() = default;
    explicit Bytes(std::size_t size) : data_(std::make_unique_for_overwrite<std::byte[]>(size)), size_(size) {}
    std::byte* data() { return data_.get(); }
    std::size_t size() const { return size_; }
    std::span<const std::byte> span() const { return {data_.get(), size_}; }

  private:
    std::unique_ptr<std::byte[]> data_;
    std::size_t size_ = 0;
};

// A file descriptor that closes itself.
class FileHandle {
  public:
    explicit FileHandle(int descriptor) : descriptor_(descriptor) {}
    FileHandle(FileHandle&& other) noexcept : descriptor_(other.descriptor_) { other.descriptor_ = -1; }
    FileHandle& operator=(FileHandle&& other) noexcept {
        std::swap(descriptor_, other.descriptor_);
        return *this;
    }
    ~FileHandle();
    int get() const { return descriptor_; }

  private:
    int descriptor_;
};

// The whole file at `path`, charged to the context.
Bytes read_whole_file(LoadContext& context, const std::string& path);
// The first `most` bytes of the open file (fewer when it is shorter), charged to the context.
Bytes read_open_file(LoadContext& context, const FileHandle& file, std::uint64_t most, const std::string& place);

}  // namespace tessera
