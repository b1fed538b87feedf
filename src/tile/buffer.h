// Arrays of the rasterizer. Buffer grows and is used again: its elements are not initialised, its memory
// stays. PixelArray is a vector that starts on a cache line.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>
#include <vector>

namespace tessera {

template <class T>
class Buffer {
    static_assert(std::is_trivially_copyable_v<T>);

  public:
    T* data() { return data_.get(); }
    const T* data() const { return data_.get(); }
    std::size_t capacity() const { return capacity_; }
    T& operator[](std::size_t i) { return data_[i]; }
    const T& operator[](std::size_t i) const { return data_[i]; }

    // Room for `count` elements; the first `kept` of them stay.
    T* reserve(std::size_t count, std::size_t kept = 0) {
        if (count > capacity_) {
            const std::size_t larger = std::max(count, capacity_ + capacity_ / 2);
            std::unique_ptr<T[]> data(new T[larger]);
            if (kept > 0) std::copy_n(data_.get(), kept, data.get());
            data_ = std::move(data);
            capacity_ = larger;
        }
        return data_.get();
    }

  private:
    std::unique_ptr<T[]> data_;
    std::size_t capacity_ = 0;
};

template <class T>
struct CacheLineAllocator {
    using value_type = T;
    static constexpr std::align_val_t kAlignment{64};

    CacheLineAllocator() = default;
    template <class U>
    CacheLineAllocator(const CacheLineAllocator<U>&) {}
    T* allocate(std::size_t count) { return static_cast<T*>(::operator new(count * sizeof(T), kAlignment)); }
    void deallocate(T* data, std::size_t) { ::operator delete(data, kAlignment); }
    friend bool operator==(CacheLineAllocator, CacheLineAllocator) { return true; }
};

// Numbers by pixel: whole vectors of them never lie across two cache lines.
template <class T>
using PixelArray = std::vector<T, CacheLineAllocator<T>>;

}  // namespace tessera
