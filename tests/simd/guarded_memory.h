// An array behind whose end memory ends: reading or writing past it is a fault, not luck. What lies before
// it on its first page holds a pattern, which changed() looks for.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <type_traits>
#include <vector>

namespace tessera::test {

template <class T>
class GuardedArray {
    static_assert(std::is_trivially_copyable_v<T>);

  public:
    explicit GuardedArray(std::size_t count) : count_(count) {
        const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
        const std::size_t bytes = count * sizeof(T), pages = (bytes + page - 1) / page + 1;
        size_ = (pages + 1) * page;
        memory_ = static_cast<unsigned char*>(
            mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
        if (memory_ == MAP_FAILED) throw std::bad_alloc();
        before_ = pages * page - bytes;
        std::memset(memory_, kPattern, pages * page);
        mprotect(memory_ + pages * page, page, PROT_NONE);
    }
    explicit GuardedArray(const std::vector<T>& values) : GuardedArray(values.size()) {
        if (!values.empty()) std::memcpy(memory_ + before_, values.data(), values.size() * sizeof(T));
    }
    ~GuardedArray() { munmap(memory_, size_); }
    GuardedArray(const GuardedArray&) = delete;
    GuardedArray& operator=(const GuardedArray&) = delete;

    T* data() { return reinterpret_cast<T*>(memory_ + before_); }
    const T* data() const { return reinterpret_cast<const T*>(memory_ + before_); }
    T& operator[](std::size_t i) { return data()[i]; }
    const T& operator[](std::size_t i) const { return data()[i]; }
    std::size_t size() const { return count_; }
    // Whether anything was written before the array.
    bool changed() const {
        for (std::size_t i = 0; i < before_; ++i)
            if (memory_[i] != kPattern) return true;
        return false;
    }

  private:
    static constexpr unsigned char kPattern = 0xa5;
    unsigned char* memory_;
    std::size_t count_, size_, before_;
};

}  // namespace tessera::test
